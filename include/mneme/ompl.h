// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The memory for planners of OMPL, and planners of OMPL for mneme's problems. A library of its
/// own, mneme::ompl. This header includes OMPL's: compile what includes it without -march.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/OptimizationObjective.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSampler.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>

#include "mneme/pipeline.h"

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

/// Algorithms 1 and 2 for StateSpace::setStateSamplerAllocator: with probability
/// `settings.lambda` a state is drawn from what `database` knows of the scene, otherwise uniformly.
/// Memory is asked now; the first `settings.retrieve_after` states are uniform nevertheless.
/// Errors: those of create_gl_sampler and CollisionChecker::make.
[[nodiscard]] Result<::ompl::base::StateSamplerAllocator> gl_sampler_allocator(
    const Robot& robot, const Scene& scene, Database& database, const SolveSettings& settings = {});

/// The same for a problem: a memory of whole paths needs its start and goals.
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

struct OmplSettings {
  /// OMPL's defaults: range of a fifth of the extent, motions checked state by state at a hundredth
  /// of the extent, path returned without verification or repair, and not remembered. Planners may
  /// then tunnel through obstacles: check the path (is_path_free). Otherwise tuned: range 0.4 rad,
  /// motions on the kernels at mneme's resolution, paths verified; one that fails is planned again
  /// within the limits, with every motion verified as paths are. A range or resolution
  /// above 0 in the settings counts in both.
  bool as_in_paper = false;
  /// What train_ompl_experience wrote, for Lightning and Thunder; without it they know nothing.
  std::string experience_path;
};

/// Plans as solve() does, with a planner of OMPL. `settings.planner` is one of
/// ompl_planner_names(), with or without "ompl:" before it. `settings.sampler` is one of
/// sampler_names(), or, for planners that draw valid states (PRM), one of ompl_sampler_names().
/// Stops at the first path. `plan.max_nodes` limits the states that OMPL holds. In the result,
/// iterations are samples drawn, nodes are not counted; with `plan.simplify` the path is shortened
/// as solve() does. One run at a time repeats itself for equal seeds, as far as the planner does
/// (PRM starts a thread); runs in parallel threads of one process share OMPL's source of seeds.
/// OMPL's log is silent meanwhile. Errors: those of solve().
[[nodiscard]] Result<SolveResult> solve_with_ompl(const Problem& problem, Database* database,
                                                  const SolveSettings& settings,
                                                  const OmplSettings& ompl = {});

/// "RRTConnect", "PRM", "BKPIECE1" and so on.
[[nodiscard]] std::span<const std::string_view> ompl_planner_names();
/// Samplers of valid states: "gaussian", "obstacle_based", "bridge_test", "max_clearance".
[[nodiscard]] std::span<const std::string_view> ompl_sampler_names();

/// Writes the experience of "Lightning" or "Thunder" from solved paths of the robot, whatever scene
/// each was solved in. Errors: another planner; io.
[[nodiscard]] Result<void> train_ompl_experience(std::string_view planner, const Robot& robot,
                                                 std::span<const Path> paths,
                                                 const std::string& path);

}  // namespace mneme
