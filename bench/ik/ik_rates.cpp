// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_ik_rates: poses that random configurations have (fixed seeds), solved by mneme and, if it
// was found, KDL. With --problems FILES --robot F.urdf --link LINK also the poses of the problems'
// goals among their obstacles, alone and as goals of solve(). Processor time of one thread.
#include "mneme/mneme.h"

#include "micro/edges.h"

#ifdef MNEME_HAS_KDL
#include "support/kdl_chain.h"

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#endif

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace mneme::bench {
namespace {

double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Configuration random_configuration(const Robot& robot, Rng& rng) {
  Configuration q;
  for (int i = 0; i < robot.joint_count(); ++i) {
    q.push_back(rng.uniform(robot.group_joint(i).lower, robot.group_joint(i).upper));
  }
  return q;
}

PoseGoal pose_at(const Robot& robot, const std::string& link, const Configuration& q) {
  PoseGoal goal;
  goal.link = link;
  const auto found = std::ranges::find(robot.links(), link, &Link::name);
  goal.pose = robot.link_poses(q)[static_cast<std::size_t>(found - robot.links().begin())];
  return goal;
}

struct Pose {
  PoseGoal goal;
  Configuration near;
};

/// Times of runs, each successful or not.
class Times {
 public:
  void add(double seconds, bool is_solved) {
    seconds_.push_back(seconds);
    solved_ += is_solved;
  }
  [[nodiscard]] double quantile(double share) {
    std::ranges::sort(seconds_);
    return seconds_.empty() ? 0
                            : seconds_[static_cast<std::size_t>(
                                  share * static_cast<double>(seconds_.size() - 1))];
  }
  void print(const std::string& what) {
    double sum = 0;
    for (const double seconds : seconds_) sum += seconds;
    std::printf("%-34s %6d of %6zu  %9.0f solved/s  p50 %9.1f us  p95 %9.1f us  p99 %9.1f us\n",
                what.c_str(), solved_, seconds_.size(), solved_ / sum, 1e6 * quantile(0.5),
                1e6 * quantile(0.95), 1e6 * quantile(0.99));
  }

 private:
  std::vector<double> seconds_;
  int solved_ = 0;
};

/// `solve` says for a pose whether a configuration was found that has it.
void time_poses(const std::string& what, const Robot& robot, std::span<const Pose> poses,
                const std::function<Configuration(const Pose&)>& solve) {
  Times times;
  for (const Pose& pose : poses) {
    const double begin = processor_s();
    const Configuration q = solve(pose);
    const double end = processor_s();
    const bool is_solved = !q.empty() && !robot.describe_violation(q, "solution") &&
                           pose_error(robot, pose.goal, q).position <= 1e-4 &&
                           pose_error(robot, pose.goal, q).rotation <= 1e-3;
    times.add(end - begin, is_solved);
  }
  times.print(what);
}

#ifdef MNEME_HAS_KDL
/// Attempts with KDL's solvers, which start from one configuration: a random one after the first.
constexpr int kMostStarts = 100;

template <class Solver>
Configuration solve_with(Solver& solver, const test::KdlChain& kdl, const Robot& robot,
                         const Pose& pose) {
  Rng rng(1);
  KDL::JntArray from = kdl.to_kdl_joints(pose.near), out(kdl.lower.rows());
  for (int start = 0; start < kMostStarts; ++start) {
    if (solver.CartToJnt(from, test::to_kdl(pose.goal.pose), out) >= 0) {
      Configuration q = pose.near;
      for (unsigned i = 0; i < kdl.joints.size(); ++i) {
        const auto joint = static_cast<std::size_t>(kdl.joints[i]);
        q[joint] = out(i);
        const Joint& model = robot.group_joint(kdl.joints[i]);
        const double turn = 6.283185307179586;
        if (model.type != JointType::prismatic &&
            (q[joint] > model.upper || q[joint] < model.lower)) {
          q[joint] = std::remainder(q[joint], turn);
        }
      }
      if (!robot.describe_violation(q, "solution")) return q;
    }
    from = kdl.to_kdl_joints(random_configuration(robot, rng));
  }
  return {};
}

void time_kdl(const std::string& name, const Robot& robot, const std::string& link,
              std::span<const Pose> poses) {
  const test::KdlChain kdl(robot, link);
  // Its measure counts a radian as a hundredth of a metre.
  KDL::ChainIkSolverPos_LMA lma(kdl.chain, 1e-5, 200);
  time_poses(name + ", KDL LMA", robot, poses,
             [&](const Pose& pose) { return solve_with(lma, kdl, robot, pose); });
  KDL::ChainFkSolverPos_recursive forward(kdl.chain);
  KDL::ChainIkSolverVel_pinv velocity(kdl.chain);
  KDL::ChainIkSolverPos_NR_JL nr(kdl.chain, kdl.lower, kdl.upper, forward, velocity, 100, 1e-4);
  time_poses(name + ", KDL NR_JL", robot, poses,
             [&](const Pose& pose) { return solve_with(nr, kdl, robot, pose); });
}
#else
void time_kdl(const std::string& name, const Robot&, const std::string&, std::span<const Pose>) {
  std::printf("%s: KDL was not found when this was built (liborocos-kdl-dev)\n", name.c_str());
}
#endif

int time_robot(const std::string& name, const std::string& link, int count, int count_of_kdl) {
  const auto loaded = robot_file(name).and_then(
      [](const std::string& path) { return load_approximated_robot(path); });
  if (!loaded) {
    std::fprintf(stderr, "mneme_ik_rates: %s\n", loaded.error().message.c_str());
    return 1;
  }
  const Robot& robot = loaded->robot;
  const auto kinematics = InverseKinematics::make(robot, link);
  if (!kinematics) {
    std::fprintf(stderr, "mneme_ik_rates: %s\n", kinematics.error().message.c_str());
    return 1;
  }
  Rng rng(1);
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const Configuration q = random_configuration(robot, rng);
    poses.push_back({pose_at(robot, link, q), random_configuration(robot, rng)});
  }
  IkSettings settings;
  settings.solutions = 1;
  time_poses(name + ", mneme", robot, poses, [&](const Pose& pose) {
    const IkResult result = kinematics->solve(pose.goal, pose.near, settings);
    return result.solutions.empty() ? Configuration() : result.solutions.front();
  });
  const auto fewer =
      std::span(poses).first(static_cast<std::size_t>(std::min(count, count_of_kdl)));
  time_kdl(name, robot, link, fewer);
  return 0;
}

/// Iteration limit of solve(), so that the solved count does not depend on the machine's load.
constexpr std::uint64_t kMostIterations = 100000;

/// The goal's pose among the obstacles: inverse kinematics alone, and solve() to the pose and to
/// the configuration.
int time_problems(const std::vector<std::string>& where, const ProblemOptions& options,
                  const std::string& link, const IkSettings& ik) {
  const auto problems = load_problems(where, options);
  if (!problems) {
    std::fprintf(stderr, "mneme_ik_rates: %s\n", problems.error().message.c_str());
    return 1;
  }
  Times alone, within_1ms, to_pose, to_joints;
  for (const Problem& problem : *problems) {
    const auto checker = CollisionChecker::make(problem.robot, problem.scene);
    if (!checker) continue;
    PlanQuery ends{problem.start, problem.goals};
    if (refuse_query(*checker, ends)) continue;
    Problem posed = problem;
    posed.pose_goals = {pose_at(problem.robot, link, problem.goals.front())};
    posed.goals.clear();
    auto source = PoseGoalSource::make(*checker, posed.pose_goals, problem.start, ik, 1e-4);
    if (!source) continue;
    const double begin = processor_s();
    const bool is_found = !source->more().empty();
    const double seconds = processor_s() - begin;
    alone.add(seconds, is_found);
    within_1ms.add(seconds, is_found && seconds <= 1e-3);
    SolveSettings settings;
    settings.sampler = "uniform";
    settings.ik = ik;
    settings.plan.timeout_s = 60;
    settings.plan.max_iterations = kMostIterations;
    settings.plan.simplify = false;
    for (auto& [asked, times] : {std::pair<const Problem&, Times&>(posed, to_pose),
                                 std::pair<const Problem&, Times&>(problem, to_joints)}) {
      const double from = processor_s();
      const auto result = solve(asked, nullptr, settings);
      times.add(processor_s() - from, result && result->plan.is_solved());
    }
  }
  alone.print("goal poses in their scenes");
  within_1ms.print("the same, within 1 ms");
  to_pose.print("solve() to the pose");
  to_joints.print("solve() to the configuration");
  return 0;
}

}  // namespace
}  // namespace mneme::bench

