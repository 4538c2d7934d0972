// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/exchange.h"
#include "mneme/store.h"

#include "base/text_file.h"
#include "exchange/json_rows.h"
#include "exchange/npz_file.h"
#include "exchange/npz_rows.h"
#include "store/new_file.h"
#include "store/open_store.h"
#include "store/row_check.h"
#include "store/store_reads.h"
#include "store/store_writes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <optional>
#include <system_error>

namespace mneme {
namespace {

enum class Format { json_lines, npz };

Result<Format> format_of(const std::string& path) {
  if (path.ends_with(".npz")) return Format::npz;
  if (path.ends_with(".jsonl") || path == "/dev/stdout" || path == "/dev/stdin") {
    return Format::json_lines;
  }
  return fail(
      ErrorCode::invalid,
      fmt::format("{}: expected a name that ends in .jsonl (JSON lines) or .npz (NumPy)", path));
}

// export

using Visitor = std::function<Result<void>(std::span<const Experience>)>;

Result<void> write_json_lines(internal::NewFile& file, const ExperienceSpace& space,
                              const std::function<Result<void>(const Visitor&)>& visit_all) {
  return file.write(internal::json_of(space) + "\n").and_then([&] {
    return visit_all([&](std::span<const Experience> rows) -> Result<void> {
      for (const Experience& row : rows) {
        const auto written = file.write(internal::json_of(row) + "\n");
        if (!written) return written;
      }
      return {};
    });
  });
}

Result<void> write_npz(internal::NewFile& file, const ExperienceSpace& space,
                       const std::function<Result<void>(const Visitor&)>& visit_all) {
  internal::NpzColumns columns(space);
  const auto visited = visit_all([&](std::span<const Experience> rows) {
    for (const Experience& row : rows) columns.add(row);
    return Result<void>();
  });
  if (!visited) return visited;
  internal::ZipWriter zip(file);
  for (const auto& [name, array] : columns.arrays()) {
    const auto added = zip.add(name + ".npy", internal::npy_header(array), array.bytes);
    if (!added) return added;
  }
  return zip.finish();
}

// import

/// Rows on their way into a database.
class Import {
 public:
  Import(const std::string& url, const std::string& path) : url_(url), path_(path) {}

  Result<void> open(const ExperienceSpace& space) {
    auto opened = internal::open_store_of(url_, space, OpenMode::create);
    if (!opened) return tl::unexpected(internal::with_advice(opened.error(), url_));
    opened_ = std::move(*opened);
    return {};
  }

  /// `where` names the row in messages.
  Result<void> add(Experience row, const std::string& where) {
    auto flaw = internal::describe_flaw(row, opened_.space);
    if (!flaw) flaw = sizes_.check(row.kind, row.key.size());
    if (flaw) {
      return fail(ErrorCode::parse, fmt::format("{}: {}: {}", path_, where, *flaw));
    }
    row.sampler.joint_count = opened_.space.joint_count;
    rows_.push_back(std::move(row));
    constexpr std::size_t kRowsAtOnce = 500;
    return rows_.size() < kRowsAtOnce ? Result<void>() : flush();
  }

  Result<MergeSummary> finish() {
    return flush().map([&] { return summary_; });
  }

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  Result<void> flush() {
    const auto merged = internal::merge_rows(*opened_.store, rows_, summary_);
    rows_.clear();
    return merged;
  }

