// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/migration.h"

#include "base/fail.h"
#include "store/row_check.h"
#include "store/store.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <set>

namespace mneme::internal {
namespace {

bool is_sound_key(const StoredRow& row) {
  ColumnDigest digest;
  digest.add(row.id).add(row.generation).add(row.cell).add(row.content).add(row.components);
  return digest.add(row.columns.kind).add(row.columns.key).value() == row.key_checksum;
}

bool is_sound_mixture(const StoredRow& row) {
  const RowView& columns = row.columns;
  ColumnDigest digest;
  digest.add(row.id).add(row.cell).add(columns.means).add(columns.factor_rows).add(columns.factors);
  digest.add(columns.sources).add(columns.tool).add(columns.settings).add(columns.time);
  return digest.add(columns.seed).value() == row.mixture_checksum && row.flaw.empty();
}

/// The number in "solved problem NAME, planned in N states".
std::optional<std::int64_t> states_in(std::string_view settings) {
  constexpr std::string_view kBefore = ", planned in ", kAfter = " states";
  const std::size_t begin = settings.rfind(kBefore);
  if (begin == std::string_view::npos) return std::nullopt;
  const std::string_view number = settings.substr(begin + kBefore.size());
  std::uint64_t states = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), states);
  const std::string_view rest = number.substr(static_cast<std::size_t>(end - number.data()));
  if (error != std::errc() || rest != kAfter) return std::nullopt;
  return std::bit_cast<std::int64_t>(states);
}

/// Schema 3 added 1000 times the number of the constraints to the first number of a path's key, the
/// distance of its ends. Subtracts it and returns the number of the constraints.
std::int64_t take_constraints(std::vector<double>& key) {
  const std::size_t end_size = (key.size() - 1) / 2;
  double sum = 0;
  for (std::size_t i = 1; i <= end_size; ++i) sum += std::pow(key[i + end_size] - key[i], 2);
  const double number = std::round((key[0] - std::sqrt(sum)) / 1000);
  if (!(number > 0 && number <= 900)) return 0;
  key[0] = std::sqrt(sum);
  return static_cast<std::int64_t>(number);
}

/// A row of schema 3, converted.
class UpgradedRow {
 public:
  explicit UpgradedRow(const StoredRow& old) : row_(old) {
    RowView& columns = row_.columns;
    row_.flaw.clear();
    columns.is_path = holds_paths(columns.kind);
    columns.is_complete = columns.is_path || !columns.settings.ends_with(" cut short");
    if (columns.is_path) {
      columns.planning_states = states_in(columns.settings);
      separate_constraints();
    }
    content_ = content_hash(columns);
    row_.content = content_;
    row_.key_checksum = key_checksum(row_);
    row_.mixture_checksum = mixture_checksum(row_);
    const bool has_sound_key = is_sound_key(old), has_sound_mixture = is_sound_mixture(old);
    if (!has_sound_key) row_.key_checksum ^= 1;
    if (!has_sound_mixture) row_.mixture_checksum ^= 1;
    is_sound_ = has_sound_key && has_sound_mixture;
  }
  UpgradedRow(const UpgradedRow&) = delete;
  UpgradedRow& operator=(const UpgradedRow&) = delete;

  /// Valid as long as this and the old row.
  [[nodiscard]] const StoredRow& row() const { return row_; }
  [[nodiscard]] const ContentHash& content() const { return content_; }
  [[nodiscard]] bool is_sound() const { return is_sound_; }

 private:
  void separate_constraints() {
    std::vector<double> key;
    if (!from_bytes(row_.columns.key, key) || key.empty()) return;
    row_.columns.constraints = take_constraints(key);
    if (row_.columns.constraints == 0) return;
    key_ = to_bytes(key);
    row_.columns.key = key_;
    row_.cell = cell_of(key);
  }

  StoredRow row_;
  ContentHash content_{};
  std::vector<std::byte> key_;
  bool is_sound_ = false;
};

tl::unexpected<Error> missing(const std::string& store, const std::string& what) {
  return fail(ErrorCode::corrupt, "{}: {}; repair it with the mneme version that wrote it", store,
              what);
}

}  // namespace

Result<RobotSignature> upgraded_robot(const std::string& store, std::string_view name,
                                      std::string_view hashes, int joint_count,
                                      std::int64_t checksum) {
  const std::string text = fmt::format("{}\n{}\n{}", name, hashes, joint_count);
  if (hash_bytes(std::as_bytes(std::span(text))) != checksum || joint_count < 1) {
    return fail(ErrorCode::corrupt, "{}: the row that names the robot is damaged", store);
  }
  // "kinematics/model", or the model alone.
  const std::size_t slash = hashes.find('/');
  const bool has_both = slash != std::string_view::npos;
  return RobotSignature{std::string(name), std::string(hashes.substr(0, has_both ? slash : 0)),
                        std::string(hashes.substr(has_both ? slash + 1 : 0)), joint_count};
}

Result<void> migrate_rows(const std::string& store, const OldRows& old_rows, StoreTransaction& to) {
  const StoreState head = MNEME_TRY(to.head());
  StoreState counted;
  std::set<std::int64_t> dead;
  MNEME_TRY(to.read_tombstones(0, [&](const Tombstone& tombstone) -> Result<void> {
    if (checksum_of(tombstone) != tombstone.checksum) {
      return missing(store, fmt::format("tombstone {} is damaged", tombstone.id));
    }
    count(tombstone, counted);
    dead.insert(tombstone.row);
    return {};
  }));
  StoreState state = head;
  ++state.generation;
  ++state.epoch;
  state.row_count = state.row_digest = state.tombstone_count = state.tombstone_digest = 0;
  std::set<ContentHash> known;
  MNEME_TRY(old_rows([&](std::span<const StoredRow> rows) -> Result<void> {
    std::vector<std::unique_ptr<const UpgradedRow>> upgraded;
    std::vector<StoredRow> live;
    for (const StoredRow& old : rows) {
      count(old, counted);
      if (dead.contains(old.id)) continue;
      const auto& row = upgraded.emplace_back(std::make_unique<const UpgradedRow>(old));
      // A damaged row does not count as known: it must not hide a sound one.
      if (row->is_sound() && !known.insert(row->content()).second) continue;
      live.push_back(row->row());
      ++state.row_count;
      state.row_digest ^= tally_mark(live.back().id, live.back().key_checksum);
    }
    return to.add_rows(live);
  }));
  if (const auto flaw = describe_difference(counted, head)) return missing(store, *flaw);
  MNEME_TRY(to.remove_dead());
  return to.set_head(state);
}

}  // namespace mneme::internal
