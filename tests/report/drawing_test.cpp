// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/picture.h"
#include "report/report_support.h"

#include <limits>
#include <map>

namespace mneme::internal {
namespace {

using test::contains;
using test::require;
using test::require_error;

GaussianMixture mixture_of(const std::vector<SampleSource>& sources) {
  GaussianMixture mixture;
  mixture.joint_count = 1;
  mixture.means.assign(sources.size(), 0);
  mixture.sources = sources;
  return mixture;
}

TEST_SUITE("unit") {
  TEST_CASE("Links joined end to end are one line through the joints") {
    const Robot robot = test::unit_arm(3);
    const Arm arm = arm_at(robot, Configuration{0, 1.5707963267948966, 0});
    REQUIRE(arm.size() == 1);
    REQUIRE(arm[0].points.size() == 4);
    CHECK(arm[0].radius == doctest::Approx(0.001));
    const std::vector<Point> expected = {{0, 0}, {1, 0}, {1, 1}, {1, 2}};
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CHECK(arm[0].points[i].x == doctest::Approx(expected[i].x));
      CHECK(arm[0].points[i].y == doctest::Approx(expected[i].y));
    }
  }

  TEST_CASE("Configurations are spread over the path by its length, ends included") {
    const Robot robot = test::unit_arm(2);
    const auto spread = spread_along(robot, {{0, 0}, {0.3, 0}, {0.3, 0.9}}, 5);
    REQUIRE(spread.size() == 5);
    const std::vector<Configuration> expected = {
        {0, 0}, {0.3, 0}, {0.3, 0.3}, {0.3, 0.6}, {0.3, 0.9}};
    for (std::size_t i = 0; i < 5; ++i) {
      CHECK(robot.distance(spread[i], expected[i]) == doctest::Approx(0).epsilon(1e-9));
    }
  }

  TEST_CASE("A continuous joint is spread over the shorter way round") {
    const Robot robot = test::unit_arm(1);
    const auto spread = spread_along(robot, {{3.0}, {-3.0}}, 3);
    CHECK(std::abs(spread[1][0]) == doctest::Approx(3.14159265).epsilon(1e-6));
  }

  TEST_CASE("A path of one state, or of equal ones, is that state") {
    const Robot robot = test::unit_arm(2);
    for (const Path& path : {Path{{1, 2}}, Path{{1, 2}, {1, 2}}}) {
      const auto spread = spread_along(robot, path, 3);
      REQUIRE(spread.size() == 3);
      CHECK(spread[2] == Configuration{1, 2});
    }
  }

  TEST_CASE("All components are shown if they are few, none if none are wanted") {
    CHECK(choose_components(mixture_of({0, 1, 0}), 60) == std::vector<int>{0, 1, 2});
    CHECK(choose_components(mixture_of({0, 1, 0}), 0).empty());
    CHECK(choose_components(mixture_of({0, 1, 0}), -1).empty());
    CHECK(choose_components(GaussianMixture{}, 60).empty());
  }

