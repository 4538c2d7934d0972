// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/kind_accounts.h"
#include "support/support.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("a kind is trusted on credit, then as far as it pays, and again once it pays") {
    internal::KindAccounts accounts;
    CHECK(accounts.trust("motions/1") == 1);
    accounts.book("motions/1", 50'000, 0);
    CHECK(accounts.trust("motions/1") == doctest::Approx(0.5));
    CHECK(accounts.trust("paths/1") == 1);
    for (int i = 0; i < 1000; ++i) accounts.book("motions/1", 50'000, 0);
    const double least = accounts.trust("motions/1");
    CHECK(least >= 0.04);
    CHECK(least <= 0.06);
    for (int i = 0; i < 20; ++i) accounts.book("motions/1", 5'000, 200'000);
    CHECK(accounts.trust("motions/1") == 1);
    accounts.book("motions/1", 100'000, 0);
    CHECK(accounts.trust("motions/1") == 1);
  }
}

}  // namespace mneme::test
