// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A row of the table `experience` as bytes: little-endian numbers without padding.
#pragma once

#include "mneme/experience.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The columns of a row but for its id and its checksum; views into a statement or an EncodedRow.
struct RowView {
  std::span<const std::byte> key;          ///< float64 each
  std::span<const std::byte> means;        ///< float32 each
  std::span<const std::byte> factor_rows;  ///< int32 each
  std::span<const std::byte> factors;      ///< float32 each
  std::span<const std::byte> origins;      ///< int32 each
  std::string_view tool;
  std::string_view settings;
  std::int64_t seed = 0;  ///< the bits of the unsigned number
  std::string_view time;
};

/// The bytes of an experience. Refers to its provenance, which must outlive it.
class EncodedRow {
 public:
  explicit EncodedRow(const Experience& experience);
  [[nodiscard]] const RowView& view() const { return view_; }

 private:
  std::array<std::vector<std::byte>, 5> blobs_;
  RowView view_;
};

/// XXH3 of some bytes, as SQLite's signed integer.
[[nodiscard]] std::int64_t hash_bytes(std::span<const std::byte> bytes);
/// XXH3 over the content of a row; its id is not part of it, so that a row keeps it in another
/// database.
[[nodiscard]] std::int64_t checksum_of(const RowView& row);
/// What a row adds, by exclusive or, to the digest in the table `tally`.
[[nodiscard]] std::int64_t tally_mark(std::int64_t id, std::int64_t checksum);

/// Fills `experience` but for its id. Returns what is wrong with the row, if anything is.
[[nodiscard]] std::optional<std::string> decode(const RowView& row, std::int64_t checksum,
                                                const ExperienceSpace& space,
                                                Experience& experience);

}  // namespace mneme::internal
