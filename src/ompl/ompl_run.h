// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/ompl.h"

#include "ompl/planner_table.h"

#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/ProblemDefinition.h>

#include <atomic>

namespace mneme::ompl {

/// One call of a planner of OMPL: what PlannerRun is for mneme's own. Not thread-safe. OMPL may
/// throw from each of its functions.
class OmplRun {
 public:
  /// Refers to its arguments.
  OmplRun(const OmplPlanner& planner, const PlanTask& task);

  /// Plans until the limits are reached. Errors: experience that cannot be read.
  [[nodiscard]] Result<PlanResult> plan();

 private:
  void set_up_information();
  void define_problem();
  [[nodiscard]] Result<::ompl::base::PlannerPtr> make_planner() const;
  [[nodiscard]] ::ompl::base::PlannerTerminationCondition limits() const;
  [[nodiscard]] bool is_full() const;
  /// The time is up, or the run is cancelled.
  [[nodiscard]] bool is_over() const;
  [[nodiscard]] Path solution() const;
  /// Shortens and verifies a path, as far as the settings say; false if it is refused.
  [[nodiscard]] bool is_accepted(Path& path);
  void explain_failure();

  const OmplPlanner& planner_;
  const PlanTask& task_;
  const PlanSettings& settings_;
  const Robot& robot_;
  std::shared_ptr<WorkCounters> counters_ = std::make_shared<WorkCounters>();
  std::shared_ptr<::ompl::base::SpaceInformation> information_;
  ::ompl::base::ProblemDefinitionPtr definition_;
  Stopwatch stopwatch_;
  CheckCounters checks_;  ///< of simplification and verification
  /// Planners free what they worked with when they end, and may ask from several threads.
  mutable std::atomic<bool> was_full_{false};
  PlanResult result_;
};

/// PlannerEntry::plan of one of OMPL's planners.
[[nodiscard]] Result<PlanResult> run(const OmplPlanner& planner, const PlanTask& task);

}  // namespace mneme::ompl
