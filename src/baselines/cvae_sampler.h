// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/pipeline.h"

#include "baselines/cvae_weights.h"

#include <memory>

namespace mneme::internal {

/// Sampler of configurations by a decoder, conditioned on a scene of circles. Ichter, Harrison and
/// Pavone, Learning sampling distributions for robot motion planning, DOI
/// 10.1109/ICRA.2018.8460730. The whole scene is turned to canonical form, and the configurations
/// are turned back. Errors: weights of another robot.
[[nodiscard]] Result<std::shared_ptr<const Sampler>> make_cvae_sampler(const Robot& robot,
                                                                       const Scene& scene,
                                                                       const CvaeWeights& weights);

/// The file with the weights trained on a database.
[[nodiscard]] std::string cvae_path(const Database& database);

}  // namespace mneme::internal
