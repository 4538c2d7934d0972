// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "micro/suite.h"
#include "baselines/cvae_sampler.h"

namespace mneme::bench {
namespace {

constexpr int kDraws = 1000;

/// As large as what mneme_train_cvae writes by default; what the values are costs nothing.
internal::CvaeWeights make_weights(const Robot& robot) {
  internal::CvaeWeights weights;
  weights.robot_hash = robot.hash();
  weights.joints = robot.joint_count();
  weights.latents = 6;
  weights.cells = 232;
  weights.hidden = 128;
  weights.half_extent = 11.6;
  Rng rng(1);
  const auto fill = [&](std::vector<float>& values, int count) {
    for (int i = 0; i < count; ++i) values.push_back(static_cast<float>(rng.uniform(-0.1, 0.1)));
  };
  fill(weights.image_layer, weights.cells * weights.cells * weights.hidden);
  fill(weights.image_bias, weights.hidden);
  fill(weights.latent_layer, weights.hidden * weights.latents);
  fill(weights.feature_layer, weights.hidden * weights.hidden);
  fill(weights.ends_layer, weights.hidden * 2 * weights.joints);
  fill(weights.first_bias, weights.hidden);
  fill(weights.second_layer, weights.hidden * weights.hidden);
  fill(weights.second_bias, weights.hidden);
  fill(weights.output_layer, weights.joints * weights.hidden);
  fill(weights.output_bias, weights.joints);
  return weights;
}

}  // namespace

void register_cvae(const Problem& problem) {
  const auto sampler =
      internal::make_cvae_sampler(memory_query(problem), make_weights(problem.robot));
  if (!sampler) return;  // the goal is a pose
  register_repeated(
      "cvae/sample", "sample",
      [sampler = *sampler, stream = std::shared_ptr<SampleStream>((*sampler)->start(1)),
       q = std::vector<float>(static_cast<std::size_t>(problem.robot.joint_count()))]() mutable {
        for (int i = 0; i < kDraws; ++i) benchmark::DoNotOptimize(stream->next(q));
        return std::uint64_t{kDraws};
      });
}

}  // namespace mneme::bench
