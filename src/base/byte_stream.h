// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Short binary files. Integers have 7 bits a byte, the lowest first, as long as the top bit is
/// set. ByteWriter and ByteReader have the same members, so that one function does both.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

static_assert(std::endian::native == std::endian::little);

namespace mneme::internal {

/// Multiples of a step that are written are less than this: floats hold them as integers.
inline constexpr double kMostMultiple = 1e15;

/// The number of steps in a value that is a multiple of `step`.
[[nodiscard]] inline std::int64_t multiples(float value, double step) {
  return static_cast<std::int64_t>(value / step);
}

/// Appends values.
class ByteWriter {
 public:
  explicit ByteWriter(std::string_view head) : bytes_(head) {}

  void field(double value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void field(const std::string& text) {
    number(text.size());
    bytes_.append(text);
  }
  template <class Integer>
  void number(const Integer& value) {
    auto rest = static_cast<std::uint64_t>(value);
    for (; rest >= 128; rest >>= 7) bytes_.push_back(static_cast<char>(rest | 128));
    bytes_.push_back(static_cast<char>(rest));
  }
  /// Writes a multiple of `step` as the difference from `base`, another multiple.
  void multiple(const float& value, double step, float base = 0) {
    const std::int64_t difference = multiples(value, step) - multiples(base, step);
    const auto doubled = static_cast<std::uint64_t>(difference) << 1;
    number(difference < 0 ? ~doubled : doubled);
  }
  template <class T, class Each>
  void list(const std::vector<T>& items, const Each& each) {
    number(items.size());
    for (const T& item : items) each(*this, item);
  }
  [[nodiscard]] static std::size_t bounded(std::size_t count, std::size_t) { return count; }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads values. After a read beyond the end all values are 0.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  void field(double& value) { read(&value, sizeof value); }
  void field(std::string& text) {
    text.resize(count());
    read(text.data(), text.size());
  }
  template <class Integer>
  void number(Integer& value) {
    const std::uint64_t wide = next();
    value = static_cast<Integer>(wide);
    if (static_cast<std::uint64_t>(value) == wide) return;
    fail();  // no such value was written
    value = Integer{};
  }
  void multiple(float& value, double step, float base = 0) {
    const std::uint64_t doubled = next();
    const auto half = static_cast<std::int64_t>(doubled >> 1);
    const std::int64_t difference = (doubled & 1) != 0 ? ~half : half;
    const double sum = base / step + static_cast<double>(difference);
    value = static_cast<float>(sum * step);
    if (std::abs(sum) < kMostMultiple) return;
    fail();
    value = 0;
  }
  template <class T, class Each>
  void list(std::vector<T>& items, const Each& each) {
    items.clear();
    for (std::size_t left = count(); left > 0 && is_good_; --left) {
      each(*this, items.emplace_back());
    }
  }
  /// A number of items, or 0 if the file is too short for `least` > 0 bytes each.
  [[nodiscard]] std::size_t bounded(std::size_t count, std::size_t least) {
    if (count > bytes_.size() / least) fail();
    return is_good_ ? count : 0;
  }
  [[nodiscard]] bool is_complete() const { return is_good_ && bytes_.empty(); }

 private:
  /// Makes all further values 0.
  void fail() {
    is_good_ = false;
    bytes_ = {};
  }
  std::uint64_t next() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64 && !bytes_.empty(); shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes_.front());
      bytes_.remove_prefix(1);
      value |= static_cast<std::uint64_t>(byte & 127) << shift;
      if (byte < 128) return value;
    }
    fail();
    return 0;
  }
  std::size_t count() { return bounded(static_cast<std::size_t>(next()), 1); }
  void read(void* to, std::size_t size) {
    if (size > bytes_.size()) {
      fail();
      std::memset(to, 0, size);
      return;
    }
    std::memcpy(to, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }

  std::string_view bytes_;
  bool is_good_ = true;
};

}  // namespace mneme::internal
