// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The memory for planners of OMPL, and planners of OMPL for mneme's problems (library
/// mneme::ompl). This header includes OMPL's headers: compile files that include it without -march.
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

/// The joint space of a robot's planning group. States are RealVectorStateSpace::StateType with one
/// value per joint in group order. Distances are those of Robot::distance. Continuous joints are in
/// [-pi, pi) and take the shorter direction. OMPL's own motion validator checks states a hundredth
/// of the extent apart; make_space_information() replaces it.
class JointStateSpace final : public ::ompl::base::RealVectorStateSpace {
 public:
  explicit JointStateSpace(const Robot& robot);

  [[nodiscard]] const Robot& robot() const { return robot_; }
  /// Number of allocated states. May be read while planners run.
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

/// Work of OMPL planners. May be read while they run.
struct WorkCounters {
  std::atomic<std::uint64_t> states{0};
  std::atomic<std::uint64_t> motions{0};
  std::atomic<std::uint64_t> samples{0};  ///< samples from samplers with counters
};

/// A space information, set up, for `checker.robot()` in `checker.scene()`. Kernels check motions
/// at the checker's resolution and ignore setStateValidityCheckingResolution(), which is set to the
/// same resolution for OMPL's own checks. The clearance of a state is its distance to obstacles, at
/// most 1 m, to within 1 mm. Thread-safe.
[[nodiscard]] std::shared_ptr<::ompl::base::SpaceInformation> make_space_information(
    const CollisionChecker& checker, std::shared_ptr<WorkCounters> counters = nullptr);

/// The checkers of make_space_information(), for programs with a state space of their own. States
/// must have one real per joint in group order (StateSpace::copyToReals).
[[nodiscard]] ::ompl::base::StateValidityCheckerPtr make_state_validity(
    const ::ompl::base::SpaceInformationPtr& information, const CollisionChecker& checker,
    std::shared_ptr<WorkCounters> counters = nullptr);
[[nodiscard]] ::ompl::base::MotionValidatorPtr make_motion_validity(
    const ::ompl::base::SpaceInformationPtr& information, const CollisionChecker& checker,
    std::shared_ptr<WorkCounters> counters = nullptr, const MotionDetail& detail = {});

/// An allocator for StateSpace::setStateSamplerAllocator. sampleUniform() takes samples of
/// `sampler`; sampleUniformNear() and sampleGaussian() are the space's own. The n-th state sampler
/// uses the seed derive_seed(seed, n). States must have one real per joint of the sampler's robot
/// in group order.
[[nodiscard]] ::ompl::base::StateSamplerAllocator sampler_allocator(
    std::shared_ptr<const Sampler> sampler, std::uint64_t seed = 1);

/// Algorithms 1 and 2 for StateSpace::setStateSamplerAllocator: samples come with probability
/// lambda from the experience in `database` for the problem, otherwise they are uniform. Kinds of
/// memory that use only the scene need no start and goals. Errors: those of make_sampler().
[[nodiscard]] Result<::ompl::base::StateSamplerAllocator> gl_sampler_allocator(
    const Problem& problem, Database& database, const SolveSettings& settings = {});

/// An objective like ompl::base::PathLengthOptimizationObjective, for planners with an informed
/// sampler (BIT*, Informed RRT*). Its informed sampler takes samples of the space's allocator and
/// rejects states that cannot shorten the path. OMPL's own informed sampler ignores the allocator
/// and does not wrap continuous joints.
[[nodiscard]] ::ompl::base::OptimizationObjectivePtr make_path_length_objective(
    const ::ompl::base::SpaceInformationPtr& information);

/// Converts paths to and from OMPL. States must have one real per joint in group order. Joints of
/// the results are normalized (Robot::normalized).
[[nodiscard]] ::ompl::geometric::PathGeometric to_ompl(
    const Path& path, const ::ompl::base::SpaceInformationPtr& information);
[[nodiscard]] Path from_ompl(const ::ompl::geometric::PathGeometric& path, const Robot& robot);

}  // namespace mneme::ompl

namespace mneme {

/// Adds OMPL's planners to planners(), such as "ompl:RRTConnect", and OMPL's samplers of valid
/// states to samplers(). Call it before planning.
///
/// Planners stop at their first path. If that path fails verification, they plan again within the
/// limits, with every motion verified as in final paths. PlanSettings::ompl_defaults selects OMPL's
/// own parameters. `max_nodes` limits the number of OMPL's states. Results count samples as
/// iterations, and no nodes. Runs are deterministic one at a time, unless the planner has threads
/// (PRM): parallel runs share OMPL's seeds. OMPL's log is off during runs.
void add_ompl_planners();

}  // namespace mneme