int main(int argc, char** argv) {
  int count = 10000, count_of_kdl = 1000;
  std::vector<std::string> problems;
  std::string link = "tool0";
  mneme::ProblemOptions options;
  mneme::IkSettings ik;
  CLI::App app{"Rates of inverse kinematics"};
  app.add_option("--poses", count, "poses of each robot");
  app.add_option("--kdl-poses", count_of_kdl, "of these, the first that KDL solves, too");
  app.add_option("--problems", problems, "problem files, or directories of compact ones");
  app.add_option("--robot", options.robot_path, "URDF of the problems");
  app.add_option("--srdf", options.robot.srdf_path, "SRDF of the problems' robot");
  app.add_option("--link", link, "the link whose pose at the goals is asked for");
  app.add_option("--ik-solutions", ik.solutions, "of problems: solutions to begin with");
  CLI11_PARSE(app, argc, argv);
  if (!problems.empty()) return mneme::bench::time_problems(problems, options, link, ik);
  int failures = 0;
  for (const auto& [robot, tip] : {std::pair("panda", "panda_hand"),
                                   std::pair("fetch", "gripper_link"), std::pair("ur5", "tool0")}) {
    failures += mneme::bench::time_robot(robot, tip, count, count_of_kdl);
  }
  return failures;
}
