// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/merge_rows.h"

#include "experience/fixtures.h"
#include "experience/open_store.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("merged rows are counted as read, added and replaced") {
    const TemporaryDirectory directory;
    Rng rng(19);
    auto rows = random_rows(rng, 3);
    const auto target = internal::open_store_of(directory / "a.db", arm_space(), OpenMode::create);
    MergeSummary summary;
    REQUIRE(internal::merge_rows(*target->store, std::span(rows).first(2), summary));
    rows[0].provenance.time = "1999";
    REQUIRE(internal::merge_rows(*target->store, rows, summary));
    CHECK(summary.read == 5);
    CHECK(summary.added == 3);
    CHECK(summary.replaced == 1);
  }
}

}  // namespace mneme::test
