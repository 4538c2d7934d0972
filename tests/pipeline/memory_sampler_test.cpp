// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/learned_scene.h"
#include "pipeline/memory_sampler.h"
#include "support/kinds.h"

#include <algorithm>

namespace mneme::test {
namespace {

/// A query to a memory of its scene.
struct MemoryFixture : LearnedScene {
  SolveSettings settings;

  internal::Query query() {
    settings.plan.walk = 0;
    return require(internal::make_query(problem, &database, settings));
  }
};

/// Three components of the start's neighbourhood, as if memory had them.
Result<GaussianMixture> near_start(const internal::Query&, const MemoryQuery& asked,
                                   const internal::KindSettings&, GlSampler& gl) {
  gl.primitives.emplace_back();
  GaussianMixture mixture;
  mixture.joint_count = 8;
  for (int i = 0; i < 3; ++i) {
    mixture.means.insert(mixture.means.end(), asked.start->begin(), asked.start->end());
  }
  return mixture;
}

std::vector<SampleSource> draw_sources(SampleStream& stream, int count) {
  std::vector<float> q(8);
  std::vector<SampleSource> sources;
  for (int i = 0; i < count; ++i) sources.push_back(stream.next(q));
  return sources;
}

bool is_uniform(const std::vector<SampleSource>& sources) {
  return std::all_of(sources.begin(), sources.end(),
                     [](SampleSource source) { return source == kUniformSource; });
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("memory is queried at once where no iterations come before it") {
    MemoryFixture fixture;
    const internal::Query query = fixture.query();
    const internal::ResolvedQuery goals = require(internal::resolve_goals(query));
    internal::MemorySampler memory(goals, near_start);
    const auto sampler = memory.by_kind();
    CHECK(memory.check().has_value());
    CHECK(!is_uniform(draw_sources(*sampler->start(1), 50)));
    CHECK(memory.take().mixture->component_count() == 3);
  }

  TEST_CASE("memory is queried after the iterations that come before it, by one stream for all") {
    MemoryFixture fixture;
    fixture.settings.retrieve_after = 20;
    const internal::Query query = fixture.query();
    const internal::ResolvedQuery goals = require(internal::resolve_goals(query));
    internal::MemorySampler memory(goals, near_start);
    const auto sampler = memory.by_kind();
    const auto first = sampler->start(1), second = sampler->start(2);
    CHECK(is_uniform(draw_sources(*first, 20)));
    CHECK(!is_uniform(draw_sources(*first, 50)));
    CHECK(is_uniform(draw_sources(*second, 20)));
    CHECK(!is_uniform(draw_sources(*second, 50)));
    CHECK(memory.take().primitives.size() == 1);
  }

  TEST_CASE("memory that cannot be queried is a failure, and samples are uniform") {
    MemoryFixture fixture;
    const internal::Query query = fixture.query();
    const internal::ResolvedQuery goals = require(internal::resolve_goals(query));
    internal::MemorySampler memory(
        goals, [](const auto&, const auto&, const auto&, auto&) -> Result<GaussianMixture> {
          return fail(ErrorCode::io, "the disk is gone");
        });
    const auto sampler = memory.by_kind();
    REQUIRE(!memory.check().has_value());
    CHECK(memory.check().error().message == "the disk is gone");
    CHECK(is_uniform(draw_sources(*sampler->start(1), 50)));
  }

  TEST_CASE("a failure is none for a stream that has not drawn so far") {
    MemoryFixture fixture;
    fixture.settings.retrieve_after = 20;
    const internal::Query query = fixture.query();
    const internal::ResolvedQuery goals = require(internal::resolve_goals(query));
    internal::MemorySampler memory(
        goals, [](const auto&, const auto&, const auto&, auto&) -> Result<GaussianMixture> {
          return fail(ErrorCode::io, "the disk is gone");
        });
    const auto sampler = memory.by_kind();
    CHECK(is_uniform(draw_sources(*sampler->start(1), 50)));
    CHECK(!memory.check().has_value());
    CHECK(!memory.check(21).has_value());
    CHECK(memory.check(20).has_value());
  }

  TEST_CASE("memory with nothing to say leaves uniform samples") {
    MemoryFixture fixture;
    const internal::Query query = fixture.query();
    const internal::ResolvedQuery goals = require(internal::resolve_goals(query));
    internal::MemorySampler memory(goals, [](const auto&, const auto&, const auto&, auto&) {
      return GaussianMixture{8, {}, {}, {}, {}};
    });
    const auto sampler = memory.by_kind();
    CHECK(memory.check().has_value());
    CHECK(is_uniform(draw_sources(*sampler->start(1), 50)));
    CHECK(memory.take().mixture->component_count() == 0);
  }
}

TEST_SUITE("flow") {
  TEST_CASE("a database of several kinds is queried for each, when its time has come") {
    MemoryFixture fixture;
    const Path path = {fixture.problem.start, Configuration(8, 0.0), fixture.problem.goals[0]};
    REQUIRE(
        fixture.database.insert(learn_whole_paths(fixture.problem.robot, std::vector<Path>{path})));
    const internal::Query query = fixture.query();
    REQUIRE(query.kinds.size() == 2);
    std::vector<std::string_view> asked;
    const internal::ResolvedQuery goals = require(internal::resolve_goals(query));
    internal::MemorySampler memory(goals, [&](const auto& same, const auto& memory_query,
                                              const internal::KindSettings& kind, GlSampler& gl) {
      asked.push_back(kind.kind->name);
      return near_start(same, memory_query, kind, gl);
    });
    const auto stream = memory.by_kind()->start(1);
    CHECK(asked == std::vector<std::string_view>{"pairs"});
    draw_sources(*stream, kind_named("paths").defaults.share.retrieve_after + 1);
    CHECK(asked == std::vector<std::string_view>{"pairs", "paths"});
    const auto sources = draw_sources(*stream, 2000);
    const auto uniform = std::ranges::count(sources, kUniformSource);
    CHECK(uniform > 500);
    CHECK(uniform < 700);
    CHECK(memory.take().mixture->component_count() == 6);
  }

  TEST_CASE("a plan draws from all kinds that its database holds") {
    MemoryFixture fixture;
    const Path path = {fixture.problem.start, Configuration(8, 0.0), fixture.problem.goals[0]};
    REQUIRE(
        fixture.database.insert(learn_whole_paths(fixture.problem.robot, std::vector<Path>{path})));
    fixture.settings.retrieve_after = 0;
    const SolveResult result = require_solved(fixture.problem, &fixture.database, fixture.settings);
    REQUIRE(result.gl.primitives.size() == 2);
    CHECK(result.gl.primitives[0].primitive.kind == "pairs/1");
    CHECK(result.gl.primitives[1].primitive.kind == "paths/1");
    fixture.settings.memory.kind = "paths";
    const auto paths = require(solve(fixture.problem, &fixture.database, fixture.settings));
    REQUIRE(paths.gl.primitives.size() == 1);
    CHECK(paths.gl.primitives[0].primitive.kind == "paths/1");
  }
}

}  // namespace mneme::test
