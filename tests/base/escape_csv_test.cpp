// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.h"
#include "support/support.h"

namespace mneme::test {
namespace {

using internal::escape_csv;

TEST_SUITE("unit") {
  TEST_CASE("CSV fields are quoted only where they must be") {
    CHECK(escape_csv("plain name") == "plain name");
    CHECK(escape_csv("a,b") == "\"a,b\"");
    CHECK(escape_csv("say \"hi\"") == "\"say \"\"hi\"\"\"");
    CHECK(escape_csv("two\nlines") == "\"two\nlines\"");
    CHECK(escape_csv("") == "");
  }
}

}  // namespace
}  // namespace mneme::test
