// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/salvage.h"

#include "experience/carved_rows.h"
#include "experience/experience_table.h"
#include "experience/file_copy.h"
#include "experience/row_check.h"
#include "experience/schema.h"
#include "experience/sqlite_connection.h"
#include "experience/store_reads.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>

namespace mneme::internal {
namespace {

namespace fs = std::filesystem;

class Salvage {
 public:
  Salvage(CarvedRows& rows, std::vector<Damage>& damages)
      : rows_(rows), damages_(damages), old_head_(rows.head().value_or(StoreState{})) {
    for (const Damage& damage : damages) known_.insert(damage.id);
  }

  /// Writes what can be saved to `target`, an empty file.
  Result<void> save_to(Connection& target) {
    const auto created = create_schema(target, rows_.space());
    if (!created) return created;
    auto transaction = Transaction::begin(target, Transaction::Kind::write);
    if (!transaction) return tl::unexpected(transaction.error());
    const std::vector<std::int64_t> ids = rows_.ids();
    const auto saved = save_rows(ids, target)
                           .and_then([&] { return write_head(target, new_head()); })
                           .and_then([&] { return transaction->commit(); });
    if (!saved) return saved;
    name_missing(ids);
    // What another way of reading did not find.
    std::erase_if(damages_, [&](const Damage& damage) {
      return std::ranges::binary_search(saved_, damage.id);
    });
    return {};
  }

  /// What became of the rows.
  [[nodiscard]] std::string summary() const {
    return fmt::format("built anew: {} rows are saved, {} are lost", saved_.size(), lost_count_);
  }

 private:
  Result<void> save_rows(const std::vector<std::int64_t>& ids, Connection& target) {
    for (const std::int64_t id : ids) {
      if (rows_.dead().contains(id)) continue;
      const auto row = rows_.row(id);
      if (!row) return tl::unexpected(row.error());
      Experience experience;
      auto flaw = decode(*row, rows_.space(), experience);
      if (!flaw) flaw = sizes_.check(experience.kind, experience.key.size());
      if (flaw) {
        // An id that was never given away is a damaged one.
        if (!rows_.head() || (id >= 1 && id <= old_head_.last_row)) lose(id, *flaw);
        continue;
      }
      ContentHash content;
      std::ranges::copy(row->content, content.begin());
      const auto twins = find_contents(target, std::span(&content, 1));
      if (!twins) return tl::unexpected(twins.error());
      // The trace of a row that was superseded and removed.
      if (!twins->empty()) continue;
      const auto added = add_rows(target, std::span(&*row, 1));
      if (!added) return added;
      tally_.add(*row);
      saved_.push_back(id);
    }
    return {};
  }

  /// Names the rows of which nothing was found, if it is known which ones they are.
  void name_missing(const std::vector<std::int64_t>& ids) {
    constexpr std::int64_t kMostNames = 10000;
    const std::int64_t last = rows_.head() ? old_head_.last_row : ids.empty() ? 0 : ids.back();
    const auto first_found = std::ranges::lower_bound(ids, 1);
    const std::int64_t found = std::ranges::upper_bound(ids, last) - first_found;
    const std::int64_t gaps = last - found;
    const std::int64_t missing = rows_.head() ? old_head_.row_count - found : gaps;
    if (missing <= 0) return;
    if (!rows_.head() || gaps != missing || missing > kMostNames) {
      lost_count_ += missing;
      damages_.push_back(
          {0, fmt::format("{} rows up to row {} are not in the file any more{}", missing, last,
                          rows_.head() ? "" : ", or were removed before")});
      return;
    }
    for (std::int64_t id = 1; id <= last; ++id) {
      if (!std::ranges::binary_search(ids, id)) lose(id, "it is not in the file any more");
    }
  }

  void lose(std::int64_t id, const std::string& what) {
    ++lost_count_;
    if (known_.insert(id).second) damages_.push_back({id, what, false});
  }

  [[nodiscard]] StoreState new_head() const {
    StoreState state = tally_.found();
    state.generation = std::max(state.generation, old_head_.generation) + 1;
    state.last_row = std::max(state.last_row, old_head_.last_row);
    // Without the old epoch, one that was certainly never in use.
    state.epoch = rows_.head() ? old_head_.epoch + 1
                               : std::chrono::system_clock::now().time_since_epoch() /
                                     std::chrono::microseconds(1);
    return state;
  }

