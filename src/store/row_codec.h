// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Rows as bytes and their checksums: little-endian numbers without padding.
#pragma once

#include "mneme/store.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// XXH3 (128 bits) of a row's kind, key and content. Rows with equal hashes are the same
/// experience, whatever their provenance.
using ContentHash = std::array<std::byte, 16>;

/// The hash in a stored column, which ends in zeros if the column is too short.
[[nodiscard]] inline ContentHash to_content_hash(std::span<const std::byte> bytes) {
  ContentHash hash{};
  std::copy_n(bytes.begin(), std::min(bytes.size(), hash.size()), hash.begin());
  return hash;
}

inline void swap_to_little_endian([[maybe_unused]] std::span<std::byte> bytes,
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

/// Returns false if the bytes are not a whole number of elements.
template <class Number>
bool from_bytes(std::span<const std::byte> bytes, std::vector<Number>& numbers) {
  if (bytes.size() % sizeof(Number) != 0) return false;
  numbers.resize(bytes.size() / sizeof(Number));
  if (!bytes.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  swap_to_little_endian(std::as_writable_bytes(std::span(numbers)), sizeof(Number));
  return true;
}

/// The columns of a row, as views into a statement or an EncodedRow.
struct RowView {
  std::string_view kind;
  std::span<const std::byte> key;  ///< float64 each
  std::int64_t constraints = 0;    ///< the bits of the unsigned number
  bool is_path = false;
  std::span<const std::byte> means;             ///< means of a sampler, or waypoints of a path:
                                                ///< float32 each
  std::span<const std::byte> factor_rows;       ///< int32 each
  std::span<const std::byte> factors;           ///< of a sampler, or a path's clearances and near
                                                ///< misses: float32 each
  std::span<const std::byte> sources;           ///< int32 each
  bool is_complete = true;                      ///< of a sampler
  std::optional<std::int64_t> planning_states;  ///< the bits of the unsigned number
  std::string_view tool;
  std::string_view settings;
  std::int64_t seed = 0;  ///< the bits of the unsigned number
  std::string_view time;
};

/// A stored row, sound or damaged: one record of the table `experience` and, unless only keys are
/// read, one of `mixture`.
struct StoredRow {
  std::int64_t id = 0;
  std::int64_t generation = 0;  ///< generation of the transaction that added the row
  std::int64_t cell = 0;        ///< cell_of() its key
  std::span<const std::byte> content;
  std::int64_t components = 0;
  RowView columns;
  std::int64_t key_checksum = 0;      ///< checksum of the record in `experience`
  std::int64_t mixture_checksum = 0;  ///< checksum of the record in `mixture`
  std::string flaw;                   ///< damage that the store found while reading it; usually
                                      ///< empty
};

/// State of a store: counters and digests of its rows, the single row of the table `head`. A reader
/// that knows an older state continues from it.
struct StoreState {
  std::int64_t generation = 0;  ///< number of transactions that changed something
  std::int64_t epoch = 0;       ///< changes whenever rows may have vanished
  std::int64_t last_row = 0;    ///< largest id assigned so far
  std::int64_t last_tombstone = 0;
  std::int64_t row_count = 0;   ///< including dead rows
  std::int64_t row_digest = 0;  ///< exclusive or of tally_mark(id, key checksum)
  std::int64_t tombstone_count = 0;
  std::int64_t tombstone_digest = 0;

  bool operator==(const StoreState&) const = default;
};
/// The columns of `head` in their order.
inline constexpr int kHeadSize = 8;
[[nodiscard]] std::array<std::int64_t, kHeadSize> to_numbers(const StoreState& state);
[[nodiscard]] StoreState to_state(std::span<const std::int64_t, kHeadSize> numbers);

/// The epoch after that of `old_head`; if `old_head` is null, an epoch that was never used.
[[nodiscard]] std::int64_t next_epoch(const StoreState* old_head);

/// Marks a row as dead: it stays stored but is not used.
struct Tombstone {
  std::int64_t id = 0;
  std::int64_t row = 0;
  std::int64_t generation = 0;
  std::string reason;
  std::string time;
  std::int64_t checksum = 0;
};
[[nodiscard]] std::int64_t checksum_of(const Tombstone& tombstone);
/// The checksum of the row that names a store's robot.
[[nodiscard]] std::int64_t checksum_of(const RobotSignature& signature);

/// The bytes of an experience. The experience must outlive this object, which refers to its texts.
class EncodedRow {
 public:
  explicit EncodedRow(const Experience& experience);
  [[nodiscard]] const RowView& view() const { return stored_.columns; }
  [[nodiscard]] const ContentHash& content() const { return *content_; }
  /// The row as it is stored under `id`. Valid as long as this object.
  [[nodiscard]] StoredRow stored(std::int64_t id, std::int64_t generation) const;

 private:
  std::array<std::vector<std::byte>, 5> blobs_;
  // On the heap because `stored_` points to it when the row moves.
  std::unique_ptr<const ContentHash> content_;
  StoredRow stored_;
};

/// Edge of the cells that keys are sorted into, metres.
inline constexpr double kCellEdge = 1.0;
/// Hash of the grid cell that a key lies in, by which a cluster may distribute rows: XXH3 of its
/// numbers divided by kCellEdge, rounded down, as int64.
[[nodiscard]] std::int64_t cell_of(const std::vector<double>& key);

/// XXH3 of some bytes, as a signed integer.
[[nodiscard]] std::int64_t hash_bytes(std::span<const std::byte> bytes);
/// XXH3 of some numbers in little-endian order.
[[nodiscard]] std::int64_t hash_numbers(std::span<const std::int64_t> numbers);
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
  [[nodiscard]] std::int64_t value() const { return hash_numbers(numbers_); }

 private:
  static constexpr std::size_t kMostNumbers = 24;
  std::vector<std::int64_t> numbers_;
};

[[nodiscard]] ContentHash content_hash(const RowView& row);
/// Lower-case hexadecimal digits.
[[nodiscard]] std::string to_hex(std::span<const std::byte> bytes);

/// XXH3 over all columns of a record in `experience` and in `mixture`.
[[nodiscard]] std::int64_t key_checksum(const StoredRow& row);
[[nodiscard]] std::int64_t mixture_checksum(const StoredRow& row);
/// Contribution of a row or tombstone to a digest of the store, which is the exclusive or of all
/// contributions.
[[nodiscard]] std::int64_t tally_mark(std::int64_t id, std::int64_t checksum);

/// Fills `experience`. Returns the row's damage in words, or nothing. Does not check the key's
/// length.
[[nodiscard]] std::optional<std::string> decode(const StoredRow& row,
                                                const RobotSignature& signature,
                                                Experience& experience);
/// Fills id, kind and key of `experience` from a row that was read without its mixture.
[[nodiscard]] std::optional<std::string> decode_key(const StoredRow& row, Experience& experience);

}  // namespace mneme::internal
