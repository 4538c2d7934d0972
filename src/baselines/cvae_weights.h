// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/robot.h"

#include <memory>
#include <string>
#include <vector>

namespace mneme::internal {

/// The decoder of a conditional variational autoencoder. A layer of rectifiers turns the image of a
/// scene (scene_image.h) into features. Two hidden layers and an output layer turn latent
/// variables, features, start and goal into a configuration. Joint values are scaled to their
/// limits: -1 is the lower, 1 the upper. Matrices are row-major, outputs x inputs except for the
/// first.
struct CvaeWeights {
  std::string robot_hash;  ///< Robot::hash()
  int joints = 0;
  int latents = 0;
  int cells = 0;                     ///< Pixels along a side of an image.
  int hidden = 0;                    ///< Features, and neurons of a hidden layer.
  double half_extent = 0;            ///< Metres from the middle of an image to its side.
  std::vector<float> image_layer;    ///< cells^2 x hidden: one row per pixel
  std::vector<float> image_bias;     ///< hidden
  std::vector<float> latent_layer;   ///< hidden x latents
  std::vector<float> feature_layer;  ///< hidden x hidden
  std::vector<float> ends_layer;     ///< hidden x 2 joints: start, then goal
  std::vector<float> first_bias;     ///< hidden
  std::vector<float> second_layer;   ///< hidden x hidden
  std::vector<float> second_bias;    ///< hidden
  std::vector<float> output_layer;   ///< joints x hidden
  std::vector<float> output_bias;    ///< joints
};

/// Writes a file (format: docs/design/baselines.md). Errors: io; arrays of wrong sizes.
[[nodiscard]] Result<void> save_cvae(const std::string& path, const CvaeWeights& weights);
/// Reads a file. Errors: io; corrupt; unsupported for files of another version.
[[nodiscard]] Result<CvaeWeights> load_cvae(const std::string& path);
/// As load_cvae(). Keeps the last file's weights until its time of change or its size differs.
/// Thread-safe.
[[nodiscard]] Result<std::shared_ptr<const CvaeWeights>> keep_cvae(const std::string& path);

}  // namespace mneme::internal
