// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/row_codec.h"

#include "store/row_check.h"
#include "store/store.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace mneme::internal {
namespace {

void swap_to_little_endian([[maybe_unused]] std::span<std::byte> bytes,
                           [[maybe_unused]] std::size_t element_size) {
  if constexpr (std::endian::native == std::endian::big) {
    for (std::size_t i = 0; i + element_size <= bytes.size(); i += element_size) {
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                   bytes.begin() + static_cast<std::ptrdiff_t>(i + element_size));
    }
  }
}

template <class Number>
std::vector<std::byte> to_bytes(const std::vector<Number>& numbers) {
  const auto raw = std::as_bytes(std::span(numbers));
  std::vector<std::byte> bytes(raw.begin(), raw.end());
  swap_to_little_endian(bytes, sizeof(Number));
  return bytes;
}

/// False if the bytes are not a whole number of elements.
template <class Number>
bool from_bytes(std::span<const std::byte> bytes, std::vector<Number>& numbers) {
  if (bytes.size() % sizeof(Number) != 0) return false;
  numbers.resize(bytes.size() / sizeof(Number));
  if (!bytes.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  swap_to_little_endian(std::as_writable_bytes(std::span(numbers)), sizeof(Number));
  return true;
}

/// Sizes and hashes of columns, so that bytes cannot move from one column to the next unnoticed.
class ColumnDigest {
 public:
  ColumnDigest() { numbers_.reserve(kMostNumbers); }
  ColumnDigest& add(std::int64_t number) {
    numbers_.push_back(number);
    return *this;
  }
  ColumnDigest& add(std::span<const std::byte> bytes) {
    return add(static_cast<std::int64_t>(bytes.size())).add(hash_bytes(bytes));
  }
  ColumnDigest& add(std::string_view text) { return add(std::as_bytes(std::span(text))); }
  ColumnDigest& add_mixture(const RowView& row) {
    add(row.means).add(row.factor_rows).add(row.factors).add(row.origins);
    return add(row.tool).add(row.settings).add(row.time).add(row.seed);
  }
  [[nodiscard]] std::int64_t value() const { return hash_numbers(numbers_); }

 private:
  static constexpr std::size_t kMostNumbers = 18;
  std::vector<std::int64_t> numbers_;
};

std::optional<std::string> describe_mismatch(const char* what, std::int64_t stored,
                                             std::int64_t actual) {
  if (stored == actual) return std::nullopt;
  return fmt::format("the checksum of its {} is {:016x}, but the content has {:016x}", what,
                     std::bit_cast<std::uint64_t>(stored), std::bit_cast<std::uint64_t>(actual));
}

}  // namespace

static_assert(sizeof(float) == 4 && sizeof(double) == 8 && sizeof(int) == 4);

EncodedRow::EncodedRow(const Experience& experience)
    : blobs_{to_bytes(experience.key), to_bytes(experience.sampler.means),
             to_bytes(experience.sampler.factor_rows), to_bytes(experience.sampler.factors),
             to_bytes(experience.sampler.sources)} {
  stored_.columns = {experience.kind,
                     blobs_[0],
                     blobs_[1],
                     blobs_[2],
                     blobs_[3],
                     blobs_[4],
                     experience.provenance.tool,
                     experience.provenance.settings,
                     std::bit_cast<std::int64_t>(experience.provenance.seed),
                     experience.provenance.time};
  content_ = std::make_unique<const ContentHash>(content_hash(stored_.columns));
  stored_.content = *content_;
  stored_.cell = cell_of(experience.key);
  stored_.components = experience.sampler.component_count();
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
  bytes.reserve(row.kind.size() + row.key.size() + row.means.size() + row.factor_rows.size() +
                row.factors.size() + row.origins.size() + row.settings.size() +
                8 * sizeof(std::int64_t));
  const auto add_number = [&](std::int64_t number) {
    const auto at = bytes.size();
    const auto raw = std::as_bytes(std::span(&number, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
    swap_to_little_endian(std::span(bytes).subspan(at), sizeof number);
  };
  for (const auto column : {std::as_bytes(std::span(row.kind)), row.key, row.means, row.factor_rows,
                            row.factors, row.origins, std::as_bytes(std::span(row.settings))}) {
    add_number(static_cast<std::int64_t>(column.size()));
    bytes.insert(bytes.end(), column.begin(), column.end());
  }
  add_number(row.seed);
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
  return digest.add(row.columns.kind).add(row.columns.key).value();
}

std::int64_t mixture_checksum(const StoredRow& row) {
  return ColumnDigest().add(row.id).add(row.cell).add_mixture(row.columns).value();
}

std::int64_t tally_mark(std::int64_t id, std::int64_t checksum) {
  return hash_numbers(std::array{id, checksum});
}

namespace {

/// All but id, kind and key.
std::optional<std::string> decode_mixture(const RowView& columns, const ExperienceSpace& space,
                                          Experience& experience) {
  LocalSampler& sampler = experience.sampler;
  if (!from_bytes(columns.means, sampler.means) ||
      !from_bytes(columns.factor_rows, sampler.factor_rows) ||
      !from_bytes(columns.factors, sampler.factors) ||
      !from_bytes(columns.origins, sampler.sources)) {
    return "a column ends in the middle of a number";
  }
  sampler.joint_count = space.joint_count;
  experience.provenance = {std::string(columns.tool), std::string(columns.settings),
                           std::bit_cast<std::uint64_t>(columns.seed), std::string(columns.time)};
  return describe_flaw(experience, space);
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

std::optional<std::string> decode(const StoredRow& row, const ExperienceSpace& space,
                                  Experience& experience) {
  if (auto flaw = decode_key(row, experience)) return flaw;
  if (auto flaw = describe_mismatch("mixture", row.mixture_checksum, mixture_checksum(row))) {
    return flaw;
  }
  if (auto flaw = decode_mixture(row.columns, space, experience)) return flaw;
  const ContentHash hash = content_hash(row.columns);
  if (std::ranges::equal(row.content, hash) &&
      row.components == experience.sampler.component_count() &&
      row.cell == cell_of(experience.key)) {
    return std::nullopt;
  }
  return fmt::format("its content hash {} is that of another row", to_hex(row.content));
}

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
