// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/robot.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// The decoder of a conditional variational autoencoder: two hidden layers with rectifiers over
/// latent variables and the image of a scene (scene_image.h). Matrices are row-major, outputs by
/// inputs. An output is a joint's place in its limits, -1 for the lower and 1 for the upper.
struct CvaeWeights {
  std::string robot_hash;  ///< Robot::hash()
  int joints = 0;
  int latents = 0;
  int cells = 0;                    ///< of an image's side
  int hidden = 0;                   ///< neurons of a hidden layer
  double half_extent = 0;           ///< metres from the middle of an image to its side
  std::vector<float> latent_layer;  ///< hidden x latents
  std::vector<float> image_layer;   ///< hidden x cells^2
  std::vector<float> first_bias;    ///< hidden
  std::vector<float> second_layer;  ///< hidden x hidden
  std::vector<float> second_bias;   ///< hidden
  std::vector<float> output_layer;  ///< joints x hidden
  std::vector<float> output_bias;   ///< joints
};

/// Writes the format of docs/design/baselines.md. Errors: io; sizes that do not fit together.
[[nodiscard]] Result<void> save_cvae(const std::string& path, const CvaeWeights& weights);
/// Errors: io; corrupt; unsupported if a newer mneme wrote it.
[[nodiscard]] Result<CvaeWeights> load_cvae(const std::string& path);

}  // namespace mneme::internal
