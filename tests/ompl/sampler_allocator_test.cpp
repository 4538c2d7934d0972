// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/learned_scene.h"
#include "ompl/planner_table.h"
#include "ompl/small_problems.h"
#include "pipeline/memory_steps.h"

#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/geometric/planners/prm/LazyPRM.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>

namespace mneme::test {
namespace {

constexpr double kPatience = 10;  // seconds; only a planner that never draws takes them

/// Draws, 20 of them wanted, of a planner that cannot solve its problem.
template <class Planner>
int count_draws() {
  const Problem problem = locked_problem();
  const auto sampler = std::make_shared<ConstantSampler>(std::vector<float>{-3.1f, 0.2f});
  const auto information = mneme::ompl::make_space_information(checker_of(problem));
  information->getStateSpace()->setStateSamplerAllocator(mneme::ompl::sampler_allocator(sampler));
  const auto definition = std::make_shared<ob::ProblemDefinition>(information);
  definition->setStartAndGoalStates(state_of(information, problem.start),
                                    state_of(information, problem.goals[0]));
  Planner planner(information);
  planner.setProblemDefinition(definition);
  planner.setup();
  const Stopwatch stopwatch;
  planner.solve(ob::PlannerTerminationCondition(
      [&] { return sampler->drawn() >= 20 || stopwatch.elapsed_s() > kPatience; }));
  return sampler->drawn();
}

/// How many of `count` draws lie within `radius` (L2) of a mean of the mixture.
int count_near(const Robot& robot, const GaussianMixture& mixture, ob::StateSampler& sampler,
               const ob::SpaceInformationPtr& information, int count, double radius) {
  ob::ScopedState<> state(information);
  int near = 0;
  for (int i = 0; i < count; ++i) {
    sampler.sampleUniform(state.get());
    const Configuration q = values_of(state.get(), robot.joint_count());
    for (int c = 0; c < mixture.component_count(); ++c) {
      if (robot.distance(q, mean_of(mixture, c)) < radius) {
        ++near;
        break;
      }
    }
  }
  return near;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a sampler's configurations become states of a vector space and of a compound space") {
    const auto sampler = std::make_shared<ConstantSampler>(std::vector<float>{0.5f, 1.0f, -1.0f});
    const auto rest = std::make_shared<ob::RealVectorStateSpace>(2);
    rest->setBounds(-kPi, kPi);
    for (const ob::StateSpacePtr& space :
         {std::static_pointer_cast<ob::StateSpace>(
              std::make_shared<mneme::ompl::JointStateSpace>(gap_problem().robot)),
          std::make_shared<ob::SO2StateSpace>() + rest}) {
      space->setup();
      space->setStateSamplerAllocator(mneme::ompl::sampler_allocator(sampler));
      ob::ScopedState<> state(space);
      space->allocStateSampler()->sampleUniform(state.get());
      CHECK(state.reals() == std::vector<double>{0.5, 1, -1});
    }
  }

  TEST_CASE("each state sampler has a stream of its own, the same for the same seed") {
    const Robot robot = planar8();
    const auto space = std::make_shared<mneme::ompl::JointStateSpace>(robot);
    space->setup();
    const std::shared_ptr<const Sampler> uniform = make_uniform_sampler(robot);
    const auto draw = [&](const ob::StateSamplerPtr& sampler) {
      ob::ScopedState<> state(space);
      sampler->sampleUniform(state.get());
      return state.reals();
    };
    const auto allocator = mneme::ompl::sampler_allocator(uniform, 5);
    const auto first = draw(allocator(space.get())), second = draw(allocator(space.get()));
    CHECK(first != second);
    CHECK(draw(mneme::ompl::sampler_allocator(uniform, 5)(space.get())) == first);
    CHECK(draw(mneme::ompl::sampler_allocator(uniform, 6)(space.get())) != first);
  }

  TEST_CASE("samples near a state are the space's") {
    const Robot robot = planar8();
    const auto space = std::make_shared<mneme::ompl::JointStateSpace>(robot);
    space->setup();
    const auto sampler = std::make_shared<ConstantSampler>(std::vector<float>(8, 3.0f));
    const auto states = mneme::ompl::sampler_allocator(sampler)(space.get());
    ob::ScopedState<> near(space), state(space);
    near = Configuration(8, 0.5);
    states->sampleUniformNear(state.get(), near.get(), 0.1);
    CHECK(space->distance(near.get(), state.get()) <= 0.1 * std::sqrt(8.0));
    states->sampleGaussian(state.get(), near.get(), 1e-6);
    CHECK(space->distance(near.get(), state.get()) < 1e-4);
    CHECK(sampler->drawn() == 0);
  }

