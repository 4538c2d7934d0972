// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/kinds.h"
#include "memory/moved_means.h"
#include "support/lifting_arm.h"
#include "support/planar_memory.h"
#include "support/threaded.h"

namespace mneme::test {
namespace {

GaussianMixture pooled_of(const Robot& robot, std::span<const PrimitiveRetrieval> retrievals) {
  static const Scene scene;
  return internal::pool_moved_means({robot, scene}, retrievals);
}

/// An experience with random means within the limits, every other one with a covariance.
Experience random_experience(const Robot& robot, int components, Rng& rng) {
  Experience experience;
  LocalSampler& sampler = experience.sampler();
  sampler.joint_count = robot.joint_count();
  for (int i = 0; i < components; ++i) {
    for (const double value : random_configuration(robot, rng)) {
      sampler.means.push_back(static_cast<float>(value));
    }
    sampler.factor_rows.push_back(i % 2 == 0 ? -1 : i / 2);
  }
  sampler.factors.resize(sampler.factor_size() * static_cast<std::size_t>(components / 2));
  for (float& value : sampler.factors) value = static_cast<float>(rng.uniform(0.1, 1));
  return experience;
}

std::vector<float> factor_of(const GaussianMixture& mixture, int component) {
  const std::span<const float> factor = mixture.factor(component);
  return {factor.begin(), factor.end()};
}

std::shared_ptr<const Experience> shared(const Experience& row) {
  return std::make_shared<const Experience>(row);
}

PrimitiveRetrieval retrieve(const std::vector<Match>& matches) {
  PrimitiveRetrieval retrieval;
  retrieval.matches = matches;
  return retrieval;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE(
      "all components of all matches are pooled, the most similar match first, moved by its "
      "symmetry") {
    const Robot robot = planar8();
    Rng rng(1);
    const Experience a = random_experience(robot, 6, rng), b = random_experience(robot, 3, rng);
    const Symmetry turned{2.5, false}, mirrored{-1, true};
    const std::vector<PrimitiveRetrieval> primitives = {
        retrieve({{shared(a), 0.1, turned}}), retrieve({}),
        retrieve({{shared(b), 0, mirrored}, {shared(a), 0.2, mirrored}, {shared(b), 0.1, turned}})};
    // Whatever they were retrieved for: equally similar ones in the scene's order.
    const std::vector<std::pair<SampleSource, Match>> expected_order = {
        {2, primitives[2].matches[0]},
        {0, primitives[0].matches[0]},
        {2, primitives[2].matches[2]},
        {2, primitives[2].matches[1]}};
    const GaussianMixture pooled = pooled_of(robot, primitives);
    REQUIRE(pooled.component_count() == 3 + 6 + 3 + 6);
    REQUIRE(pooled.sources.size() == 18);
    int next = 0;
    for (const auto& [source, match] : expected_order) {
      const LocalSampler& local = match.experience->sampler();
      for (int j = 0; j < local.component_count(); ++j, ++next) {
        const Configuration expected =
            moved_configuration(find_symmetric_joints(robot), match.to_scene, mean_of(local, j));
        CHECK(robot.distance(mean_of(pooled, next), expected) < 1e-5);
        CHECK(pooled.sources[static_cast<std::size_t>(next)] == source);
        CHECK(factor_of(pooled, next) == factor_of(local, j));
      }
    }
  }

  TEST_CASE("draws fall on every primitive in proportion to its components") {
    const Robot robot = planar8();
    Rng rng(2);
    const Experience a = random_experience(robot, 2, rng), b = random_experience(robot, 6, rng);
    const auto mixture = std::make_shared<const GaussianMixture>(pooled_of(
        robot, std::vector{retrieve({{shared(a), 0, {}}}), retrieve({{shared(b), 0, {}}})}));
    const auto sampler = make_mixture_sampler(robot, mixture, 0.1);
    const auto stream = sampler->start(1);
    std::vector<float> q(8);
    int second = 0;
    for (int i = 0; i < 4000; ++i) second += stream->next(q);
    CHECK(second == doctest::Approx(3000).epsilon(0.03));
  }

  TEST_CASE("means that are free in the canonical scene are free in every moved one") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    learn_into(database, robot, {near_pair()});
    const LocalSampler stored = database.get(0)->sampler();
    REQUIRE(stored.component_count() > 3);
    const CollisionChecker canonical = make_checker(robot, make_scene(near_pair()), 1e-4);
    Rng rng(3);
    for (int round = 0; round < 20; ++round) {
      const Symmetry motion{rng.uniform(-kPi, kPi), round % 2 == 0};
      const PrimitiveKey moved = moved_key(motion, near_pair());
      const LocalPrimitive primitive = make_primitive(moved);
      PrimitiveRetrieval retrieval;
      retrieval.matches =
          *find_matches(database, kind_named("pairs"), primitive, {.similarity = 0.01});
      REQUIRE(retrieval.matches.size() == 1);
      const GaussianMixture pooled = pooled_of(robot, std::vector{retrieval});
      REQUIRE(pooled.component_count() == stored.component_count());
      const CollisionChecker checker = make_checker(robot, make_scene(moved));
      int checked = 0;
      for (int i = 0; i < pooled.component_count(); ++i) {
        const Configuration before = mean_of(stored, i), after = mean_of(pooled, i);
        CHECK(first_crossing_link(robot, near_pair(), before) ==
              first_crossing_link(robot, moved, after));
        if (!canonical.contacts(before).empty()) continue;
        ++checked;
        CHECK(checker.is_valid(std::span<const double>(after)));
        CHECK(checker.contacts(after).empty());
      }
      CHECK(checked * 10 >= 9 * pooled.component_count());
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a mirror image of what is known matches, unless only rotations are to match") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    learn_into(database, robot, {near_pair()});
    const MemoryKind& kind = kind_named("pairs");
    const LocalPrimitive mirrored = make_primitive(moved_key({0.3, true}, near_pair()));
    const LocalPrimitive turned = make_primitive(moved_key({0.3, false}, near_pair()));
    REQUIRE(require(find_matches(database, kind, mirrored, {.similarity = 1e-6})).size() == 1);
    CHECK(
        find_matches(database, kind, mirrored, {.similarity = 1e-6})->front().to_scene.is_mirrored);
    CHECK(require(find_matches(database, kind, mirrored, {.similarity = 1e-6, .mirror = false}))
              .empty());
    CHECK(require(find_matches(database, kind, turned, {.similarity = 1e-6, .mirror = false}))
              .size() == 1);
  }

  TEST_CASE("nothing retrieved is an empty mixture of the robot's joints") {
    const Robot robot = planar8();
    const GaussianMixture none = pooled_of(robot, {});
    CHECK(none.joint_count == 8);
    CHECK(none.component_count() == 0);
    Experience hopeless;
    hopeless.sampler().joint_count = 8;
    const GaussianMixture still_none =
        pooled_of(robot, std::vector{retrieve({{shared(hopeless), 0, {}}})});
    CHECK(still_none.component_count() == 0);
    CHECK(still_none.sources.empty());
  }

  TEST_CASE("means that leave the limits are dropped with all that belongs to them") {
    // The first joint is limited, so that it cannot turn as far as a continuous one.
    const auto urdf = require(planar_arm_urdf("arm", std::vector<double>{1, 1}, 0.01));
    std::string text = urdf;
    text.replace(text.find("continuous"), 10, "revolute");
    text.insert(text.find("<limit ") + 7, R"(lower="-1" upper="2" )");
    const auto robot = require(parse_robot(text, "arm.urdf"));
    Experience experience;
    experience.sampler().joint_count = 2;
    experience.sampler().means = {-0.5f, 1, 0, -2, 1.5f, 3};
    experience.sampler().factor_rows = {0, -1, 1};
    experience.sampler().factors = {1, 2, 3, 4, 5, 6};

    const auto synthesized = [&](const Symmetry& motion) {
      return pooled_of(robot, std::vector{retrieve({{shared(experience), 0, motion}})});
    };
    CHECK(synthesized({}).component_count() == 3);
    const GaussianMixture turned = synthesized({1, false});
    CHECK(turned.means == std::vector<float>{0.5f, 1, 1, -2});
    CHECK(factor_of(turned, 0) == std::vector<float>{1, 2, 3});
    CHECK(factor_of(turned, 1).empty());
    CHECK(turned.sources.size() == 2);
    const GaussianMixture mirrored = synthesized({-0.5, true});
    CHECK(mirrored.means == std::vector<float>{0, -1, -0.5f, 2});
    const GaussianMixture back = synthesized({-0.75, false});
    CHECK(back.means == std::vector<float>{-0.75f, -2, 0.75f, 3});
    CHECK(factor_of(back, 0).empty());
    CHECK(factor_of(back, 1) == std::vector<float>{4, 5, 6});
    CHECK(synthesized({3.2, false}).component_count() == 0);
    // Means on a limit stay.
    CHECK(synthesized({0.5, false}).means == std::vector<float>{0, 1, 0.5f, -2, 2, 3});
  }

  TEST_CASE("an arm that lifts and turns is moved by both, as far as its limits allow") {
    const Robot robot = lifting_arm();
    Experience experience;
    experience.sampler().joint_count = 4;
    experience.sampler().means = {0.1f, 0, 1, -1, 0.3f, 2, 0.5f, 0.25f, -0.2f, 3, 0, 0};
    const auto synthesized = [&](const Symmetry& motion) {
      return pooled_of(robot, std::vector{retrieve({{shared(experience), 0, motion}})}).means;
    };
    const auto check = [](const std::vector<float>& found, const std::vector<float>& expected) {
      REQUIRE(found.size() == expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        CHECK(found[i] == doctest::Approx(expected[i]).epsilon(1e-6));
      }
    };
    check(synthesized({-0.5, false, 0.1}), {0.2f, -0.5f, 1, -1, 0.4f, 1.5f, 0.5f, 0.25f});
    // Lifted off one of its ends, or turned too far.
    check(synthesized({0, false, 0.3}), {0.4f, 0, 1, -1});
    check(synthesized({0, false, -0.2}), {0.1f, 2, 0.5f, 0.25f});
    check(synthesized({1, false, 0}), {0.1f, 1, 1, -1});
    // A mean outside the limits may be moved into them, and a turn counts modulo a full one.
    check(synthesized({-1.5, false, 0.3}), {0.4f, -1.5f, 1, -1, 0.1f, 1.5f, 0, 0});
    check(synthesized({3.0, false, 0}), {0.3f, 5 - 2 * static_cast<float>(kPi), 0.5f, 0.25f});
  }

  TEST_CASE("continuous joints wrap") {
    const Robot robot = planar8();
    Experience experience;
    experience.sampler().joint_count = 8;
    experience.sampler().means = {3, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f};
    const GaussianMixture pooled =
        pooled_of(robot, std::vector{retrieve({{shared(experience), 0, {1, false}}})});
    REQUIRE(pooled.component_count() == 1);
    CHECK(pooled.means[0] == doctest::Approx(4 - 2 * kPi));
    CHECK(pooled.means[7] == 0.7f);
    CHECK(factor_of(pooled, 0).empty());
  }
}

}  // namespace mneme::test
