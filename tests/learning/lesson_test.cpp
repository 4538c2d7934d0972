// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "learning/lesson.h"

#include "support/planar_memory.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("a lesson's seed depends on the job's seed and on every number of the key") {
    const PrimitiveKey key = near_pair();
    const std::uint64_t seed = internal::lesson_seed(1, key);
    CHECK(internal::lesson_seed(1, key) == seed);
    CHECK(internal::lesson_seed(2, key) != seed);
    for (std::size_t i = 0; i < key.size(); ++i) {
      PrimitiveKey other = key;
      other[i] += 1e-12;
      CHECK(internal::lesson_seed(1, other) != seed);
    }
  }

  TEST_CASE("a row says what it was learned from, and is counted") {
    const PrimitiveKey key = near_pair();
    LocalSampler sampler;
    sampler.joint_count = 2;
    sampler.means = {1, 2, 3, 4};
    const internal::Lesson lesson{&key, nullptr};
    const Experience row = internal::make_row(lesson, sampler, "settings", 5);
    CHECK(row.kind == "pairs/1");
    CHECK(row.key == key);
    CHECK(row.sampler.means == sampler.means);
    CHECK(row.provenance.settings == "settings");
    CHECK(row.provenance.seed == 5);
    CHECK(row.provenance.tool == "mneme " + std::string(version()));
    LearnSummary summary;
    internal::count(row, summary);
    internal::count(internal::make_row(lesson, {}, "settings", 6), summary);
    CHECK(summary.learned == 2);
    CHECK(summary.empty == 1);
    CHECK(summary.components == 2);
  }
}

}  // namespace mneme::test
