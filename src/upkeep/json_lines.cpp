// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "base/fail.h"
#include "base/files.h"
#include "engines/open_store.h"
#include "store/row_check.h"
#include "upkeep/store_upkeep.h"
#include "upkeep/json_rows.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace mneme {
namespace {

Result<void> check_name(const std::string& path) {
  if (path.ends_with(".jsonl") || path == "/dev/stdout" || path == "/dev/stdin") return {};
  return fail(ErrorCode::invalid, "{}: expected a file name that ends in .jsonl (JSON lines)",
              path);
}

/// Inserts rows into a database in batches.
class Import {
 public:
  explicit Import(internal::OpenedStore opened) : opened_(std::move(opened)) {}

  Result<void> add(Experience row) {
    auto flaw = internal::describe_flaw(row, opened_.signature);
    if (!flaw) flaw = sizes_.check(row.kind, row.key.size());
    if (flaw) return fail(ErrorCode::parse, *flaw);
    if (!row.is_path()) row.sampler().joint_count = opened_.signature.joint_count;
    rows_.push_back(std::move(row));
    constexpr std::size_t kRowsAtOnce = 500;
    return rows_.size() < kRowsAtOnce ? Result<void>() : flush();
  }

  Result<MergeSummary> finish() {
    return flush().map([&] { return summary_; });
  }

 private:
  Result<void> flush() {
    const auto merged = internal::merge_rows(*opened_.store, rows_, summary_);
    rows_.clear();
    return merged;
  }

  internal::OpenedStore opened_;
  internal::KeySizes sizes_;
  std::vector<Experience> rows_;
  MergeSummary summary_;
};

/// Reads a file line by line. Errors name file and line.
class LineReader {
 public:
  static Result<LineReader> open(const std::string& path) {
    LineReader reader;
    reader.path_ = path;
    reader.file_.reset(std::fopen(path.c_str(), "rb"));
    if (reader.file_ != nullptr) return reader;
    return fail(ErrorCode::io, "{}: cannot be read: {}", path,
                std::generic_category().message(errno));
  }

  /// False at the end.
  Result<bool> next(std::string& line) {
    line.clear();
    ++number_;
    for (int c = ::getc_unlocked(file_.get()); c != EOF; c = ::getc_unlocked(file_.get())) {
      if (c == '\n') return true;
      if (line.size() == kMaxLineBytes) {
        return error({ErrorCode::unsupported,
                      fmt::format("expected a line of at most {} bytes", kMaxLineBytes)});
      }
      line += static_cast<char>(c);
    }
    if (std::ferror(file_.get()) != 0) return error({ErrorCode::io, "cannot be read to its end"});
    return !line.empty();
  }
  /// An error of the last line, with file and line number.
  [[nodiscard]] tl::unexpected<Error> error(const Error& error) const {
    return fail(error.code, "{}:{}: {}", path_, number_, error.message);
  }

 private:
  static constexpr std::size_t kMaxLineBytes = std::size_t{64} << 20;

  std::string path_;
  internal::UniqueFile file_;
  std::int64_t number_ = 0;
};

}  // namespace

Result<std::int64_t> export_database(const std::string& url, const std::string& path) {
  MNEME_TRY(check_name(path));
  const auto opened = MNEME_TRY(internal::advised(internal::inspect_store(url), url));
  if (opened.schema_version == 0) {
    return fail(ErrorCode::invalid, "{}: the database is empty and has no robot yet",
                opened.store->name());
  }
  const auto list = MNEME_TRY(internal::advised(internal::list_by_content(*opened.store), url));
  auto file = MNEME_TRY(internal::NewFile::create(path));
  MNEME_TRY(file.write(internal::json_of(opened.signature) + "\n"));
  const auto write = [&](std::span<const Experience> rows) -> Result<void> {
    for (const Experience& row : rows) MNEME_TRY(file.write(internal::json_of(row) + "\n"));
    return {};
  };
  MNEME_TRY(
      internal::advised(internal::visit_rows(*opened.store, opened.signature, list, write), url));
  MNEME_TRY(file.finish());
  return static_cast<std::int64_t>(list.size());
}

Result<MergeSummary> import_database(const std::string& url, const std::string& path) {
  MNEME_TRY(check_name(path));
  auto lines = MNEME_TRY(LineReader::open(path));
  std::string line;
  MNEME_TRY(lines.next(line));
  const auto robot = internal::parse_signature(line);
  if (!robot) return lines.error(robot.error());
  auto opened =
      MNEME_TRY(internal::advised(internal::open_store_of(url, *robot, OpenMode::create), url));
  Import import(std::move(opened));
  for (;;) {
    const bool is_line = MNEME_TRY(lines.next(line));
    if (!is_line) return import.finish();
    if (line.empty()) continue;
    const auto added = internal::parse_row(line).and_then(
        [&](Experience row) { return import.add(std::move(row)); });
    if (!added) return lines.error(added.error());
  }
}

}  // namespace mneme