  std::string url_;
  std::string path_;
  internal::OpenedStore opened_;
  internal::KeySizes sizes_;
  std::vector<Experience> rows_;
  MergeSummary summary_;
};

/// Lines of a file one by one.
class LineReader {
 public:
  static Result<LineReader> open(const std::string& path) {
    LineReader reader;
    reader.file_.reset(std::fopen(path.c_str(), "rb"));
    if (reader.file_ != nullptr) return reader;
    return fail(ErrorCode::io, fmt::format("{}: cannot be read: {}", path,
                                           std::generic_category().message(errno)));
  }
  /// False at the end, and where a line cannot be read or is too long: see failure().
  bool next(std::string& line) {
    line.clear();
    ++number_;
    for (int c = ::getc_unlocked(file_.get()); c != EOF; c = ::getc_unlocked(file_.get())) {
      if (c == '\n') return true;
      is_too_long_ = line.size() == kMaxLineBytes;
      if (is_too_long_) return false;
      line += static_cast<char>(c);
    }
    return !line.empty() && std::ferror(file_.get()) == 0;
  }
  [[nodiscard]] std::optional<Error> failure() const {
    if (is_too_long_) {
      return Error{ErrorCode::unsupported,
                   fmt::format("expected a line of at most {} bytes", kMaxLineBytes)};
    }
    if (std::ferror(file_.get()) != 0) return Error{ErrorCode::io, "cannot be read to its end"};
    return std::nullopt;
  }
  [[nodiscard]] std::int64_t number() const { return number_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  static constexpr std::size_t kMaxLineBytes = std::size_t{64} << 20;

  std::unique_ptr<std::FILE, Close> file_;
  std::int64_t number_ = 0;
  bool is_too_long_ = false;
};

tl::unexpected<Error> at_line(const Import& import, std::int64_t line, const Error& error) {
  return fail(error.code, fmt::format("{}:{}: {}", import.path(), line, error.message));
}

Result<MergeSummary> import_json_lines(Import& import) {
  auto lines = LineReader::open(import.path());
  if (!lines) return tl::unexpected(lines.error());
  std::string line;
  (void)lines->next(line);
  if (const auto failure = lines->failure()) return at_line(import, 1, *failure);
  const auto space = internal::parse_space(line);
  if (!space) return at_line(import, 1, space.error());
  const auto opened = import.open(*space);
  if (!opened) return tl::unexpected(opened.error());
  while (lines->next(line)) {
    if (line.empty()) continue;
    auto row = internal::parse_row(line);
    if (!row) return at_line(import, lines->number(), row.error());
    const auto added = import.add(std::move(*row), fmt::format("line {}", lines->number()));
    if (!added) return tl::unexpected(added.error());
  }
  if (const auto failure = lines->failure()) return at_line(import, lines->number(), *failure);
  return import.finish();
}

Result<MergeSummary> import_npz(Import& import) {
  constexpr std::size_t kMostBytes = std::size_t{64} << 30;
  const auto bytes = internal::read_text_file(import.path(), kMostBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto members = internal::read_zip(import.path(), *bytes);
  if (!members) return tl::unexpected(members.error());
  std::map<std::string, internal::NpyArray> arrays;
  for (const auto& [name, member] : *members) {
    auto array = internal::parse_npy(member);
    if (!array) {
      return fail(ErrorCode::parse,
                  fmt::format("{}: '{}' {}", import.path(), name, array.error().message));
    }
    arrays.emplace(name.substr(0, name.rfind(".npy")), std::move(*array));
  }
  auto rows = internal::rows_of(arrays);
  if (!rows) {
    return fail(rows.error().code, fmt::format("{}: {}", import.path(), rows.error().message));
  }
  const auto opened = import.open(rows->space);
  if (!opened) return tl::unexpected(opened.error());
  for (std::size_t i = 0; i < rows->rows.size(); ++i) {
    const auto added = import.add(std::move(rows->rows[i]), fmt::format("row {}", i));
    if (!added) return tl::unexpected(added.error());
  }
  return import.finish();
}

}  // namespace

Result<std::int64_t> export_database(const std::string& url, const std::string& path) {
  const auto format = format_of(path);
  if (!format) return tl::unexpected(format.error());
  const auto opened = internal::inspect_store(url);
  if (!opened) return tl::unexpected(internal::with_advice(opened.error(), url));
  if (opened->schema_version == 0) {
    return fail(ErrorCode::invalid,
                fmt::format("{}: is empty, and of no robot yet", opened->store->name()));
  }
  const auto list = internal::list_by_content(*opened->store);
  if (!list) return tl::unexpected(internal::with_advice(list.error(), url));
  auto file = internal::NewFile::create(path);
  if (!file) return tl::unexpected(file.error());
  const auto visit_all = [&](const Visitor& visit) {
    return internal::visit_rows(*opened->store, opened->space, *list, visit);
  };
  const auto written = *format == Format::npz ? write_npz(*file, opened->space, visit_all)
                                              : write_json_lines(*file, opened->space, visit_all);
  if (!written) return tl::unexpected(internal::with_advice(written.error(), url));
  return file->finish().map([&] { return static_cast<std::int64_t>(list->size()); });
}

Result<MergeSummary> import_database(const std::string& url, const std::string& path) {
  return format_of(path).and_then([&](Format format) {
    Import import(url, path);
    return format == Format::npz ? import_npz(import) : import_json_lines(import);
  });
}

}  // namespace mneme
