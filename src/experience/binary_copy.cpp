// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/binary_copy.h"

namespace mneme::internal {

BinaryCopy::BinaryCopy() : data_("PGCOPY\n\377\r\n\0", 11) {
  append_big_endian(0, 4);  // flags
  append_big_endian(0, 4);  // bytes of the header's extension
}

BinaryCopy& BinaryCopy::row(int column_count) {
  append_big_endian(static_cast<std::uint64_t>(column_count), 2);
  return *this;
}

BinaryCopy& BinaryCopy::add(std::int64_t value) {
  append_big_endian(8, 4);
  append_big_endian(static_cast<std::uint64_t>(value), 8);
  return *this;
}

BinaryCopy& BinaryCopy::add(std::string_view text) {
  append_big_endian(text.size(), 4);
  data_ += text;
  return *this;
}

BinaryCopy& BinaryCopy::add(std::span<const std::byte> bytes) {
  return add(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

const std::string& BinaryCopy::finish() {
  append_big_endian(0xffff, 2);
  return data_;
}

void BinaryCopy::append_big_endian(std::uint64_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
    data_ += static_cast<char>((value >> shift) & 0xff);
  }
}

}  // namespace mneme::internal
