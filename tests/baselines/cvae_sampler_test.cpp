// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/baselines.h"

#include "baselines/cvae_sampler.h"
#include "baselines/scene_image.h"
#include "baselines/small_cvae.h"

#include <algorithm>
#include <set>

namespace mneme::test {
namespace {

constexpr std::uint64_t kSeed = 20265;

/// Canonical: the mean centre lies on the x axis.
PrimitiveKey two_circles() { return {4, 2, 1, 6, -2, 1.5}; }

Configuration some_goal() { return {-2, 0.3, 1, -0.2, 0.4, -1.5, 0.6, 2}; }
Configuration other_goal() { return {1.2, -0.7, 0.1, 0.9, -0.4, 0.8, 2.5, -1}; }
PlanQuery some_ends() { return {{0.1, 0.2, -0.3, 0.4, -0.5, 0.6, -0.7, 0.8}, {some_goal()}}; }

std::vector<float> draw(const Robot& robot, const Scene& scene, const PlanQuery& ends,
                        const internal::CvaeWeights& weights, int count) {
  const MemoryQuery query{robot, scene, &ends.start, ends.goals};
  const auto sampler = require(internal::make_cvae_sampler(query, weights));
  const auto stream = sampler->start(7);
  std::vector<float> rows(static_cast<std::size_t>(8 * count));
  for (int i = 0; i < count; ++i) {
    stream->next(std::span(rows).subspan(static_cast<std::size_t>(8 * i), 8));
  }
  return rows;
}

/// outputs = weights * inputs + bias, in plain loops.
std::vector<double> layer(const std::vector<float>& matrix, const std::vector<double>& inputs,
                          const std::vector<double>& bias, bool has_rectifier) {
  std::vector<double> outputs = bias;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = 0; j < inputs.size(); ++j) {
      outputs[i] += static_cast<double>(matrix[i * inputs.size() + j]) * inputs[j];
    }
    if (has_rectifier) outputs[i] = std::max(outputs[i], 0.0);
  }
  return outputs;
}
std::vector<double> doubles(const std::vector<float>& values) {
  return {values.begin(), values.end()};
}

/// A matrix with `columns` columns, with rows for columns.
std::vector<float> transposed(const std::vector<float>& matrix, std::size_t columns) {
  std::vector<float> result;
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t i = column; i < matrix.size(); i += columns) result.push_back(matrix[i]);
  }
  return result;
}

