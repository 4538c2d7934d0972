// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/complete_settings.h"

namespace mneme {

double default_similarity(std::string_view decomposer) {
  return decomposer.starts_with("body_pairs") ? 0.05 : 0.5;
}

namespace internal {

SolveSettings complete_settings(SolveSettings settings, const Robot& robot) {
  const bool is_planar = robot.is_planar();
  if (settings.sigma == 0) settings.sigma = is_planar ? 0.05 : 0.3;
  if (settings.similarity == 0) settings.similarity = default_similarity(default_decomposer(robot));
  if (settings.retrieve_after < 0) settings.retrieve_after = is_planar ? 0 : 1500;
  if (settings.first_components < 0) settings.first_components = is_planar ? 0 : 20;
  return settings;
}

}  // namespace internal
}  // namespace mneme
