// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/ProblemDefinition.h>

#include "base/stopwatch.h"
#include "mneme/ompl.h"
#include "ompl/planner_table.h"
#include "path/verify.h"

namespace mneme::ompl {

/// One call of a planner of OMPL: what PlannerRun is for mneme's own. Not thread-safe. OMPL may
/// throw from each of its functions.
class OmplRun {
 public:
  /// Refers to its arguments except the allocator; the query is sound.
  OmplRun(const Problem& problem, const CollisionChecker& checker, const SolveSettings& settings,
          const OmplSettings& ompl, const OmplPlanner& planner,
          const ::ompl::base::StateSamplerAllocator& allocator);

  /// Plans until the limits are reached, of which `spent_s` seconds are gone.
  /// Errors: experience that cannot be read.
  [[nodiscard]] Result<PlanResult> plan(double spent_s);

 private:
  void set_up_information(const ::ompl::base::StateSamplerAllocator& allocator);
  void define_problem();
  [[nodiscard]] Result<::ompl::base::PlannerPtr> make_planner() const;
  [[nodiscard]] ::ompl::base::PlannerTerminationCondition limits() const;
  [[nodiscard]] bool is_full() const;
  /// The time is up, or the run is cancelled.
  [[nodiscard]] bool is_over() const;
  [[nodiscard]] Path solution() const;
  [[nodiscard]] bool is_free(const Path& path);
  void simplify();
  void explain_failure();

  const Problem& problem_;
  const CollisionChecker& checker_;
  const SolveSettings& settings_;
  const OmplSettings& ompl_;
  const OmplPlanner& planner_;
  internal::MotionVerifier verifier_;
  std::shared_ptr<WorkCounters> counters_ = std::make_shared<WorkCounters>();
  std::shared_ptr<::ompl::base::SpaceInformation> information_;
  ::ompl::base::ProblemDefinitionPtr definition_;
  internal::Stopwatch stopwatch_;
  double timeout_s_ = 0;  ///< on the stopwatch
  CheckCounters checks_;  ///< of simplification and verification
  /// Planners free what they worked with when they end, and may ask from several threads.
  mutable std::atomic<bool> was_full_{false};
  int refused_path_count_ = 0;
  PlanResult result_;
};

}  // namespace mneme::ompl