  TEST_CASE("Primitives with few components are seen beside those with many") {
    std::vector<SampleSource> sources(1000, 0);
    sources.insert(sources.end(), 5, 1);
    const GaussianMixture mixture = mixture_of(sources);
    std::map<SampleSource, int> shown;
    for (const int component : choose_components(mixture, 20)) {
      ++shown[mixture.sources[static_cast<std::size_t>(component)]];
    }
    CHECK(shown[0] == 15);
    CHECK(shown[1] == 5);
  }
}

TEST_SUITE("law") {
  TEST_CASE("Chosen components differ, are in order and fill the limit") {
    Rng rng(5);
    for (int round = 0; round < 200; ++round) {
      CAPTURE(round);
      std::vector<SampleSource> sources;
      for (std::uint32_t i = rng.index(100); i > 0; --i)
        sources.push_back(static_cast<int>(rng.index(6)));
      const int limit = static_cast<int>(rng.index(80));
      const std::vector<int> chosen = choose_components(mixture_of(sources), limit);
      CHECK(static_cast<int>(chosen.size()) == std::min(limit, static_cast<int>(sources.size())));
      for (std::size_t i = 1; i < chosen.size(); ++i) CHECK(chosen[i - 1] < chosen[i]);
      if (!chosen.empty()) CHECK(chosen.back() < static_cast<int>(sources.size()));
    }
  }
}

struct Scenario {
  Problem problem = test::gap_problem();
  GlSampler gl = test::gap_memory(5);
  PlanarPicture picture;
  Scenario() {
    picture.problem = &problem;
    picture.gl = &gl;
  }
  [[nodiscard]] std::string error() const {
    const Error error = require_error(make_drawing(picture));
    CHECK(error.code == ErrorCode::invalid);
    return error.message;
  }
};

TEST_SUITE("unit") {
  TEST_CASE("A drawing holds obstacles, the primitive and the remembered arms") {
    const Scenario scenario;
    const auto drawing = require(make_drawing(scenario.picture));
    CHECK(drawing.obstacles.size() == 2);
    CHECK(drawing.memories.size() == 5);
    CHECK(drawing.goals.size() == 1);
    CHECK(drawing.fan.empty());
    CHECK(drawing.reach == doctest::Approx(3.001));
    REQUIRE(drawing.primitives.size() == 1);
    CHECK(drawing.primitives[0].label == "2 matches, error 0.012");
  }

  TEST_CASE(
      "The frame of a primitive is the rectangle around its circles, where the symmetry puts it") {
    Scenario scenario;
    scenario.gl.primitives[0].primitive.to_scene = {1.5707963267948966, false};
    const auto drawing = require(make_drawing(scenario.picture));
    Bounds bounds;
    bounds.include(drawing.primitives[0].corners);
    // A quarter turn takes the centres (2, 1) and (2, -1) to (-1, 2) and (1, 2).
    CHECK(bounds.left == doctest::Approx(-1 - 0.7 - 0.12));
    CHECK(bounds.right == doctest::Approx(1 + 0.6 + 0.12));
    CHECK(bounds.bottom == doctest::Approx(2 - 0.7 - 0.12));
    CHECK(bounds.top == doctest::Approx(2 + 0.7 + 0.12));
  }

  TEST_CASE("Labels tell of misses and of what was learned") {
    Scenario scenario;
    PrimitiveRetrieval& retrieval = scenario.gl.primitives[0];
    const auto label = [&] { return make_drawing(scenario.picture)->primitives[0].label; };
    retrieval.matches.resize(1);
    CHECK(label() == "1 match, error 0.012");
    retrieval.is_learned = true;
    CHECK(label() == "learned now, 1 match, error 0.012");
    retrieval.matches.clear();
    CHECK(label() == "learned now");
    retrieval.is_learned = false;
    CHECK(label() == "no match");
    retrieval.matches = {{nullptr, 0.5, {}}};
    scenario.gl.primitives.assign(4, retrieval);
    CHECK(label() == "1 \u00b7 0.5");
  }

  TEST_CASE("A path gives the ends, a fan between them and the trace of the tip") {
    Scenario scenario;
    scenario.picture.path = {{-0.6, 0, 0}, {0.6, 0, 0}};
    const auto drawing = require(make_drawing(scenario.picture));
    CHECK(drawing.fan.size() == 3);
    CHECK(drawing.start[0].points.back().y < 0);
    CHECK(drawing.goals[0][0].points.back().y > 0);
    REQUIRE(drawing.tip_trace.size() > 100);
    CHECK(drawing.tip_trace.front().y == doctest::Approx(-3 * std::sin(0.6)));
    CHECK(drawing.tip_trace.back().y == doctest::Approx(3 * std::sin(0.6)));
  }

  TEST_CASE("Bounds hold all arms, and obstacles only as far as the arm reaches") {
    Scenario scenario;
    scenario.problem.scene = make_circle_scene("far", {{100, 0, 1}, {-3.5, 0, 1}});
    scenario.picture.gl = nullptr;
    const Bounds bounds = bounds_of(*make_drawing(scenario.picture));
    CHECK(bounds.right == doctest::Approx(3));
    CHECK(bounds.left == doctest::Approx(-3.001));
  }

  TEST_CASE("Configurations, keys and mixtures that do not fit the robot are refused by name") {
    Scenario scenario;
    scenario.problem.start = {0, 0};
    CHECK(scenario.error() == "picture: the start has 2 values; robot unit_arm has 3 joints");
    scenario = {};
    scenario.picture.problem = &scenario.problem;
    scenario.picture.gl = &scenario.gl;
    scenario.problem.goals[0][1] = std::numeric_limits<double>::quiet_NaN();
    CHECK(contains(scenario.error(), "a goal"));
    scenario.problem = test::gap_problem();
    scenario.picture.path = {{0, 0, 0}, {0}};
    CHECK(contains(scenario.error(), "a waypoint has 1 values"));
    scenario.picture.path.clear();
    scenario.gl.primitives[0].primitive.key = {1, 2, 3};
    CHECK(contains(scenario.error(), "key has 3 numbers"));
    scenario.gl = test::gap_memory(1);
    auto mixture = std::make_shared<GaussianMixture>();
    mixture->joint_count = 2;
    mixture->means = {0, 0};
    scenario.gl.mixture = mixture;
    CHECK(contains(scenario.error(), "the mixture has 2 joints"));
  }

  TEST_CASE("A robot that is not planar is refused by name") {
    Scenario scenario;
    scenario.problem.robot = test::unit_arm(3, Vec3::UnitY());
    const Error error = require_error(make_drawing(scenario.picture));
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(contains(error.message, "unit_arm is not planar"));
  }
}

}  // namespace

}  // namespace mneme::internal
