// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"

#include <cctype>
#include <string>

namespace mneme {

TEST_SUITE("unit") {
  TEST_CASE("the version is three numbers joined by dots") {
    const std::string text(version());
    int dots = 0;
    for (const char c : text) {
      dots += c == '.' ? 1 : 0;
      CHECK((c == '.' || std::isdigit(static_cast<unsigned char>(c)) != 0));
    }
    CHECK(dots == 2);
    CHECK(test::read_file(test::source_file("CMakeLists.txt")).find("VERSION " + text) !=
          std::string::npos);
  }
}

}  // namespace mneme
