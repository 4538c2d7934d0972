// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "baselines/cvae_weights.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace mneme::cvae {

struct Sizes {
  int joints = 0;
  int latents = 0;
  int cells = 0;         ///< Pixels along a side of an image.
  int hidden = 0;        ///< Features of an image, and neurons of a hidden layer.
  double cell_area = 1;  ///< Square metres of a pixel.
};

/// Configurations on paths in scenes. Rows are row-major; joint values are scaled to their limits.
struct Examples {
  std::vector<std::uint8_t> images;        ///< scenes x cells^2, 255 inside circles
  std::vector<std::int64_t> begins = {0};  ///< scenes + 1: per scene its first example
  std::vector<float> ends;                 ///< paths x 2 joints: start, then goal
  std::vector<float> configurations;       ///< examples x joints
  std::vector<std::int64_t> paths;         ///< per example its row of `ends`

  [[nodiscard]] std::size_t scene_count() const { return begins.size() - 1; }
  [[nodiscard]] std::size_t example_count() const { return paths.size(); }
};

struct TrainingSettings {
  int steps = 60000;    ///< Most batches.
  double minutes = 60;  ///< Most time.
  int scenes = 64;      ///< Scenes in a batch.
  int examples = 16;    ///< Examples in a batch of each of its scenes.
  double learning_rate = 1e-3;
  /// Weight of the divergence of the latent variables from the normal distribution, against the sum
  /// of squared errors.
  double divergence_weight = 0.01;
  std::uint64_t seed = 1;
};

/// How well the weights fit after some steps. A loss is the sum of squared errors of the joint
/// values and the weighted divergence, per example.
struct Check {
  int step = 0;
  double time_s = 0;
  double learning_rate = 0;  ///< Before the check.
  double training_loss = 0;  ///< Mean over the steps since the check before.
  /// Loss on the examples held out, as are error and divergence.
  double loss = std::numeric_limits<double>::infinity();
  double error = 0;       ///< Mean squared error of a joint value.
  double divergence = 0;  ///< Nats.
};

enum class Ending { converged, step_limit, time_limit, diverged };

struct Trained {
  internal::CvaeWeights weights;  ///< Those of the best check, without robot_hash and half_extent.
  Check best;                     ///< The check with the least loss.
  int steps = 0;
  Ending ending = Ending::step_limit;
};

/// Trains encoder and decoder together, as Kingma and Welling, arXiv:1312.6114, conditioned as
/// Sohn, Lee and Yan (2015), by Adam. The loss on `held_out` is checked every 200 steps. Four
/// checks without a new least loss halve the learning rate. After four halvings they end the
/// training. `on_check` receives each check. Throws what torch throws.
[[nodiscard]] Trained train(const Sizes& sizes, const Examples& training, const Examples& held_out,
                            const TrainingSettings& settings,
                            const std::function<void(const Check&)>& on_check);

}  // namespace mneme::cvae
