// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/page.h"

#include <doctest/doctest.h>

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("A page has its title twice, escaped, and the rules that it was given") {
    const std::string page = page_begin("a <b>", ".own { }") + page_end();
    CHECK(page.find("<title>a &lt;b&gt;</title>") != std::string::npos);
    CHECK(page.find("<h1>a &lt;b&gt;</h1>") != std::string::npos);
    CHECK(page.find(".own { }</style>") != std::string::npos);
    CHECK(page.find("@media (prefers-color-scheme: dark)") != std::string::npos);
    CHECK(page.ends_with("</body>\n</html>\n"));
  }
}

}  // namespace
}  // namespace mneme::internal
