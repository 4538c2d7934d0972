// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/baselines.h"

#include "baselines/cvae_sampler.h"
#include "baselines/scene_image.h"
#include "baselines/small_cvae.h"

namespace mneme::test {
namespace {

constexpr std::uint64_t kSeed = 20265;

std::vector<float> draw(const Robot& robot, const Scene& scene,
                        const internal::CvaeWeights& weights, int count) {
  const auto sampler = require(internal::make_cvae_sampler(robot, scene, weights));
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

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("a sample is what plain loops over the layers give for the same latent variables") {
    const Robot robot = planar8();
    const internal::CvaeWeights weights = random_weights(robot, kSeed);
    // Canonical already: the mean centre lies on the x axis.
    const PrimitiveKey circles = {4, 2, 1, 6, -2, 1.5};
    const std::vector<float> sampled = draw(robot, make_scene(circles), weights, 3);
    Rng rng(7);
    const auto image = doubles(internal::draw_image(circles, 6, 12));
    for (std::size_t sample = 0; sample < 3; ++sample) {
      std::vector<double> latent(3);
      for (double& value : latent) value = rng.normal();
      const auto seen = layer(weights.image_layer, image, doubles(weights.first_bias), false);
      const auto first = layer(weights.latent_layer, latent, seen, true);
      const auto second = layer(weights.second_layer, first, doubles(weights.second_bias), true);
      const auto place = layer(weights.output_layer, second, doubles(weights.output_bias), false);
      for (std::size_t j = 0; j < 8; ++j) {
        CHECK(std::abs(sampled[8 * sample + j] - kPi * place[j]) < 1e-4);
      }
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("a scene that is turned turns the first joint of every sample, and nothing else") {
    const Robot robot = planar8();
    const internal::CvaeWeights weights = random_weights(robot, kSeed);
    const PrimitiveKey circles = {4, 2, 1, 6, -2, 1.5};
    const auto plain = draw(robot, make_scene(circles), weights, 20);
    const auto turned = draw(robot, make_scene(moved_key({1.3, false}, circles)), weights, 20);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      const double expected = plain[i] + (i % 8 == 0 ? 1.3 : 0);
      CHECK(std::abs(std::remainder(turned[i] - expected, 2 * kPi)) < 1e-4);
    }
  }

  TEST_CASE("samples are within the limits") {
    const Robot robot = planar8();
    internal::CvaeWeights weights = random_weights(robot, kSeed);
    for (float& value : weights.output_bias) value = 1.2f;
    const auto rows = draw(robot, {}, weights, 50);
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
    CHECK(require_error(internal::make_cvae_sampler(robot, {}, weights)).code ==
          ErrorCode::wrong_robot);
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
