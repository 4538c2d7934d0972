// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/text_table.h"

#include <doctest/doctest.h>

namespace mneme {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("Names are aligned left and numbers right, by characters") {
    CHECK(internal::text_table({{"name", "ms"}, {"\xC3\xA4", "1000"}}, 1) ==
          "name    ms\n\xC3\xA4     1000\n");
    CHECK(internal::text_table({}, 1).empty());
  }
}

}  // namespace
}  // namespace mneme
