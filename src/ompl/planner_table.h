// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ompl/base/Planner.h>
#include <ompl/base/SpaceInformation.h>

#include <span>
#include <string_view>

namespace mneme::ompl {

struct OmplPlanner {
  std::string_view name;
  /// Null for those that need experience (experience.h).
  ::ompl::base::PlannerPtr (*make)(const ::ompl::base::SpaceInformationPtr& information) = nullptr;
  bool draws_valid_states = false;  ///< through the information's sampler of valid states
};

[[nodiscard]] std::span<const OmplPlanner> ompl_planners();

/// The longest extension, radians, of a planner that has one; 0: OMPL's default.
void set_range(::ompl::base::Planner& planner, double range);

/// Sampler of valid states by name, or nothing. `deviation` above 0 counts for those
/// that draw from a bell, radians.
[[nodiscard]] ::ompl::base::ValidStateSamplerAllocator valid_sampler_allocator(
    std::string_view name, double deviation);
/// Adds them to samplers().
void add_valid_samplers();

}  // namespace mneme::ompl
