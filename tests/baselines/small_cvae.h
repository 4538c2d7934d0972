// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Weights of a decoder that was never trained.
#pragma once

#include "baselines/cvae_weights.h"
#include "support/planar_memory.h"

namespace mneme::test {

inline std::vector<float> random_floats(std::size_t count, double spread, Rng& rng) {
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(rng.uniform(-spread, spread));
  return values;
}

inline internal::CvaeWeights random_weights(const Robot& robot, std::uint64_t seed) {
  Rng rng(seed);
  internal::CvaeWeights weights;
  weights.robot_hash = robot.hash();
  weights.joints = robot.joint_count();
  weights.latents = 3;
  weights.cells = 6;
  weights.hidden = 10;
  weights.half_extent = 12;
  weights.image_layer = random_floats(36 * 10, 0.5, rng);
  weights.image_bias = random_floats(10, 0.5, rng);
  weights.latent_layer = random_floats(10 * 3, 0.5, rng);
  weights.feature_layer = random_floats(10 * 10, 0.3, rng);
  weights.ends_layer = random_floats(10 * 2 * 8, 0.5, rng);
  weights.first_bias = random_floats(10, 0.5, rng);
  weights.second_layer = random_floats(10 * 10, 0.5, rng);
  weights.second_bias = random_floats(10, 0.5, rng);
  weights.output_layer = random_floats(8 * 10, 0.2, rng);
  weights.output_bias = random_floats(8, 0.2, rng);
  return weights;
}

}  // namespace mneme::test
