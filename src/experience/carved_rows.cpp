// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/carved_rows.h"

#include "experience/space.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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
    const auto repeated = std::ranges::unique(*parts, {}, &Part::id);
    parts->erase(repeated.begin(), repeated.end());
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
  const auto repeated = std::ranges::unique(ids);
  ids.erase(repeated.begin(), repeated.end());
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

}  // namespace mneme::internal
