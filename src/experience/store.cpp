// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/store.h"

#include <fmt/format.h>

namespace mneme::internal {

std::array<std::int64_t, kHeadSize> to_numbers(const StoreState& state) {
  return {state.generation, state.epoch,      state.last_row,        state.last_tombstone,
          state.row_count,  state.row_digest, state.tombstone_count, state.tombstone_digest};
}

StoreState to_state(std::span<const std::int64_t, kHeadSize> numbers) {
  return {numbers[0], numbers[1], numbers[2], numbers[3],
          numbers[4], numbers[5], numbers[6], numbers[7]};
}

std::int64_t checksum_of(const Tombstone& tombstone) {
  const std::string text = fmt::format("{}\n{}\n{}\n{}\n{}", tombstone.id, tombstone.row,
                                       tombstone.generation, tombstone.time, tombstone.reason);
  return hash_bytes(std::as_bytes(std::span(text)));
}

std::int64_t checksum_of(const ExperienceSpace& space) {
  const std::string text =
      fmt::format("{}\n{}\n{}", space.robot_name, space.robot_hash, space.joint_count);
  return hash_bytes(std::as_bytes(std::span(text)));
}

}  // namespace mneme::internal
