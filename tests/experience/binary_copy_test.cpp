// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/binary_copy.h"

#include "support/support.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("rows stand between a header and an end mark, numbers in big-endian order") {
    internal::BinaryCopy copy;
    const std::byte blob[] = {std::byte{7}};
    copy.row(3).add(std::int64_t{-2}).add(std::string_view("ab")).add(std::span(blob));
    const std::string expected =
        std::string("PGCOPY\n\377\r\n\0\0\0\0\0\0\0\0\0", 19) + std::string("\0\3", 2) +
        std::string("\0\0\0\10\377\377\377\377\377\377\377\376", 12) +
        std::string("\0\0\0\2ab", 6) + std::string("\0\0\0\1\7", 5) + "\377\377";
    CHECK(copy.finish() == expected);
  }
}

}  // namespace mneme::test
