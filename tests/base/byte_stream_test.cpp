// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/byte_stream.h"

#include <doctest/doctest.h>

#include <limits>

namespace mneme::test {

using internal::ByteReader;
using internal::ByteWriter;

TEST_SUITE("unit") {
  TEST_CASE("values read back as they were written, and small ones are short") {
    constexpr double kStep = 1.0 / 8192;
    const std::vector<std::uint64_t> numbers = {0, 127, 128, 300, ~std::uint64_t{0}};
    const std::vector<float> values = {0, 0.5f, -0.5f, 7, -1234.125f};
    ByteWriter writer("");
    writer.number(5);
    CHECK(writer.bytes().size() == 1);
    writer.list(numbers, [](auto& file, const auto& number) { file.number(number); });
    for (const float value : values) writer.multiple(value, kStep, 0.25f);
    writer.field(0.1);
    writer.field("text");

    ByteReader reader(writer.bytes());
    int five = 0;
    reader.number(five);
    CHECK(five == 5);
    std::vector<std::uint64_t> numbers_again;
    reader.list(numbers_again, [](auto& file, auto& number) { file.number(number); });
    CHECK(numbers_again == numbers);
    for (const float value : values) {
      float again = 0;
      reader.multiple(again, kStep, 0.25f);
      CHECK(again == value);
    }
    double tenth = 0;
    std::string text;
    reader.field(tenth);
    reader.field(text);
    CHECK(tenth == 0.1);
    CHECK(text == "text");
    CHECK(reader.is_complete());
  }

  TEST_CASE("items are no more than the rest of a stream may hold") {
    constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
    const std::string bytes(12, '\0');
    CHECK(ByteReader(bytes).bounded(4, 3) == 4);
    for (const std::size_t count : {std::size_t{5}, kMost / 3 + 2, kMost}) {
      ByteReader reader(bytes);
      CHECK(reader.bounded(count, 3) == 0);
      CHECK_FALSE(reader.is_complete());
    }
  }

  TEST_CASE("a short stream ends in zeros and lists no more than it may hold") {
    ByteWriter writer("");
    writer.number(std::numeric_limits<std::uint32_t>::max());
    ByteReader reader(writer.bytes());
    std::vector<int> items = {1};
    reader.list(items, [](auto& file, auto& item) { file.number(item); });
    CHECK(items.empty());
    CHECK_FALSE(reader.is_complete());
    double value = 1;
    reader.field(value);
    CHECK(value == 0);
    float far = 1;
    ByteReader beyond(std::string_view("\xff\xff\xff\xff\xff\xff\xff\xff\x7f", 9));
    beyond.multiple(far, 1);
    CHECK(far == 0);
    CHECK_FALSE(beyond.is_complete());
    const std::string endless(11, '\x80');
    ByteReader wide(std::string_view("\x80\x80\x04", 3));  // 65536
    std::uint16_t narrow = 1;
    wide.number(narrow);
    CHECK(narrow == 0);
    CHECK_FALSE(wide.is_complete());
    ByteReader other(endless);
    int number = 1;
    other.number(number);
    CHECK(number == 0);
    CHECK_FALSE(other.is_complete());
  }
}

}  // namespace mneme::test
