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

/// PlannerEntry::plan of one of OMPL's planners.
[[nodiscard]] Result<PlanResult> run(const OmplPlanner& planner, const PlanTask& task);

inline constexpr std::string_view kLightning = "Lightning";
inline constexpr std::string_view kThunder = "Thunder";

/// Lightning or Thunder: repairs the experience in `file` (empty: none) and plans from scratch with
/// RRTConnect, in two threads, until either has a path. `range` as for set_range. Errors: io, and
/// corrupt if OMPL cannot read the file.
[[nodiscard]] Result<::ompl::base::PlannerPtr> make_experience_planner(
    std::string_view name, const ::ompl::base::SpaceInformationPtr& information,
    const std::string& file, double range);

/// Writes the experience of Lightning or Thunder from solved paths of the robot. Errors: io; paths
/// that are none of the robot's.
[[nodiscard]] Result<void> train_experience(std::string_view planner, const Robot& robot,
                                            std::span<const Path> paths, const std::string& path);

/// OMPL logs nothing while one of these exists, in whatever thread.
class Silence {
 public:
  Silence();
  ~Silence();
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
};

}  // namespace mneme::ompl
