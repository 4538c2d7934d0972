// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"

#include <Eigen/Dense>

namespace mneme::test {
namespace {

LocalSampler make_sampler(const std::vector<Configuration>& means) {
  LocalSampler sampler;
  sampler.joint_count = static_cast<int>(means.at(0).size());
  for (const Configuration& mean : means) {
    sampler.means.insert(sampler.means.end(), mean.begin(), mean.end());
  }
  return sampler;
}

/// The covariance of a component, or nothing if it has none of its own.
std::optional<Eigen::MatrixXd> covariance_of(const LocalSampler& sampler, int component) {
  const std::span<const float> packed = sampler.factor(component);
  if (packed.empty()) return std::nullopt;
  const int joints = sampler.joint_count;
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(joints, joints);
  auto at = packed.begin();
  for (int i = 0; i < joints; ++i) {
    for (int j = 0; j <= i; ++j) factor(i, j) = *at++;
  }
  return factor * factor.transpose();
}

/// A ball that slides in the plane z = 0, among boxes.
CollisionChecker sliding_ball_among(const std::vector<Shape>& shapes) {
  auto robot = require(parse_robot(R"(<robot name="slider"><link name="rail"/><link name="cart"/>
    <link name="ball"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="x" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
      <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
    <joint name="y" type="prismatic"><parent link="cart"/><child link="ball"/><axis xyz="0 1 0"/>
      <limit lower="-2" upper="2" effort="1" velocity="1"/></joint></robot>)",
                                   "slider.urdf"));
  return make_checker(robot, {"", {{"table", shapes}}});
}

/// With one wall along x = 0 that ends at y = 0.
CollisionChecker sliding_ball() {
  Box wall;
  wall.pose.translation = Vec3(0, -1.5, 0);
  wall.half_extents = Vec3(0.1, 1.5, 1);
  return sliding_ball_among({wall});
}

/// With a thin post at the origin.
CollisionChecker ball_around_post() { return sliding_ball_among({Sphere{Vec3::Zero(), 0.02}}); }

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("means that see each other become one, with their mean") {
    const CollisionChecker checker = sliding_ball();
    const LocalSampler merged = merge_cliques(checker, make_sampler({{1, -1}, {1.5, -0.5}}));
    REQUIRE(merged.component_count() == 1);
    CHECK(mean_of(merged, 0)[0] == doctest::Approx(1.25));
    CHECK(mean_of(merged, 0)[1] == doctest::Approx(-0.75));
    // Two members are not more than two joints: no covariance of its own.
    CHECK(!covariance_of(merged, 0).has_value());
  }

  TEST_CASE("means that do not see each other stay as they are") {
    const CollisionChecker checker = sliding_ball();
    const LocalSampler apart = make_sampler({{-1, -1}, {1, -1}});
    const LocalSampler merged = merge_cliques(checker, apart);
    CHECK(merged.component_count() == 2);
    CHECK(merged.means == apart.means);
    CHECK(!covariance_of(merged, 0).has_value());
    CHECK(!covariance_of(merged, 1).has_value());
  }

  TEST_CASE("all members of a group see each other, not only one") {
    // The middle one sees both others around the end of the wall; they do not see each other.
    const CollisionChecker checker = sliding_ball();
    for (const auto& order : {std::vector<Configuration>{{-0.5, -0.5}, {0, 0.9}, {0.5, -0.5}},
                              {{0, 0.9}, {-0.5, -0.5}, {0.5, -0.5}}}) {
      const LocalSampler merged = merge_cliques(checker, make_sampler(order));
      REQUIRE(merged.component_count() == 2);
      for (int i = 0; i < 2; ++i) {
        // Either one of the low ones alone, or one of them with the middle one.
        CHECK(std::abs(mean_of(merged, i)[0]) >= 0.24);
      }
    }
  }

  TEST_CASE("a group of more members than joints has the covariance of its members") {
    const CollisionChecker checker = sliding_ball();
    Rng rng(1);
    std::vector<Configuration> means;
    Eigen::MatrixXd samples(2, 40);
    for (int i = 0; i < 40; ++i) {
      const double a = rng.normal(), b = rng.normal();
      means.push_back({1 + 0.2 * a, -1 + 0.1 * a + 0.05 * b});
      for (int j = 0; j < 2; ++j) samples(j, i) = means.back()[static_cast<std::size_t>(j)];
    }
    const LocalSampler merged = merge_cliques(checker, make_sampler(means));
    REQUIRE(merged.component_count() == 1);
    const Eigen::VectorXd center = samples.rowwise().mean();
    const Eigen::MatrixXd centered = samples.colwise() - center;
    const Eigen::MatrixXd expected = centered * centered.transpose() / 39;
    const auto covariance = require(covariance_of(merged, 0));
    CHECK((covariance - expected).norm() < 5e-4);
    CHECK(Eigen::LLT<Eigen::MatrixXd>(covariance).info() == Eigen::Success);
    for (int j = 0; j < 2; ++j) {
      CHECK(mean_of(merged, 0)[static_cast<std::size_t>(j)] == doctest::Approx(center(j)));
    }
  }

  TEST_CASE("members in a line, or all the same, still have a proper covariance") {
    const CollisionChecker checker = sliding_ball();
    for (const double step : {0.1, 0.0}) {
      std::vector<Configuration> means;
      for (int i = 0; i < 8; ++i) means.push_back({0.5 + step * i, 1});
      const LocalSampler merged = merge_cliques(checker, make_sampler(means));
      REQUIRE(merged.component_count() == 1);
      const auto covariance = require(covariance_of(merged, 0));
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
      CHECK(eigen.eigenvalues().minCoeff() > 1e-6);
      CHECK(eigen.eigenvalues().minCoeff() < 1e-3);
    }
  }

