// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/ompl.h"

#include <ompl/base/Planner.h>
#include <ompl/base/SpaceInformation.h>

#include <span>
#include <string>
#include <string_view>

namespace mneme::ompl {

struct OmplPlanner {
  std::string_view name;
  /// Null for planners that need experience: make_experience_planner().
  ::ompl::base::PlannerPtr (*make)(const ::ompl::base::SpaceInformationPtr& information) = nullptr;
  bool samples_valid_states = false;  ///< uses the information's sampler of valid states
};

[[nodiscard]] std::span<const OmplPlanner> ompl_planners();

/// Sets the longest extension of a planner, if it has one, radians; 0: OMPL's default.
void set_range(::ompl::base::Planner& planner, double range);

/// The sampler of valid states with that name, or nothing. `deviation` > 0: standard deviation of
/// Gaussian ones, radians.
[[nodiscard]] ::ompl::base::ValidStateSamplerAllocator valid_sampler_allocator(
    std::string_view name, double deviation);
/// Adds the samplers of valid states to samplers().
void add_valid_samplers();

/// PlannerEntry::plan of one of OMPL's planners.
[[nodiscard]] Result<PlanResult> run(const OmplPlanner& planner, const PlanTask& task);

inline constexpr std::string_view kLightning = "Lightning";
inline constexpr std::string_view kThunder = "Thunder";

/// Lightning or Thunder: repairs experience from `file` (may be empty) in one thread and plans from
/// scratch with RRTConnect in another, until either has a path. `range`: see set_range(). Errors:
/// io; corrupt if OMPL cannot read the file.
[[nodiscard]] Result<::ompl::base::PlannerPtr> make_experience_planner(
    std::string_view name, const ::ompl::base::SpaceInformationPtr& information,
    const std::string& file, double range);

/// Writes experience of Lightning or Thunder from solved paths. Errors: io; paths that do not fit
/// the robot.
[[nodiscard]] Result<void> train_experience(std::string_view planner, const Robot& robot,
                                            std::span<const Path> paths, const std::string& path);

/// Turns off OMPL's log, in all threads, while an object exists.
class Silence {
 public:
  Silence();
  ~Silence();
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
};

}  // namespace mneme::ompl
