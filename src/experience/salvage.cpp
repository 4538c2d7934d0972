// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/salvage.h"

#include "experience/database_file.h"
#include "experience/experience_table.h"
#include "experience/file_copy.h"
#include "experience/legacy_table.h"
#include "experience/schema.h"
#include "experience/store_reads.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>

namespace mneme::internal {
namespace {

class Salvage {
 public:
  Salvage(Connection& damaged, std::vector<Damage>& damages)
      : damaged_(damaged), damages_(damages) {
    for (const Damage& damage : damages) known_.insert(damage.id);
  }

  /// Writes what can be saved to `target`, an empty file.
  Result<void> save_to(Connection& target) {
    const auto version = damaged_.integer("PRAGMA user_version");
    if (!version) return tl::unexpected(version.error());
    is_legacy_ = *version == 1;
    auto space = read_space(damaged_);
    if (!space) return tl::unexpected(space.error());
    space_ = *space;
    read_dead();
    const auto created = create_schema(target, space_);
    if (!created) return created;
    auto transaction = Transaction::begin(target, Transaction::Kind::write);
    if (!transaction) return tl::unexpected(transaction.error());
    return save_rows(target).and_then([&] { return write_head(target, new_head()); }).and_then([&] {
      return transaction->commit();
    });
  }

 private:
  void read_dead() {
    if (is_legacy_) return;
    // What of the tombstones is legible; a row that loses its own is not sound either, or was
    // superseded by a row that says the same.
    (void)read_tombstones(damaged_, 0, [&](const Tombstone& tombstone) {
      if (checksum_of(tombstone) == tombstone.checksum) dead_.insert(tombstone.row);
      return Result<void>();
    });
  }

  /// An id that no row is beyond. A damaged file may claim to hold more rows than it has room for.
  std::int64_t last_id() {
    constexpr std::int64_t kLeastBytesPerRow = 16;
    const std::int64_t room = bytes_on_disk(damaged_.path()) / kLeastBytesPerRow;
    std::int64_t last = 0;
    const auto head = is_legacy_ ? read_legacy_head(damaged_) : read_head(damaged_);
    if (head) last = head->last_row;
    for (const char* table : {"experience", "mixture"}) {
      const auto largest =
          damaged_.integer(fmt::format("SELECT coalesce(max(id), 0) FROM {}", table));
      if (largest) last = std::max(last, std::min(*largest, room));
    }
    old_head_ = head.value_or(StoreState{});
    has_old_head_ = head.has_value();
    return head ? last : std::max(last, room);
  }

  Result<void> save_rows(Connection& target) {
    const std::int64_t last = last_id();
    for (std::int64_t id = 1; id <= last; ++id) {
      if (dead_.contains(id)) continue;
      Result<void> saved;
      const auto save = [&](const StoredRow& row) -> Result<void> {
        Experience experience;
        if (const auto flaw = decode(row, space_, experience)) {
          lose(id, *flaw);
          return {};
        }
        tally_.add(row);
        return saved = add_rows(target, std::span(&row, 1));
      };
      const std::span<const std::int64_t> ids(&id, 1);
      const auto read = is_legacy_ ? read_legacy_rows_by_id(damaged_, ids, save)
                                   : read_rows_by_id(damaged_, ids, save);
      if (!saved) return saved;
      if (!read && read.error().code != ErrorCode::corrupt) return read;
      if (!read) lose(id, "it cannot be read: " + read.error().message);
    }
    return {};
  }

  void lose(std::int64_t id, const std::string& what) {
    if (known_.insert(id).second) damages_.push_back({id, what, false});
  }

  [[nodiscard]] StoreState new_head() const {
    StoreState state = tally_.found();
    state.generation = std::max(state.generation, old_head_.generation) + 1;
    state.last_row = std::max(state.last_row, old_head_.last_row);
    // Without the old epoch, one that was certainly never in use.
    state.epoch = has_old_head_ ? old_head_.epoch + 1
                                : std::chrono::system_clock::now().time_since_epoch() /
                                      std::chrono::microseconds(1);
    return state;
  }

  Connection& damaged_;
  std::vector<Damage>& damages_;
  std::set<std::int64_t> known_;
  std::set<std::int64_t> dead_;
  ExperienceSpace space_;
  bool is_legacy_ = false;
  bool has_old_head_ = false;
  StoreState old_head_;
  Tally tally_{StoreState{}};
};

}  // namespace

Result<std::string> salvage_file(Connection& damaged, std::vector<Damage>& damages) {
  const auto copy = copy_beside(damaged, "damaged");
  if (!copy) return copy;
  const std::string path = damaged.path() + ".salvage";
  remove_with_logs(path);
  const auto replaced = [&]() -> Result<void> {
    auto target = Connection::open(path, Connection::Access::create);
    if (!target) return tl::unexpected(target.error());
    const auto saved = Salvage(damaged, damages).save_to(*target);
    if (!saved) return saved;
    auto original = open_for_writing(damaged.path(), false);
    if (!original) return tl::unexpected(original.error());
    return original->copy_from(*target);
  }();
  remove_with_logs(path);
  if (!replaced) return tl::unexpected(replaced.error());
  return copy;
}

}  // namespace mneme::internal
