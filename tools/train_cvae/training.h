// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace mneme::cvae {

struct Sizes {
  int joints = 0;
  int latents = 0;
  int pixels = 0;  ///< of an image
  int hidden = 0;
};

/// Configurations, each seen in one of the scenes. Rows are row-major floats.
struct Examples {
  std::vector<float> images;          ///< scenes x pixels
  std::vector<float> configurations;  ///< rows x joints; each value in its limits, -1 to 1
  std::vector<std::int64_t> scenes;   ///< per row of `configurations` its row of `images`
};

struct TrainingSettings {
  int steps = 10000;
  int batch = 256;
  double learning_rate = 1e-3;
  /// Weight of the divergence of the latent variables from the normal distribution, against the sum
  /// of squared errors.
  double divergence_weight = 0.01;
  std::uint64_t seed = 1;
};

/// Layers of the decoder; matrices are row-major, outputs by inputs.
struct TrainedDecoder {
  std::vector<float> first_layer;  ///< hidden x (latents + pixels)
  std::vector<float> first_bias, second_layer, second_bias, output_layer, output_bias;
  double error = 0;       ///< mean squared error of a joint's place, of the last hundred steps
  double divergence = 0;  ///< nats, of the same
};

/// Trains encoder and decoder together, as Kingma and Welling, arXiv:1312.6114, conditioned as
/// Sohn, Lee and Yan (2015); Adam. `on_step` hears the step and its loss now and then. Throws what
/// torch throws.
TrainedDecoder train(const Sizes& sizes, const Examples& examples, const TrainingSettings& settings,
                     const std::function<void(int step, double loss)>& on_step);

}  // namespace mneme::cvae
