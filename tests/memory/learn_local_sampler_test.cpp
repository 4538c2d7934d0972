// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/kinds.h"
#include "support/lifting_arm.h"
#include "support/planar_memory.h"
#include "support/threaded.h"

#include <atomic>
#include <limits>

namespace mneme::test {
namespace {

/// Means within the limits and free as they are stored.
void check_means(const CollisionChecker& checker, const LocalSampler& sampler) {
  for (int i = 0; i < sampler.component_count(); ++i) {
    const Configuration q = mean_of(sampler, i);
    const std::vector<float> row(q.begin(), q.end());
    CHECK(checker.is_valid(std::span<const float>(row)));
    CHECK(!checker.robot().describe_violation(q, "mean").has_value());
  }
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("means are within the limits and free in the scene of the primitive") {
    const Robot robot = planar8();
    const auto keys = random_keys(40, 11);
    int with_components = 0, threaded = 0, means = 0;
    for (const PrimitiveKey& key : keys) {
      const CollisionChecker checker = make_checker(robot, make_scene(key));
      const LearnResult learned = learn(robot, key, cheap_settings(), 3);
      const LocalSampler& sampler = learned.sampler;
      CHECK(learned.solved <= learned.queries);
      CHECK(learned.time_s > 0);
      CHECK(sampler.joint_count == 8);
      CHECK((sampler.component_count() > 0) == (learned.solved > 0));
      check_means(checker, sampler);
      with_components += sampler.component_count() > 0;
      bool is_threaded = false;
      for (int i = 0; i < sampler.component_count(); ++i, ++means) {
        is_threaded = is_threaded || first_crossing_link(robot, key, mean_of(sampler, i)) >= 0;
      }
      threaded += is_threaded;
    }
    CHECK(with_components > 30);
    CHECK(threaded == with_components);
    CHECK(means > 200);
  }

  TEST_CASE("means of merged groups are within the limits and free too") {
    const Robot robot = planar8();
    LearnSettings merging = cheap_settings();
    merging.starts_per_link = 4;
    merging.merge_cliques = true;
    for (const PrimitiveKey& key : random_keys(12, 11)) {
      check_means(make_checker(robot, make_scene(key)), learn(robot, key, merging, 3).sampler);
    }
  }

  TEST_CASE("an arm of narrow joints learns as well, within its limits") {
    const Robot robot = limited_arm(planar8_lengths(), -1.5, 1.5);
    int with_components = 0;
    for (const PrimitiveKey& key : random_keys(30, 1)) {
      const LocalSampler sampler = learn(robot, key, cheap_settings(), 1).sampler;
      with_components += sampler.component_count() > 0;
      for (int i = 0; i < sampler.component_count(); ++i) {
        CHECK(!robot.describe_violation(mean_of(sampler, i), "mean").has_value());
      }
    }
    CHECK(with_components > 20);
  }

  TEST_CASE("learning depends on its arguments alone") {
    const Robot robot = planar8();
    for (const PrimitiveKey& key : random_keys(5, 12)) {
      const LearnResult first = learn(robot, key, cheap_settings(), 3);
      const LearnResult second = learn(robot, key, cheap_settings(), 3);
      CHECK(is_same_mixture(first.sampler, second.sampler));
      CHECK(first.queries == second.queries);
      CHECK(first.solved == second.solved);
      CHECK(first.iterations == second.iterations);
      CHECK(!is_same_mixture(first.sampler, learn(robot, key, cheap_settings(), 4).sampler));
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("learning ends at its deadline with what it has") {
    const Robot robot = planar8();
    LearnSettings long_winded;
    long_winded.starts_per_link = 1000;
    long_winded.paths_per_start = 1000;
    for (const double deadline : {1e-6, 0.02, 0.5}) {
      long_winded.merge_cliques = !long_winded.merge_cliques;
      const LearnResult learned = learn(robot, random_keys(1, 13)[0], long_winded, 1, deadline);
      // Without a deadline it would be minutes; the slack is for busy machines.
      CHECK(learned.time_s < deadline + 5);
      CHECK(learned.time_s >= deadline);
      if (deadline > 0.1) CHECK(learned.sampler.component_count() > 0);
    }
  }

  TEST_CASE("a key that is no pair of circles is refused") {
    PrimitiveKey not_finite = near_pair();
    not_finite[4] = std::numeric_limits<double>::quiet_NaN();
    for (const PrimitiveKey& key : {PrimitiveKey(18, 0.5), PrimitiveKey{}, not_finite}) {
      const Error error = require_error(learn_local_sampler(planar8(), key, cheap_settings(), 1));
      CHECK(error.code == ErrorCode::invalid);
      CHECK_MESSAGE(contains(error.message, "pair of circles"), error.message);
    }
  }

  TEST_CASE("learning ends with what it has once it is cancelled") {
    LearnSettings endless;
    endless.starts_per_link = 1000;
    endless.paths_per_start = 1000;
    endless.max_iterations = 100000000;
    const std::atomic<bool> is_cancelled = true;
    const auto learned =
        learn_local_sampler(planar8(), random_keys(1, 13)[0], endless, 1, 0, &is_cancelled);
    REQUIRE(learned.has_value());
    CHECK(learned->queries == 0);
    CHECK(learned->sampler.component_count() == 0);
  }

  TEST_CASE("more starts and paths make more components") {
    const Robot robot = planar8();
    const PrimitiveKey key = random_keys(1, 14)[0];
    LearnSettings rich = cheap_settings();
    rich.starts_per_link = 4;
    const int few = learn(robot, key, cheap_settings(), 1).sampler.component_count();
    const LearnResult many = learn(robot, key, rich, 1);
    CHECK(few > 0);
    CHECK(many.sampler.component_count() > 2 * few);
    rich.paths_per_start = 3;
    CHECK(learn(robot, key, rich, 1).queries > many.queries);
  }

  TEST_CASE("without anchors and walks local queries need more iterations") {
    LearnSettings plain = cheap_settings();
    plain.walks = false;
    std::uint64_t with = 0, without = 0;
    for (const PrimitiveKey& key : random_keys(4, 17)) {
      with += learn(planar8(), key, cheap_settings(), 1).iterations;
      const LearnResult learned = learn(planar8(), key, plain, 1);
      without += learned.iterations;
      CHECK(learned.solved > 0);
    }
    CHECK(without > 2 * with);
  }

  TEST_CASE("a gap that no link can cross leaves an empty sampler") {
    const LearnResult learned =
        learn(planar_arm({1, 1}), {9, 1.5, 1, 9, -1.5, 1}, cheap_settings(), 1);
    CHECK(learned.sampler.component_count() == 0);
    CHECK(learned.queries == 0);
    CHECK(learned.solved == 0);
  }

  TEST_CASE("queries that reach their iteration limit are given up") {
    LearnSettings hasty = cheap_settings();
    hasty.max_iterations = 1;
    hasty.range = 0.01;
    const LearnResult learned = learn(planar8(), random_keys(1, 15)[0], hasty, 1);
    CHECK(learned.queries > 0);
    CHECK(learned.iterations <= static_cast<std::uint64_t>(learned.queries));
    CHECK(learned.solved < learned.queries);
  }

  TEST_CASE("merging makes fewer components") {
    const Robot robot = planar8();
    const PrimitiveKey key = random_keys(1, 16)[0];
    LearnSettings merging = cheap_settings();
    merging.starts_per_link = 3;
    const int unmerged = learn(robot, key, merging, 1).sampler.component_count();
    merging.merge_cliques = true;
    const int merged = learn(robot, key, merging, 1).sampler.component_count();
    CHECK(merged > 0);
    CHECK(merged < unmerged);
  }

  TEST_CASE("a robot that is no planar arm is refused by name") {
    const Error error =
        require_error(learn_local_sampler(upright_arm(), random_keys(1, 1)[0], {}, 1));
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "'upright'"));
  }

  TEST_CASE("settings describe themselves: equal ones alike, others differently") {
    CHECK(describe(LearnSettings{}) == describe(LearnSettings{}));
    std::vector<std::string> texts = {describe({})};
    LearnSettings changed;
    visit_settings(changed, [&](const char*, auto& value, auto, auto, const char*) {
      using Setting = std::remove_cvref_t<decltype(value)>;
      const Setting before = value;
      if constexpr (SettingTraits<Setting>::kIsOptional) {
        value = before ? Setting() : Setting(1);
      } else if constexpr (std::is_same_v<Setting, bool>) {
        value = !before;
      } else {
        value = static_cast<Setting>(before == 0 ? 1 : before / 2);
      }
      texts.push_back(describe(changed));
      value = before;
    });
    std::sort(texts.begin(), texts.end());
    CHECK(std::unique(texts.begin(), texts.end()) == texts.end());
    CHECK(texts.size() == 8);
    for (const std::string& text : texts) CHECK(!contains(text, "\n"));
  }
}

}  // namespace mneme::test
