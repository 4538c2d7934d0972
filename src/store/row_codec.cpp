// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/row_codec.h"

#include "store/row_check.h"
#include "store/store.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>

namespace mneme::internal {
namespace {

std::optional<std::string> describe_mismatch(const char* what, std::int64_t stored,
                                             std::int64_t actual) {
  if (stored == actual) return std::nullopt;
  return fmt::format("the checksum of its {} is {:016x}, but the content has {:016x}", what,
                     std::bit_cast<std::uint64_t>(stored), std::bit_cast<std::uint64_t>(actual));
}

}  // namespace

static_assert(sizeof(float) == 4 && sizeof(double) == 8 && sizeof(int) == 4);

EncodedRow::EncodedRow(const Experience& experience) {
  const Provenance& provenance = experience.provenance;
  RowView& columns = stored_.columns;
  blobs_[0] = to_bytes(experience.key);
  if (experience.is_path()) {
    const RememberedPath& path = experience.path();
    blobs_[1] = to_bytes(path.waypoints);
    std::vector<float> surroundings = path.clearances;
    surroundings.insert(surroundings.end(), path.near_misses.begin(), path.near_misses.end());
    blobs_[3] = to_bytes(surroundings);
    columns.is_path = true;
    columns.constraints = std::bit_cast<std::int64_t>(path.constraints);
    if (path.planning_states) {
      columns.planning_states = std::bit_cast<std::int64_t>(*path.planning_states);
    }
  } else {
    const LocalSampler& sampler = experience.sampler();
    blobs_[1] = to_bytes(sampler.means);
    blobs_[2] = to_bytes(sampler.factor_rows);
    blobs_[3] = to_bytes(sampler.factors);
    blobs_[4] = to_bytes(sampler.sources);
    columns.is_complete = sampler.is_complete;
  }
  columns.kind = experience.kind;
  columns.key = blobs_[0];
  columns.means = blobs_[1];
  columns.factor_rows = blobs_[2];
  columns.factors = blobs_[3];
  columns.sources = blobs_[4];
  columns.tool = provenance.tool;
  columns.settings = provenance.settings;
  columns.seed = std::bit_cast<std::int64_t>(provenance.seed);
  columns.time = provenance.time;
  content_ = std::make_unique<const ContentHash>(content_hash(columns));
  stored_.content = *content_;
  stored_.cell = cell_of(experience.key);
  stored_.components = experience.component_count();
}

StoredRow EncodedRow::stored(std::int64_t id, std::int64_t generation) const {
  StoredRow row = stored_;
  row.id = id;
  row.generation = generation;
  row.key_checksum = key_checksum(row);
  row.mixture_checksum = mixture_checksum(row);
  return row;
}

std::int64_t cell_of(const std::vector<double>& key) {
  std::vector<std::int64_t> steps;
  // Numbers of stored keys are at most kMaxKeyMagnitude, so that no conversion overflows.
  for (const double number : key) {
    steps.push_back(static_cast<std::int64_t>(std::floor(number / kCellEdge)));
  }
  return hash_numbers(steps);
}

std::int64_t hash_bytes(std::span<const std::byte> bytes) {
  return std::bit_cast<std::int64_t>(XXH3_64bits(bytes.data(), bytes.size()));
}

std::int64_t hash_numbers(std::span<const std::int64_t> numbers) {
  if constexpr (std::endian::native == std::endian::big) {
    std::vector<std::int64_t> copy(numbers.begin(), numbers.end());
    swap_to_little_endian(std::as_writable_bytes(std::span(copy)), sizeof(std::int64_t));
    return hash_bytes(std::as_bytes(std::span(copy)));
  }
  return hash_bytes(std::as_bytes(numbers));
}

ContentHash content_hash(const RowView& row) {
  std::vector<std::byte> bytes;
  const auto add_number = [&](std::int64_t number) {
    const auto at = bytes.size();
    const auto raw = std::as_bytes(std::span(&number, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
    swap_to_little_endian(std::span(bytes).subspan(at), sizeof number);
  };
  for (const auto column : {std::as_bytes(std::span(row.kind)), row.key, row.means, row.factor_rows,
                            row.factors, row.sources}) {
    add_number(static_cast<std::int64_t>(column.size()));
    bytes.insert(bytes.end(), column.begin(), column.end());
  }
  add_number(row.constraints);
  add_number(row.is_path);
  add_number(row.is_complete);
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes.data(), bytes.size()));
  ContentHash hash;
  static_assert(sizeof canonical.digest == sizeof hash);
  std::memcpy(hash.data(), canonical.digest, hash.size());
  return hash;
}

std::string to_hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) text += fmt::format("{:02x}", std::to_integer<unsigned>(byte));
  return text;
}

std::int64_t key_checksum(const StoredRow& row) {
  ColumnDigest digest;
  digest.add(row.id).add(row.generation).add(row.cell).add(row.content).add(row.components);
  return digest.add(row.columns.kind).add(row.columns.key).add(row.columns.constraints).value();
}

