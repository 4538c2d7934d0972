// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/robot.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// The decoder of a conditional variational autoencoder: two hidden ReLU layers with latent
/// variables and the image of a scene (scene_image.h) as input. Matrices are row-major, outputs x
/// inputs. An output is a joint value scaled to its limits: -1 is the lower, 1 the upper.
struct CvaeWeights {
  std::string robot_hash;  ///< Robot::hash()
  int joints = 0;
  int latents = 0;
  int cells = 0;                    ///< Pixels along a side of an image.
  int hidden = 0;                   ///< Neurons of a hidden layer.
  double half_extent = 0;           ///< Metres from the middle of an image to its side.
  std::vector<float> latent_layer;  ///< hidden x latents
  std::vector<float> image_layer;   ///< hidden x cells^2
  std::vector<float> first_bias;    ///< hidden
  std::vector<float> second_layer;  ///< hidden x hidden
  std::vector<float> second_bias;   ///< hidden
  std::vector<float> output_layer;  ///< joints x hidden
  std::vector<float> output_bias;   ///< joints
};

/// Writes a file (format: docs/design/baselines.md). Errors: io; arrays of wrong sizes.
[[nodiscard]] Result<void> save_cvae(const std::string& path, const CvaeWeights& weights);
/// Reads a file. Errors: io; corrupt; unsupported for files of a newer version.
[[nodiscard]] Result<CvaeWeights> load_cvae(const std::string& path);

}  // namespace mneme::internal
