// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "upkeep/salvage.h"

#include "store/database_file.h"
#include "store/row_check.h"
#include "store/sqlite_connection.h"
#include "store/sqlite_store.h"
#include "store/store_reads.h"
#include "store/store_writes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

namespace mneme::internal {
namespace {

// The columns of our tables: null (SQLite keeps a row's id apart), integers, texts, blobs.
constexpr std::string_view kSpaceShape = "nttii";
constexpr std::string_view kHeadShape = "niiiiiiiii";
constexpr std::string_view kTombstoneShape = "niitti";
constexpr std::string_view kKeyShape = "niitbibi";
constexpr std::string_view kMixtureShape = "nibbbbttiti";

bool has_shape(const LeafRecord& record, std::string_view shape) {
  constexpr std::string_view kLetters = "nirtb";  // in the order of Field::Kind
  return std::ranges::equal(record.fields, shape, [&](const Field& field, char letter) {
    return kLetters[static_cast<std::size_t>(field.kind)] == letter;
  });
}

void fill_key(const LeafRecord& record, StoredRow& row) {
  row.id = record.id;
  row.generation = record.fields[1].integer;
  row.cell = record.fields[2].integer;
  row.columns.kind = record.fields[3].text();
  row.content = record.fields[4].bytes;
  row.components = record.fields[5].integer;
  row.columns.key = record.fields[6].bytes;
  row.key_checksum = record.fields[7].integer;
}

/// All columns but those that stand with the key.
void fill_mixture(const LeafRecord& record, StoredRow& row) {
  const auto& fields = record.fields;
  row.id = record.id;
  row.columns.means = fields[2].bytes;
  row.columns.factor_rows = fields[3].bytes;
  row.columns.factors = fields[4].bytes;
  row.columns.origins = fields[5].bytes;
  row.columns.tool = fields[6].text();
  row.columns.settings = fields[7].text();
  row.columns.seed = fields[8].integer;
  row.columns.time = fields[9].text();
  row.mixture_checksum = fields[10].integer;
}

}  // namespace

Result<CarvedRows> CarvedRows::read(const std::string& path) {
  auto file = PageFile::open(path);
  if (!file) return tl::unexpected(file.error());
  CarvedRows rows(std::move(*file));
  const auto visited = rows.file_.visit_records(
      [&](const LeafRecord& record, RecordPlace place) { rows.take(record, place); });
  if (!visited) return tl::unexpected(visited.error());
  if (rows.spaces_.size() != 1) {
    return fail(ErrorCode::corrupt,
                rows.spaces_.empty()
                    ? "the row that names the robot is missing or damaged; no other "
                      "row means anything without it"
                    : "there are rows that name different robots");
  }
  rows.space_ = rows.spaces_.front();
  for (auto* parts : {&rows.keys_, &rows.mixtures_}) {
    std::ranges::sort(*parts, {},
                      [](const Part& part) { return std::pair(part.id, part.is_sound ? 0 : 1); });
    const auto is_repeated = [](const Part& a, const Part& b) { return a.id == b.id; };
    parts->erase(std::unique(parts->begin(), parts->end(), is_repeated), parts->end());
  }
  return rows;
}

void CarvedRows::take(const LeafRecord& record, RecordPlace place) {
  StoredRow row;
  if (has_shape(record, kKeyShape)) {
    fill_key(record, row);
    keys_.push_back({row.id, place, key_checksum(row) == row.key_checksum});
  } else if (has_shape(record, kMixtureShape)) {
    fill_mixture(record, row);
    row.cell = record.fields[1].integer;
    mixtures_.push_back({row.id, place, mixture_checksum(row) == row.mixture_checksum});
  } else if (has_shape(record, kSpaceShape)) {
    take_space(record);
  } else if (has_shape(record, kHeadShape)) {
    take_head(record);
  } else if (has_shape(record, kTombstoneShape)) {
    take_tombstone(record);
  }
}

void CarvedRows::take_space(const LeafRecord& record) {
  const auto& fields = record.fields;
  ExperienceSpace space;
  space.robot_name = fields[1].text();
  space.robot_hash = fields[2].text();
  space.joint_count = static_cast<int>(fields[3].integer);
  if (checksum_of(space) != fields[4].integer || space.joint_count < 1) return;
  const bool is_known = std::ranges::any_of(
      spaces_, [&](const ExperienceSpace& known) { return is_same_space(known, space); });
  if (!is_known) spaces_.push_back(std::move(space));
}

void CarvedRows::take_head(const LeafRecord& record) {
  std::array<std::int64_t, kHeadSize> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = record.fields[i + 1].integer;
  if (hash_numbers(numbers) != record.fields[kHeadSize + 1].integer) return;
  const StoreState state = to_state(numbers);
  if (!head_ || head_->generation < state.generation) head_ = state;
}

void CarvedRows::take_tombstone(const LeafRecord& record) {
  const auto& fields = record.fields;
  const Tombstone tombstone{record.id,
                            fields[1].integer,
                            fields[2].integer,
                            std::string(fields[3].text()),
                            std::string(fields[4].text()),
                            fields[5].integer};
  // Of a damaged one nothing is known. The row that it was of is not sound either, or was
  // superseded by a row that says the same.
  if (checksum_of(tombstone) == tombstone.checksum) dead_.insert(tombstone.row);
}

std::vector<std::int64_t> CarvedRows::ids() const {
  std::vector<std::int64_t> ids;
  for (const auto* parts : {&keys_, &mixtures_}) {
    for (const Part& part : *parts) ids.push_back(part.id);
  }
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

Result<bool> CarvedRows::read_part(const std::vector<Part>& parts, std::int64_t id,
                                   LeafRecord& record) {
  const auto part = std::ranges::lower_bound(parts, id, {}, &Part::id);
  if (part == parts.end() || part->id != id) return false;
  return file_.read_record(part->place, record).map([] { return true; });
}

Result<StoredRow> CarvedRows::row(std::int64_t id) {
  StoredRow row;
  const auto has_mixture = read_part(mixtures_, id, mixture_);
  if (!has_mixture) return tl::unexpected(has_mixture.error());
  if (*has_mixture) fill_mixture(mixture_, row);
  const auto has_key = read_part(keys_, id, key_);
  if (!has_key) return tl::unexpected(has_key.error());
  if (*has_key) fill_key(key_, row);
  if (!*has_mixture) row.flaw = "its mixture is missing";
  if (!*has_key) row.flaw = "its key is missing";
  return row;
}

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
    state.epoch = next_epoch(rows_.head() ? &old_head_ : nullptr);
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
    const std::string log = log_path(path);
    const bool has_log = !error && fs::exists(log, error);
    if (has_log) fs::copy_file(log, raw + "-wal", error);
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

/// Puts a file with what can be saved in the place of `path`, which must still have that stamp once
/// nobody else can write to it: otherwise leaves it as it is and returns false.
Result<bool> replace_file(const std::string& path, const FileStamp& stamp, Salvage& salvage) {
  const std::string fresh = path + ".salvage";
  remove_with_logs(fresh);
  const auto replaced = [&]() -> Result<bool> {
    auto target = Connection::open(fresh, Connection::Access::create);
    if (!target) return tl::unexpected(target.error());
    const auto saved = salvage.save_to(*target);
    if (!saved) return tl::unexpected(saved.error());
    auto original = Connection::open(path, Connection::Access::damaged);
    if (!original) return tl::unexpected(original.error());
    return original->replace_by(*target, [&] { return stamp_of(path) == stamp; });
  }();
  remove_with_logs(fresh);
  return replaced;
}

/// What salvage_file() does. Nothing, and nothing is changed, if others wrote to the file
/// meanwhile.
Result<std::optional<std::string>> try_salvage(const std::string& path,
                                               std::vector<Damage>& damages) {
  const FileStamp stamp = stamp_of(path);
  std::this_thread::sleep_for(kStampStep);
  auto copy = copy_damaged(path);
  if (!copy) return tl::unexpected(copy.error());
  auto rows = CarvedRows::read(*copy);
  if (!rows) {
    remove_with_logs(*copy);
    return fail(rows.error().code, fmt::format("{}: {}", path, rows.error().message));
  }
  std::vector<Damage> found = damages;
  Salvage salvage(*rows, found);
  const auto replaced = replace_file(path, stamp, salvage);
  if (!replaced) return tl::unexpected(replaced.error());
  if (!*replaced) {
    remove_with_logs(*copy);
    return std::nullopt;
  }
  damages = std::move(found);
  damages.push_back(
      {0, fmt::format("{}; {} is what was there before", salvage.summary(), *copy), false});
  return std::optional(std::move(*copy));
}

}  // namespace

Result<std::string> salvage_file(const std::string& path, std::vector<Damage>& damages) {
  constexpr int kMostAttempts = 3;
  for (int i = 0; i < kMostAttempts; ++i) {
    auto copy = try_salvage(path, damages);
    if (!copy) return tl::unexpected(copy.error());
    if (*copy) return std::move(**copy);
  }
  return fail(
      ErrorCode::io,
      fmt::format("{}: others wrote to it whenever it was built anew; stop them first", path));
}

}  // namespace mneme::internal