std::int64_t mixture_checksum(const StoredRow& row) {
  const RowView& columns = row.columns;
  ColumnDigest digest;
  digest.add(row.id).add(row.cell).add(columns.is_path).add(columns.means);
  digest.add(columns.factor_rows).add(columns.factors).add(columns.sources);
  digest.add(columns.is_complete).add(columns.planning_states.has_value());
  digest.add(columns.planning_states.value_or(0)).add(columns.tool).add(columns.settings);
  return digest.add(columns.time).add(columns.seed).value();
}

std::int64_t tally_mark(std::int64_t id, std::int64_t checksum) {
  return hash_numbers(std::array{id, checksum});
}

namespace {

/// A path's column of factors holds its clearances, then its near misses.
void split_surroundings(const std::vector<float>& surroundings, RememberedPath& path) {
  const auto first = surroundings.begin();
  const auto count = std::min<std::ptrdiff_t>(path.waypoint_count(), std::ssize(surroundings));
  path.clearances.assign(first, first + count);
  path.near_misses.assign(first + count, surroundings.end());
}

/// Everything except id, kind and key.
std::optional<std::string> decode_content(const RowView& columns, const RobotSignature& signature,
                                          Experience& experience) {
  bool is_whole = true;
  if (columns.is_path) {
    RememberedPath& path = experience.content.emplace<RememberedPath>();
    path.joint_count = signature.joint_count;
    path.constraints = std::bit_cast<std::uint64_t>(columns.constraints);
    if (columns.planning_states) {
      path.planning_states = std::bit_cast<std::uint64_t>(*columns.planning_states);
    }
    std::vector<float> surroundings;
    is_whole =
        from_bytes(columns.means, path.waypoints) && from_bytes(columns.factors, surroundings);
    split_surroundings(surroundings, path);
  } else {
    LocalSampler& sampler = experience.content.emplace<LocalSampler>();
    sampler.joint_count = signature.joint_count;
    sampler.is_complete = columns.is_complete;
    is_whole = from_bytes(columns.means, sampler.means) &&
               from_bytes(columns.factor_rows, sampler.factor_rows) &&
               from_bytes(columns.factors, sampler.factors) &&
               from_bytes(columns.sources, sampler.sources);
  }
  if (!is_whole) return "a column ends in the middle of a number";
  experience.provenance = {std::string(columns.tool), std::string(columns.settings),
                           std::bit_cast<std::uint64_t>(columns.seed), std::string(columns.time)};
  return describe_flaw(experience, signature);
}

}  // namespace

std::optional<std::string> decode_key(const StoredRow& row, Experience& experience) {
  if (!row.flaw.empty()) return row.flaw;
  if (auto flaw = describe_mismatch("key", row.key_checksum, key_checksum(row))) return flaw;
  if (!from_bytes(row.columns.key, experience.key)) {
    return "its key ends in the middle of a number";
  }
  experience.id = row.id;
  experience.kind = row.columns.kind;
  return describe_key_flaw(experience.kind, experience.key);
}

std::optional<std::string> decode(const StoredRow& row, const RobotSignature& signature,
                                  Experience& experience) {
  if (auto flaw = decode_key(row, experience)) return flaw;
  if (auto flaw = describe_mismatch("mixture", row.mixture_checksum, mixture_checksum(row))) {
    return flaw;
  }
  if (auto flaw = decode_content(row.columns, signature, experience)) return flaw;
  const ContentHash hash = content_hash(row.columns);
  if (std::ranges::equal(row.content, hash) && row.components == experience.component_count() &&
      row.cell == cell_of(experience.key)) {
    return std::nullopt;
  }
  return fmt::format("its content hash {} does not match its content", to_hex(row.content));
}

std::array<std::int64_t, kHeadSize> to_numbers(const StoreState& state) {
  return {state.generation, state.epoch,      state.last_row,        state.last_tombstone,
          state.row_count,  state.row_digest, state.tombstone_count, state.tombstone_digest};
}

StoreState to_state(std::span<const std::int64_t, kHeadSize> numbers) {
  return {numbers[0], numbers[1], numbers[2], numbers[3],
          numbers[4], numbers[5], numbers[6], numbers[7]};
}

std::int64_t next_epoch(const StoreState* old_head) {
  if (old_head != nullptr) return old_head->epoch + 1;
  return std::chrono::system_clock::now().time_since_epoch() / std::chrono::microseconds(1);
}

std::int64_t checksum_of(const Tombstone& tombstone) {
  const std::string text = fmt::format("{}\n{}\n{}\n{}\n{}", tombstone.id, tombstone.row,
                                       tombstone.generation, tombstone.time, tombstone.reason);
  return hash_bytes(std::as_bytes(std::span(text)));
}

std::int64_t checksum_of(const RobotSignature& signature) {
  const std::string text =
      fmt::format("{}\n{}\n{}\n{}", signature.robot_name, signature.kinematics_hash,
                  signature.model_hash, signature.joint_count);
  return hash_bytes(std::as_bytes(std::span(text)));
}

}  // namespace mneme::internal
