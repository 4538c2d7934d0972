// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The memory for planners of OMPL, and planners of OMPL for mneme's problems. A library of its
/// own, mneme::ompl. This header includes OMPL's: compile what includes it without -march.
#pragma once

#include "mneme/pipeline.h"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/OptimizationObjective.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSampler.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::ompl {

/// The joint space of a robot's planning group: states are RealVectorStateSpace::StateType with one
/// value per joint in group order. Distances are those of Robot::distance; continuous joints lie in
/// [-pi, pi) and take the shorter way round. States of motions that OMPL itself checks are a
/// hundredth of the extent apart, unless make_space_information sets up the space.
class JointStateSpace final : public ::ompl::base::RealVectorStateSpace {
 public:
  explicit JointStateSpace(const Robot& robot);

  [[nodiscard]] const Robot& robot() const { return robot_; }
  /// States that are allocated and not yet freed. May be read while planners run.
  [[nodiscard]] std::uint64_t state_count() const {
    return state_count_.load(std::memory_order_relaxed);
  }

  [[nodiscard]] ::ompl::base::State* allocState() const override;
  void freeState(::ompl::base::State* state) const override;
  [[nodiscard]] double getMaximumExtent() const override;
  [[nodiscard]] double distance(const ::ompl::base::State* a,
                                const ::ompl::base::State* b) const override;
  void interpolate(const ::ompl::base::State* from, const ::ompl::base::State* to, double t,
                   ::ompl::base::State* state) const override;
  void enforceBounds(::ompl::base::State* state) const override;
  [[nodiscard]] bool equalStates(const ::ompl::base::State* a,
                                 const ::ompl::base::State* b) const override;
  [[nodiscard]] ::ompl::base::StateSamplerPtr allocDefaultStateSampler() const override;
  void registerProjections() override;

 private:
  Robot robot_;
  std::vector<char> is_continuous_;  ///< per joint
  mutable std::atomic<std::uint64_t> state_count_{0};
};

/// Work that planners of OMPL asked for. May be read while they run.
struct WorkCounters {
  std::atomic<std::uint64_t> states{0};
  std::atomic<std::uint64_t> motions{0};
  std::atomic<std::uint64_t> samples{0};  ///< drawn from samplers that were made to count them
};

/// Space, validity of states and validity of motions of `checker.robot()` in `checker.scene()`, set
/// up. Motions are checked on the kernels at the checker's resolution, whatever
/// setStateValidityCheckingResolution says; that is set to the same resolution for the parts of
/// OMPL that look at states themselves. Clearance, which some samplers of OMPL ask for, is the
/// distance to the obstacles, at most 1 m, within 1 mm. May be used by several threads.
[[nodiscard]] std::shared_ptr<::ompl::base::SpaceInformation> make_space_information(
    const CollisionChecker& checker, std::shared_ptr<WorkCounters> counters = nullptr);

/// The two halves of make_space_information, for a program that has its own space: states of
/// `information` must have one real per joint in group order (StateSpace::copyToReals).
[[nodiscard]] ::ompl::base::StateValidityCheckerPtr make_state_validity(
    const ::ompl::base::SpaceInformationPtr& information, const CollisionChecker& checker,
    std::shared_ptr<WorkCounters> counters = nullptr);
[[nodiscard]] ::ompl::base::MotionValidatorPtr make_motion_validity(
    const ::ompl::base::SpaceInformationPtr& information, const CollisionChecker& checker,
    std::shared_ptr<WorkCounters> counters = nullptr, const MotionDetail& detail = {});

/// For StateSpace::setStateSamplerAllocator: sampleUniform draws from `sampler`; sampleUniformNear
/// and sampleGaussian are those of the space. The n-th state sampler that is allocated draws from
/// the stream of derive_seed(seed, n). States of the space must have one real per joint of the
/// sampler's robot, in group order.
[[nodiscard]] ::ompl::base::StateSamplerAllocator sampler_allocator(
    std::shared_ptr<const Sampler> sampler, std::uint64_t seed = 1);

/// Algorithms 1 and 2 for StateSpace::setStateSamplerAllocator: with probability lambda a state is
/// drawn from what `database` knows of the problem, otherwise uniformly; see make_sampler(). A
/// problem without start and goals will do for kinds of memory that know scenes only. Errors: those
/// of make_sampler().
[[nodiscard]] Result<::ompl::base::StateSamplerAllocator> gl_sampler_allocator(
    const Problem& problem, Database& database, const SolveSettings& settings = {});

/// Length of the path, as ompl::base::PathLengthOptimizationObjective, for planners that sample
/// through an informed sampler (BIT*, Informed RRT*): theirs draws from the space's allocator and
/// keeps what can still shorten the path. OMPL's own ignores the allocator, and takes continuous
/// joints for straight.
[[nodiscard]] ::ompl::base::OptimizationObjectivePtr make_path_length_objective(
    const ::ompl::base::SpaceInformationPtr& information);

/// Paths to and from OMPL. States of the information's space have one real per joint, in group
/// order. Joints of the results are normalized (Robot::normalized).
[[nodiscard]] ::ompl::geometric::PathGeometric to_ompl(
    const Path& path, const ::ompl::base::SpaceInformationPtr& information);
[[nodiscard]] Path from_ompl(const ::ompl::geometric::PathGeometric& path, const Robot& robot);

}  // namespace mneme::ompl

namespace mneme {

/// Adds OMPL's planners to planners(), as "ompl:RRTConnect" and so on, and its samplers of valid
/// states to samplers(); call it before planning. Of the planners' runs:
/// PlanSettings::ompl_defaults says how they are set up; they stop at the first path, and one that
/// fails verification is planned again within the limits, with every motion verified as paths are;
/// `max_nodes` limits the states that OMPL holds. In the result, iterations are samples drawn, and
/// nodes are not counted. One run at a time repeats itself for equal seeds, as far as the planner
/// does (PRM starts a thread); runs in parallel threads of one process share OMPL's source of
/// seeds. OMPL's log is silent meanwhile.
void add_ompl_planners();

}  // namespace mneme
