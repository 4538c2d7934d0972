// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/memory_steps.h"
#include "support/planar_memory.h"

namespace mneme::test {
namespace {

/// Means of planar8 that point straight in these directions.
GaussianMixture pointing(const std::vector<float>& directions) {
  GaussianMixture mixture;
  mixture.joint_count = 8;
  for (const float direction : directions) {
    mixture.means.push_back(direction);
    mixture.means.insert(mixture.means.end(), 7, 0.0f);
  }
  return mixture;
}

/// A way to learn that says it took all of its budget, or no time: one component, by `seed`.
template <bool is_cut_short>
Result<LearnResult> learn_at_once(const Robot& robot, const PrimitiveKey&, const LearnSettings&,
                                  std::uint64_t seed, double, const std::atomic<bool>*) {
  LearnResult result;
  result.sampler.joint_count = robot.joint_count();
  result.sampler.means.assign(8, 1e-20f * static_cast<float>(seed));
  result.time_s = is_cut_short ? 60 : 0;
  return result;
}

/// Queries one after the other about the same pair, each with a budget.
struct BudgetedQueries {
  Robot robot = planar8();
  TemporaryDirectory directory;
  Database database = make_database(directory / "m.db", robot);
  Scene scene = make_scene(near_pair());

  PrimitiveRetrieval ask(bool is_cut_short) {
    SolveSettings settings;
    settings.learn_budget_s = 60;
    const Problem problem{.robot = robot, .scene = scene};
    const auto query = require(internal::make_query(problem, &database, settings));
    const MemoryQuery asked = memory_query(problem);
    internal::KindSettings kind_settings = query.kinds.front();
    MemoryKind kind = *kind_settings.kind;
    kind.learn = is_cut_short ? learn_at_once<true> : learn_at_once<false>;
    kind_settings.kind = &kind;
    auto found = require(internal::decompose(asked, kind_settings));
    double learning_time_s = 0;
    require(internal::retrieve(database, kind_settings, found.front()));
    require(internal::learn(query, asked, kind_settings, found.front(), learning_time_s));
    return found.front();
  }
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("what a budget cut short is learned on by the next queries, until a lesson is whole") {
    BudgetedQueries asked;
    for (std::int64_t rows = 1; rows <= 3; ++rows) {
      const PrimitiveRetrieval found = asked.ask(true);
      CHECK(found.is_learned);
      CHECK(std::ssize(found.matches) == rows);
      CHECK(asked.database.size() == rows);
    }
    CHECK(asked.ask(false).is_learned);
    CHECK(asked.database.size() == 4);
    CHECK(!asked.ask(true).is_learned);
    CHECK(!asked.ask(false).is_learned);
    CHECK(asked.database.size() == 4);
  }

  TEST_CASE("lessons that are always cut short end with as many as are drawn from") {
    BudgetedQueries asked;
    for (int i = 0; i < 12; ++i) CHECK(asked.ask(true).is_learned == (i < 8));
    CHECK(asked.database.size() == 8);
  }

  TEST_CASE("components whose means are in contact go, with all that belongs to them") {
    const CollisionChecker checker = make_checker(planar8(), make_circle_scene("", {{5, 0, 1}}));
    GaussianMixture mixture = pointing({0, 1, 0.1f, -2, 3});
    mixture.sources = {0, 1, 2, 3, 4};
    mixture.factor_rows = {1, 0, -1, -1, 1};
    mixture.factors.assign(2 * 36, 0.5f);
    const GaussianMixture kept = internal::keep_valid_components(checker, mixture);
    CHECK(kept.means == pointing({1, -2, 3}).means);
    CHECK(kept.sources == std::vector<SampleSource>{1, 3, 4});
    CHECK(kept.factor_rows == std::vector<int>{0, -1, 1});
    CHECK(kept.factors == mixture.factors);
    CHECK(kept.joint_count == 8);
  }

  TEST_CASE("what a mixture leaves out stays left out") {
    const CollisionChecker checker = make_checker(planar8(), make_circle_scene("", {{5, 0, 1}}));
    const GaussianMixture kept = internal::keep_valid_components(checker, pointing({0, 2}));
    CHECK(kept.means == pointing({2}).means);
    CHECK(kept.sources.empty());
    CHECK(kept.factor_rows.empty());
  }

  TEST_CASE("if all means are in contact, all stay") {
    const CollisionChecker checker = make_checker(planar8(), make_circle_scene("", {{5, 0, 1}}));
    const GaussianMixture mixture = pointing({0, 0.05f});
    CHECK(internal::keep_valid_components(checker, mixture).means == mixture.means);
  }

  TEST_CASE("an empty mixture stays one") {
    const CollisionChecker checker = make_checker(planar8(), {});
    const GaussianMixture kept = internal::keep_valid_components(checker, pointing({}));
    CHECK(kept.component_count() == 0);
    CHECK(kept.joint_count == 8);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("mixtures are joined one after the other, each with its own factors") {
    GaussianMixture all = pointing({1, 2});
    GaussianMixture more = pointing({3, 4});
    more.factor_rows = {-1, 0};
    more.factors.assign(36, 0.5f);
    more.sources = {5, 6};
    internal::append(all, more);
    internal::append(all, more);
    CHECK(all.means == pointing({1, 2, 3, 4, 3, 4}).means);
    CHECK(all.factor_rows == std::vector<int>{-1, -1, -1, 0, -1, 1});
    CHECK(all.factors.size() == 72);
    CHECK(all.sources == std::vector<SampleSource>{0, 0, 5, 6, 5, 6});
    GaussianMixture none;
    internal::append(none, more);
    CHECK(none.means == more.means);
    CHECK(none.sources == more.sources);
  }
}

TEST_SUITE("law") {
  TEST_CASE("exactly the valid means of many are kept, in order") {
    const Robot robot = planar8();
    const CollisionChecker checker =
        make_checker(robot, make_circle_scene("", {{2, 2, 1}, {-3, 1, 1.5}}));
    Rng rng(1);
    for (int count = 1; count <= 60; ++count) {
      GaussianMixture mixture;
      mixture.joint_count = 8;
      std::vector<float> expected;
      for (int i = 0; i < count; ++i) {
        const Configuration q = random_configuration(robot, rng);
        const std::vector<float> row(q.begin(), q.end());
        mixture.means.insert(mixture.means.end(), row.begin(), row.end());
        if (!checker.is_valid(std::span<const float>(row))) continue;
        expected.insert(expected.end(), row.begin(), row.end());
      }
      if (expected.empty()) expected = mixture.means;
      CHECK(internal::keep_valid_components(checker, mixture).means == expected);
    }
  }
}

}  // namespace mneme::test
