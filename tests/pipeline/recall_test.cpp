// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/recall.h"

#include "pipeline/complete_settings.h"
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

struct RecallFixture {
  Problem problem = planar_problem("threaded_b4");
  TemporaryDirectory directory;
  Database database = make_database(directory / "m.db", problem.robot);
  CollisionChecker checker = make_checker(problem.robot, problem.scene);
  SolveSettings settings = internal::complete_settings({}, problem.robot);

  RecallFixture() {
    const auto primitives = decompose(problem.robot, problem.scene, {});
    REQUIRE(primitives.has_value());
    std::vector<PrimitiveKey> keys;
    for (const LocalPrimitive& primitive : *primitives) keys.push_back(primitive.key);
    learn_into(database, problem.robot, keys);
  }
  internal::Recall make() { return internal::Recall(problem, database, checker, settings); }
};

/// Origins of the first `count` samples.
std::vector<Origin> draw_origins(SampleStream& stream, int count) {
  std::vector<float> q(8);
  std::vector<Origin> origins;
  for (int i = 0; i < count; ++i) origins.push_back(stream.next(q));
  return origins;
}

bool is_uniform(const std::vector<Origin>& origins) {
  return std::all_of(origins.begin(), origins.end(),
                     [](Origin origin) { return origin == kUniformOrigin; });
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("memory is asked at once where no iterations come before it") {
    RecallFixture fixture;
    internal::Recall recall = fixture.make();
    const auto sampler = recall.make_sampler();
    CHECK(!recall.failure());
    CHECK(!is_uniform(draw_origins(*sampler->start(1), 50)));
    CHECK(recall.take().mixture->component_count() > 0);
  }

  TEST_CASE("memory is asked after the iterations that come before it, by one stream for all") {
    RecallFixture fixture;
    fixture.settings.retrieve_after = 20;
    internal::Recall recall = fixture.make();
    const auto sampler = recall.make_sampler();
    const auto first = sampler->start(1), second = sampler->start(2);
    CHECK(is_uniform(draw_origins(*first, 20)));
    CHECK(!is_uniform(draw_origins(*first, 50)));
    CHECK(is_uniform(draw_origins(*second, 20)));
    CHECK(!is_uniform(draw_origins(*second, 50)));
    CHECK(recall.take().primitives.size() == 1);
  }

  TEST_CASE("memory that cannot be asked is a failure, and samples are uniform") {
    RecallFixture fixture;
    fixture.settings.decompose.decomposer = "unknown";
    internal::Recall recall = fixture.make();
    const auto sampler = recall.make_sampler();
    CHECK(recall.failure().has_value());
    CHECK(is_uniform(draw_origins(*sampler->start(1), 50)));
  }
}

}  // namespace mneme::test
