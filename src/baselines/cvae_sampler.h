// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/pipeline.h"

#include "baselines/cvae_weights.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// Sampler of configurations by a decoder, conditioned on a scene of circles, start and goal.
/// Ichter, Harrison and Pavone, Learning sampling distributions for robot motion planning, DOI
/// 10.1109/ICRA.2018.8460730. Each sample is for one of the goals at random. Scene, start and goals
/// are turned to canonical form, and the configurations are turned back. Errors: weights of another
/// robot; a query without start or goals.
[[nodiscard]] Result<std::shared_ptr<const Sampler>> make_cvae_sampler(const MemoryQuery& query,
                                                                       const CvaeWeights& weights);

/// Returns the joint values of `q` scaled to their limits: -1 is the lower, 1 the upper. Continuous
/// joints are wrapped, others are clamped.
[[nodiscard]] std::vector<float> scaled_to_limits(const Robot& robot, std::span<const double> q);

/// The file with the weights trained on a database.
[[nodiscard]] std::string cvae_path(const Database& database);

}  // namespace mneme::internal