/// Start and goal in their limits of half a turn.
std::vector<double> scaled_ends(const Configuration& start, const Configuration& goal) {
  std::vector<double> ends = start;
  ends.insert(ends.end(), goal.begin(), goal.end());
  for (double& value : ends) value /= kPi;
  return ends;
}

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("a sample is what plain loops over the layers give for the same latent variables") {
    const Robot robot = planar8();
    const internal::CvaeWeights weights = random_weights(robot, kSeed);
    PlanQuery ends = some_ends();
    ends.goals.push_back(other_goal());
    const auto sampled = draw(robot, make_scene(two_circles()), ends, weights, 6);
    const auto image = doubles(internal::draw_image(two_circles(), 6, 12));
    const auto features =
        layer(transposed(weights.image_layer, 10), image, doubles(weights.image_bias), true);
    const auto seen = layer(weights.feature_layer, features, doubles(weights.first_bias), false);
    Rng rng(7);
    for (std::size_t sample = 0; sample < 6; ++sample) {
      const Configuration& goal = ends.goals[rng.index(2)];
      std::vector<double> latent(3);
      for (double& value : latent) value = rng.normal();
      const auto led = layer(weights.ends_layer, scaled_ends(ends.start, goal), seen, false);
      const auto first = layer(weights.latent_layer, latent, led, true);
      const auto second = layer(weights.second_layer, first, doubles(weights.second_bias), true);
      const auto place = layer(weights.output_layer, second, doubles(weights.output_bias), false);
      for (std::size_t j = 0; j < 8; ++j) {
        CHECK(std::abs(sampled[8 * sample + j] - kPi * place[j]) < 1e-4);
      }
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("scene, start and goal that are turned turn the first joint of every sample alone") {
    const Robot robot = planar8();
    const internal::CvaeWeights weights = random_weights(robot, kSeed);
    const Symmetry turn{1.3, false};
    const auto turned_by = [&](const Configuration& q) {
      return moved_configuration(find_symmetric_joints(robot), turn, q);
    };
    const PlanQuery ends = some_ends();
    const PlanQuery turned_ends{turned_by(ends.start), {turned_by(ends.goals[0])}};
    const auto plain = draw(robot, make_scene(two_circles()), ends, weights, 20);
    const auto turned =
        draw(robot, make_scene(moved_key(turn, two_circles())), turned_ends, weights, 20);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      const double expected = plain[i] + (i % 8 == 0 ? 1.3 : 0);
      CHECK(std::abs(std::remainder(turned[i] - expected, 2 * kPi)) < 1e-4);
    }
  }

  TEST_CASE("samples depend on scene, start and goal, and on nothing else") {
    const Robot robot = planar8();
    const internal::CvaeWeights weights = random_weights(robot, kSeed);
    const Scene scene = make_scene(two_circles());
    const PlanQuery ends = some_ends();
    const auto plain = draw(robot, scene, ends, weights, 5);
    CHECK(plain == draw(robot, scene, ends, weights, 5));
    CHECK(plain != draw(robot, {}, ends, weights, 5));
    CHECK(plain != draw(robot, scene, {ends.start, {other_goal()}}, weights, 5));
    CHECK(plain != draw(robot, scene, {other_goal(), ends.goals}, weights, 5));
    // Start and goal are not exchanged.
    CHECK(plain != draw(robot, scene, {ends.goals[0], {ends.start}}, weights, 5));
  }

  TEST_CASE("each sample is for one of several goals, and every goal has its turn") {
    const Robot robot = planar8();
    internal::CvaeWeights weights = random_weights(robot, kSeed);
    std::ranges::fill(weights.latent_layer, 0.0f);
    const Scene scene = make_scene(two_circles());
    PlanQuery ends = some_ends();
    std::set<std::vector<float>> alone, together;
    for (const Configuration& goal : {some_goal(), other_goal(), ends.start}) {
      alone.insert(draw(robot, scene, {ends.start, {goal}}, weights, 1));
    }
    REQUIRE(alone.size() == 3);
    ends.goals = {some_goal(), other_goal(), ends.start};
    const auto rows = draw(robot, scene, ends, weights, 60);
    for (auto row = rows.begin(); row != rows.end(); row += 8) together.emplace(row, row + 8);
    CHECK(together == alone);
  }

  TEST_CASE("samples are within the limits") {
    const Robot robot = planar8();
    internal::CvaeWeights weights = random_weights(robot, kSeed);
    for (float& value : weights.output_bias) value = 1.2f;
    const auto rows = draw(robot, {}, some_ends(), weights, 50);
    for (std::size_t i = 0; i < rows.size(); i += 8) {
      const Configuration q(rows.begin() + static_cast<std::ptrdiff_t>(i),
                            rows.begin() + static_cast<std::ptrdiff_t>(i + 8));
      CHECK(!robot.describe_violation(q, "sample"));
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("weights of another robot are refused") {
    const Robot robot = planar8();
    internal::CvaeWeights weights = random_weights(robot, 1);
    weights.robot_hash = std::string(16, '0');
    const PlanQuery ends = some_ends();
    const Scene scene;
    CHECK(
        require_error(internal::make_cvae_sampler({robot, scene, &ends.start, ends.goals}, weights))
            .code == ErrorCode::wrong_robot);
  }

  TEST_CASE("a query without start or goals, or with ends of another robot, is refused") {
    const Robot robot = planar8();
    const internal::CvaeWeights weights = random_weights(robot, 1);
    const PlanQuery ends = some_ends();
    const Configuration short_start = {1, 2};
    const std::vector<Configuration> strange_goals = {some_goal(), {1, 2}};
    const Scene scene;
    for (const MemoryQuery& query : std::vector<MemoryQuery>{
             {robot, scene, nullptr, ends.goals},
             {robot, scene, &ends.start, {}},
             {robot, scene, &short_start, ends.goals},
             {robot, scene, &ends.start, strange_goals},
         }) {
      CHECK(require_error(internal::make_cvae_sampler(query, weights)).code == ErrorCode::invalid);
    }
  }

  TEST_CASE("joint values are scaled to their limits, wrapped or clamped to them") {
    const Robot robot = limited_arm({1, 1, 1}, -1, 3);
    const auto scaled = internal::scaled_to_limits(robot, Configuration{1.5 * kPi, 2, 3.5});
    REQUIRE(scaled.size() == 3);
    CHECK(scaled[0] == doctest::Approx(-0.5));
    CHECK(scaled[1] == doctest::Approx(0.5));
    CHECK(scaled[2] == doctest::Approx(1));
  }

  TEST_CASE("the sampler cvae of solve() reads the weights beside the database") {
    add_baseline_samplers();
    const Problem problem = planar_problem("threaded_b4");
    const TemporaryDirectory directory;
    Database database = make_database(directory / "m.db", problem.robot);
    SolveSettings settings;
    settings.sampler = "cvae";
    settings.retrieve_after = 0;
    settings.plan.max_iterations = 200;
    CHECK(contains(require_error(solve(problem, &database, settings)).message, "m.db.cvae"));
    REQUIRE(internal::save_cvae(directory / "m.db.cvae", random_weights(problem.robot, 1)));
    const auto solved = require(solve(problem, &database, settings));
    CHECK(solved.sampler == "cvae");
    CHECK(solved.gl.retrieval_time_s > 0);
  }
}

}  // namespace mneme::test
