// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/row_codec.h"

#include "experience/row_check.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
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

}  // namespace

static_assert(sizeof(float) == 4 && sizeof(double) == 8 && sizeof(int) == 4);

EncodedRow::EncodedRow(const Experience& experience)
    : blobs_{to_bytes(experience.key), to_bytes(experience.sampler.means),
             to_bytes(experience.sampler.factor_rows), to_bytes(experience.sampler.factors),
             to_bytes(experience.sampler.origins)},
      view_{blobs_[0],
            blobs_[1],
            blobs_[2],
            blobs_[3],
            blobs_[4],
            experience.provenance.tool,
            experience.provenance.settings,
            std::bit_cast<std::int64_t>(experience.provenance.seed),
            experience.provenance.time} {}

std::int64_t hash_bytes(std::span<const std::byte> bytes) {
  return std::bit_cast<std::int64_t>(XXH3_64bits(bytes.data(), bytes.size()));
}

std::int64_t checksum_of(const RowView& row) {
  // Size and hash of each column, so that bytes cannot move from one column to the next unnoticed.
  std::array<std::int64_t, 17> digest{};
  std::size_t count = 0;
  for (const auto bytes :
       {row.key, row.means, row.factor_rows, row.factors, row.origins,
        std::as_bytes(std::span(row.tool)), std::as_bytes(std::span(row.settings)),
        std::as_bytes(std::span(row.time))}) {
    digest[count++] = static_cast<std::int64_t>(bytes.size());
    digest[count++] = hash_bytes(bytes);
  }
  digest[count] = row.seed;
  const auto bytes = std::as_writable_bytes(std::span(digest));
  swap_to_little_endian(bytes, sizeof(std::int64_t));
  return hash_bytes(bytes);
}

std::int64_t tally_mark(std::int64_t id, std::int64_t checksum) {
  std::array<std::int64_t, 2> pair = {id, checksum};
  const auto bytes = std::as_writable_bytes(std::span(pair));
  swap_to_little_endian(bytes, sizeof(std::int64_t));
  return hash_bytes(bytes);
}

std::optional<std::string> decode(const RowView& row, std::int64_t checksum,
                                  const ExperienceSpace& space, Experience& experience) {
  if (const std::int64_t actual = checksum_of(row); actual != checksum) {
    return fmt::format("its checksum is {:016x}, but its content has {:016x}",
                       std::bit_cast<std::uint64_t>(checksum),
                       std::bit_cast<std::uint64_t>(actual));
  }
  LocalSampler& sampler = experience.sampler;
  if (!from_bytes(row.key, experience.key) || !from_bytes(row.means, sampler.means) ||
      !from_bytes(row.factor_rows, sampler.factor_rows) ||
      !from_bytes(row.factors, sampler.factors) || !from_bytes(row.origins, sampler.origins)) {
    return "a column ends in the middle of a number";
  }
  sampler.joint_count = space.joint_count;
  experience.provenance = {std::string(row.tool), std::string(row.settings),
                           std::bit_cast<std::uint64_t>(row.seed), std::string(row.time)};
  return describe_flaw(experience, space);
}

}  // namespace mneme::internal