  TEST_CASE("groups across the jump of a continuous joint have their mean there") {
    const CollisionChecker checker = make_checker(planar_arm({1, 1}), {});
    const LocalSampler merged =
        merge_cliques(checker, make_sampler({{3.1, 0}, {-3.1, 0}, {3.0, 0.3}, {-3.0, 0.3}}));
    REQUIRE(merged.component_count() == 1);
    CHECK(std::abs(mean_of(merged, 0)[0]) == doctest::Approx(kPi));
    CHECK(require(covariance_of(merged, 0))(0, 0) < 0.05);
  }

  TEST_CASE("components with a covariance of their own stay as they are") {
    const CollisionChecker checker = sliding_ball();
    LocalSampler sampler = make_sampler({{1, -1}, {1.2, -1}, {1.1, -0.9}, {1.3, -1.1}});
    sampler.factor_rows = {-1, 1, -1, 0};
    sampler.factors = {0.1f, 0.02f, 0.2f, 0.3f, -0.05f, 0.4f};
    const LocalSampler merged = merge_cliques(checker, sampler);
    REQUIRE(merged.component_count() == 3);
    CHECK(mean_of(merged, 0)[0] == doctest::Approx(1.05));
    CHECK(!covariance_of(merged, 0).has_value());
    for (const auto& [after, before] : {std::pair{1, 1}, {2, 3}}) {
      CHECK(mean_of(merged, after) == mean_of(sampler, before));
      require(covariance_of(merged, after));
      CHECK(*covariance_of(merged, after) == *covariance_of(sampler, before));
    }
    // Merged mixtures have nothing more to join.
    CHECK(is_same_mixture(merge_cliques(checker, merged), merged));
  }

  TEST_CASE("components join only those that count for the same source, and keep it") {
    const CollisionChecker checker = sliding_ball();
    LocalSampler sampler = make_sampler({{1, -1}, {1.2, -1}, {1.1, -0.9}, {1.3, -1.1}});
    sampler.sources = {4, 2, 4, 2};
    const LocalSampler merged = merge_cliques(checker, sampler);
    CHECK(merged.sources == std::vector<SampleSource>{4, 2});
    REQUIRE(merged.component_count() == 2);
    CHECK(mean_of(merged, 0)[0] == doctest::Approx(1.05));
    CHECK(mean_of(merged, 1)[0] == doctest::Approx(1.25));
    CHECK(merge_cliques(checker, make_sampler({{1, -1}})).sources.empty());
  }

  TEST_CASE("a group whose mean is in contact stays apart") {
    // A post that the straight motions between the three corners pass, but not their middle.
    const CollisionChecker checker = ball_around_post();
    const std::vector<Configuration> corners = {{-1, 0}, {0, -1}, {1, 0.9}};
    const LocalSampler sampler = make_sampler(corners);
    const LocalSampler merged = merge_cliques(checker, sampler);
    CHECK(merged.means == sampler.means);
    CHECK(merged.factor_rows == std::vector<int>{-1, -1, -1});
  }

  TEST_CASE("what is left when time is up stays as it is") {
    const CollisionChecker checker = sliding_ball();
    const LocalSampler sampler = make_sampler({{1, -1}, {1.2, -1}, {1, -0.9}, {1.3, -1.1}});
    int calls = 0;
    const auto is_late = [&] { return ++calls > 1; };
    const LocalSampler merged = merge_cliques(checker, sampler, is_late);
    REQUIRE(merged.component_count() == 3);
    CHECK(mean_of(merged, 0)[0] == doctest::Approx(1.1));
    CHECK(mean_of(merged, 1) == mean_of(sampler, 2));
    CHECK(mean_of(merged, 2) == mean_of(sampler, 3));
  }

  TEST_CASE("a sampler without components stays one") {
    LocalSampler empty;
    empty.joint_count = 2;
    const LocalSampler merged = merge_cliques(sliding_ball(), empty);
    CHECK(merged.joint_count == 2);
    CHECK(merged.component_count() == 0);
  }
}

TEST_SUITE("law") {
  TEST_CASE("learned samplers shrink to well-formed ones that can be drawn from") {
    const Robot robot = planar8();
    LearnSettings settings = cheap_settings();
    settings.starts_per_link = 4;
    int before = 0, after = 0, correlated = 0;
    for (const PrimitiveKey& key : random_keys(12, 31)) {
      const CollisionChecker checker = make_checker(robot, make_scene(key));
      const LocalSampler learned = learn(robot, key, settings, 1).sampler;
      const LocalSampler merged = merge_cliques(checker, learned);
      CHECK(is_same_mixture(merged, merge_cliques(checker, learned)));
      before += learned.component_count();
      after += merged.component_count();
      CHECK(merged.component_count() <= learned.component_count());
      CHECK((merged.component_count() > 0) == (learned.component_count() > 0));
      for (int i = 0; i < merged.component_count(); ++i) {
        CHECK(!robot.describe_violation(mean_of(merged, i), "mean").has_value());
        const auto covariance = covariance_of(merged, i);
        if (!covariance) continue;
        ++correlated;
        CHECK(Eigen::LLT<Eigen::MatrixXd>(*covariance).info() == Eigen::Success);
      }
      if (merged.component_count() == 0) continue;
      const auto sampler =
          make_mixture_sampler(robot, std::make_shared<const GaussianMixture>(merged), 0.05);
      const auto stream = sampler->start(1);
      std::vector<float> q(8);
      for (int i = 0; i < 100; ++i) {
        stream->next(q);
        CHECK(!robot.describe_violation(Configuration(q.begin(), q.end()), "draw").has_value());
      }
    }
    CHECK(after < before);
    CHECK(correlated > 0);
  }
}

}  // namespace mneme::test