  TEST_CASE("memory answers a fraction lambda of the draws") {
    LearnedScene world;
    SolveSettings settings;
    settings.drop_invalid_means = false;
    const auto gl = require(recall(world.problem, world.database, settings));
    const auto information = mneme::ompl::make_space_information(checker_of(world.problem));
    for (const double lambda : {0.0, 0.5, 1.0}) {
      settings.lambda = lambda;
      const auto allocator =
          mneme::ompl::gl_sampler_allocator(world.problem, world.database, settings);
      REQUIRE(allocator.has_value());
      const auto sampler = (*allocator)(information->getStateSpace().get());
      // Sigma is 0.05 for each of eight joints; uniform samples are several radians away.
      const int near =
          count_near(world.problem.robot, *gl.mixture, *sampler, information, 400, 0.4);
      CHECK(std::abs(near - 400 * lambda) <= 50);
    }
  }

  TEST_CASE("states before memory is asked are uniform") {
    LearnedScene world;
    SolveSettings settings;
    settings.lambda = 1;
    settings.retrieve_after = 100;
    settings.drop_invalid_means = false;
    const auto gl = recall(world.problem, world.database, settings);
    const Problem scene_alone{.robot = world.problem.robot, .scene = world.problem.scene};
    const auto allocator =
        require(mneme::ompl::gl_sampler_allocator(scene_alone, world.database, settings));
    const auto information = mneme::ompl::make_space_information(checker_of(world.problem));
    const auto sampler = allocator(information->getStateSpace().get());
    const auto near = [&] {
      return count_near(world.problem.robot, *gl->mixture, *sampler, information, 100, 0.4);
    };
    CHECK(near() <= 5);
    CHECK(near() >= 80);
  }

  TEST_CASE("remembered means that come closer than the margin are not drawn around") {
    LearnedScene world;
    const Robot& robot = world.problem.robot;
    const auto gl = require(recall(world.problem, world.database));
    SolveSettings settings;
    settings.lambda = 1;
    settings.sigma = 1e-4;
    settings.margin = 0.01;
    const auto careful =
        require(CollisionChecker::make(robot, world.problem.scene, {{}, settings.margin}));
    const GaussianMixture kept = internal::keep_valid_components(careful, *gl.mixture);
    const GaussianMixture free =
        internal::keep_valid_components(checker_of(world.problem), *gl.mixture);
    REQUIRE(kept.component_count() < free.component_count());
    const auto information = mneme::ompl::make_space_information(careful);
    const auto count_near_kept = [&] {
      const auto allocator =
          mneme::ompl::gl_sampler_allocator(world.problem, world.database, settings);
      REQUIRE(allocator.has_value());
      const auto sampler = (*allocator)(information->getStateSpace().get());
      return count_near(robot, kept, *sampler, information, 200, 0.01);
    };
    CHECK(count_near_kept() == 200);
    settings.margin = 0;
    CHECK(count_near_kept() < 200);
  }

  TEST_CASE("a database of another robot is refused") {
    LearnedScene world;
    const Problem other{.robot = planar_arm({1, 1}),
                        .scene = make_circle_scene("", {{1.5, 0.75, 0.35}})};
    const Error error = require_error(mneme::ompl::gl_sampler_allocator(other, world.database));
    CHECK(error.code == ErrorCode::wrong_robot);
  }
}

TEST_SUITE("flow") {
  TEST_CASE("RRT, RRTConnect, PRM, LazyPRM and RRT* draw from the sampler") {
    const mneme::ompl::Silence silence;
    CHECK(count_draws<og::RRT>() >= 20);
    CHECK(count_draws<og::RRTConnect>() >= 20);
    CHECK(count_draws<og::PRM>() >= 20);
    CHECK(count_draws<og::LazyPRM>() >= 20);
    CHECK(count_draws<og::RRTstar>() >= 20);
  }
}

}  // namespace mneme::test