  CarvedRows& rows_;
  std::vector<Damage>& damages_;
  StoreState old_head_;
  std::set<std::int64_t> known_;
  std::vector<std::int64_t> saved_;  ///< in order
  std::int64_t lost_count_ = 0;
  KeySizes sizes_;
  Tally tally_{StoreState{}};
};

/// Writes what the header of every file of ours says, as far as SQLite needs it to find the pages.
Result<void> mend_header(const std::string& path, bool has_log) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::array<char, 100> header{};
  file.read(header.data(), header.size());
  file.clear();
  const unsigned page_size = static_cast<unsigned char>(header[16]) * 256U;
  const bool is_size = header[17] == 0 && page_size >= 512 && std::has_single_bit(page_size);
  std::string mended("SQLite format 3\0", 16);
  mended += static_cast<char>((is_size ? page_size : PageFile::kPageSize) / 256);
  mended += '\0';
  mended.append(2, has_log ? '\2' : '\1');
  mended += std::string("\0\x40\x20\x20", 4);
  file.seekp(0);
  file.write(mended.data(), static_cast<std::streamsize>(mended.size()));
  // No number of pages: then SQLite takes it from the length of the file.
  file.seekp(28);
  file.write("\0\0\0\0", 4);
  file.close();
  if (file) return {};
  return fail(ErrorCode::io, fmt::format("{}: cannot be written", path));
}

/// Copies file and log as they are, mends the header of the copy and has SQLite read that. Takes no
/// lock: under such a header nobody else gets one either.
Result<std::string> copy_under_mended_header(const std::string& path) {
  const std::string raw = path + ".salvage";
  remove_with_logs(raw);
  const auto copy = [&]() -> Result<std::string> {
    std::error_code error;
    fs::copy_file(path, raw, error);
    const bool has_log = !error && fs::exists(path + "-wal", error);
    if (has_log) fs::copy_file(path + "-wal", raw + "-wal", error);
    if (error) {
      return fail(ErrorCode::io, fmt::format("{}: cannot be copied: {}", path, error.message()));
    }
    const auto mended = mend_header(raw, has_log);
    if (!mended) return tl::unexpected(mended.error());
    auto connection = Connection::open(raw, Connection::Access::damaged);
    if (!connection) return tl::unexpected(connection.error());
    return copy_beside(*connection, path, "damaged");
  }();
  remove_with_logs(raw);
  return copy;
}

/// Copies everything that the file holds.
Result<std::string> copy_damaged(const std::string& path) {
  std::error_code ignored;
  auto connection = Connection::open(path, Connection::Access::damaged);
  if (!connection) return tl::unexpected(connection.error());
  if (connection->is_read_only()) {
    return fail(ErrorCode::io,
                fmt::format("{}: is read-only; expected a file that may be written", path));
  }
  const auto copy = copy_beside(*connection, path, "damaged");
  if (!copy && copy.error().code != ErrorCode::corrupt) return copy;
  // A damaged header may also claim that there are fewer pages.
  if (copy && fs::file_size(*copy, ignored) >= fs::file_size(path, ignored)) return copy;
  if (copy) remove_with_logs(*copy);
  return copy_under_mended_header(path);
}

}  // namespace

Result<std::string> salvage_file(const std::string& path, std::vector<Damage>& damages) {
  const auto copy = copy_damaged(path);
  if (!copy) return copy;
  auto rows = CarvedRows::read(*copy);
  if (!rows) {
    remove_with_logs(*copy);
    return fail(rows.error().code, fmt::format("{}: {}", path, rows.error().message));
  }
  const std::string fresh = path + ".salvage";
  remove_with_logs(fresh);
  Salvage salvage(*rows, damages);
  const auto replaced = [&]() -> Result<void> {
    auto target = Connection::open(fresh, Connection::Access::create);
    if (!target) return tl::unexpected(target.error());
    const auto saved = salvage.save_to(*target);
    if (!saved) return saved;
    auto original = Connection::open(path, Connection::Access::damaged);
    if (!original) return tl::unexpected(original.error());
    return original->replace_by(*target);
  }();
  remove_with_logs(fresh);
  if (!replaced) return tl::unexpected(replaced.error());
  damages.push_back(
      {0, fmt::format("{}; {} is what was there before", salvage.summary(), *copy), false});
  return copy;
}

}  // namespace mneme::internal
