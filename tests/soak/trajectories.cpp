// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Trajectories of random paths, or along the paths of given problems, checked by other code.
/// Succeeds if nothing was wrong with any of them.
#include "mneme/benchmark.h"
#include "mneme/pipeline.h"

#include "soak/measures.h"
#include "trajectory/dense_profile.h"
#include "trajectory/empty_scene.h"
#include "trajectory/trajectory_flaws.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme::soak {
namespace {

struct Options {
  std::vector<std::string> robots = {"planar8", "fetch", "panda", "ur5"};
  int paths = 1000;
  std::uint64_t seed = 1;
  std::vector<std::string> problems;
  ProblemOptions robot;  ///< of the problems
  double most_slower = 1.05;
  double jerk = 0;
  double acceleration = 1;        ///< of the problems' joints without a limit
  std::string name = "problems";  ///< of the printed line
  std::string part;               ///< of the problems, as "1/2"
  int seeds = 1;                  ///< plans of each problem
  bool is_by_length = false;
  bool is_without_obstacles = false;  ///< but of the problems that are solved with them
  double improve = 0;
  int rounds = TrajectorySettings().time_rounds;

  /// Brute force knows no jerk.
  [[nodiscard]] double most_slower_than_brute_force() const { return jerk > 0 ? 0 : most_slower; }
};

/// Outcomes of many trajectories.
struct Tally {
  std::vector<double> total_times_s;  ///< of planning and timing, by the clock
  std::vector<double> ratios;         ///< of the durations to those that brute force finds
  std::vector<double> times_s;        ///< of the processor, corners and their verification included
  std::vector<double> durations_s;
  int flawed = 0;
};

void note_flaw(Tally& tally, const std::string& name, const std::string& flaw) {
  ++tally.flawed;
  fmt::print("  WRONG: {}: {}\n", name, flaw);
}

/// Times the path, and looks at what came out. Brute force is asked unless `most_slower` is 0.
std::optional<Trajectory> time_path(const Robot& robot, const Path& path, const RateLimits& limits,
                                    const TrajectorySettings& settings,
                                    const MotionVerifier& verifier, double most_slower,
                                    const std::string& name, Tally& tally) {
  constexpr int kBruteForce = 1000;
  const double begin_s = cpu_time_s();
  const auto motion = parameterize(robot, path, limits, settings, &verifier);
  tally.times_s.push_back(cpu_time_s() - begin_s);
  if (!motion) {
    note_flaw(tally, name, motion.error().message);
    return std::nullopt;
  }
  tally.durations_s.push_back(motion->duration_s());
  if (auto flaw = test::trajectory_flaw(robot, path, limits, settings.path_tolerance, *motion)) {
    note_flaw(tally, name, *flaw);
  }
  if (most_slower > 0 && motion->duration_s() > 0) {
    const auto rounded = internal::round_corners(robot, path, settings.path_tolerance, &verifier);
    const double ratio = motion->duration_s() / test::dense_duration(rounded, limits, kBruteForce);
    tally.ratios.push_back(ratio);
    if (ratio > most_slower) note_flaw(tally, name, fmt::format("slower by {}", ratio));
  }
  return *motion;
}

void print_head() {
  fmt::print("{:16} {:>6} {:>6} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8} {:>10} {:>8} {:>8}\n", "",
             "paths", "wrong", "s, p50", "s, mean", "s, p98", "us, p50", "us, p95", "us, p99",
             "total, p50", "slower", "compared");
}

void print_tally(const std::string& name, const Tally& tally) {
  const auto time_us = [&](double share) { return 1e6 * quantile(tally.times_s, share); };
  const auto& durations_s = tally.durations_s;
  const double mean_s = std::accumulate(durations_s.begin(), durations_s.end(), 0.0) /
                        static_cast<double>(std::max<std::size_t>(durations_s.size(), 1));
  fmt::print(
      "{:16} {:6} {:6} {:7.3f} {:7.3f} {:7.3f} {:8.1f} {:8.1f} {:8.1f} {:10.1f} {:8.4f} {:8}\n",
      name, tally.times_s.size(), tally.flawed, quantile(tally.durations_s, 0.5), mean_s,
      quantile(tally.durations_s, 0.98), time_us(0.5), time_us(0.95), time_us(0.99),
      1e6 * quantile(tally.total_times_s, 0.5), quantile(tally.ratios, 1), tally.ratios.size());
  std::fflush(stdout);
}

/// Random paths of a robot alone, with limits and tolerances of all sizes.
Tally time_random_paths(const Robot& robot, const Options& options) {
  constexpr int kComparedOnceIn = 20;
  const test::EmptyScene empty(robot);
  Tally tally;
  for (int i = 0; i < options.paths; ++i) {
    Rng rng(derive_seed(options.seed, static_cast<std::uint64_t>(i)));
    const Path path = test::random_path(robot, rng);
    const RateLimits limits =
        options.jerk > 0 ? test::random_jerk_limits(robot, rng) : test::random_limits(robot, rng);
    TrajectorySettings settings;
    settings.path_tolerance = std::pow(10, rng.uniform(-4, 0));
    settings.time_rounds = options.rounds;
    time_path(robot, path, limits, settings, empty.verifier(),
              i % kComparedOnceIn == 0 ? options.most_slower_than_brute_force() : 0,
              fmt::format("{} {}", robot.name(), i), tally);
  }
  return tally;
}

/// The first contact of a motion: by the kernels at states as close as those of verification, and
/// in double precision by other code at states as close as those of planning.
std::optional<std::string> find_contact(const CollisionChecker& checker, const Trajectory& motion) {
  constexpr double kAccuracy = 1e-5;  // of the kernels, metres
  const double step = checker.resolution() / kVerificationRefinement;
  double travelled = checker.resolution(), dt = 0;
  for (double time_s = 0; time_s < motion.duration_s(); time_s += dt) {
    const Trajectory::Point point = motion.at(time_s);
    const double speed = std::sqrt(std::inner_product(point.velocity.begin(), point.velocity.end(),
                                                      point.velocity.begin(), 0.0));
    dt = std::clamp(step / std::max(speed, 1e-6), 1e-4, 2e-2);
    travelled += dt * speed;
    if (!checker.is_valid(std::span<const double>(point.position))) {
      return fmt::format("contact at {} s", time_s);
    }
    if (travelled < checker.resolution()) continue;
    travelled = 0;
    for (const Contact& contact : checker.contacts(point.position)) {
      if (contact.distance > -kAccuracy) continue;
      return fmt::format("at {} s {} touches {} by {}", time_s, contact.link, contact.other,
                         contact.distance);
    }
  }
  return std::nullopt;
}

/// Plans with uniform samples, and follows what is found.
Result<void> time_problem(const Problem& problem, std::uint64_t seed, const Options& options,
                          Tally& tally) {
  TrajectorySettings timing;
  timing.acceleration_limit = options.acceleration;
  timing.time_rounds = options.rounds;
  if (options.jerk > 0) timing.jerk_limit = options.jerk;
  const auto limits = find_rate_limits(problem.robot, timing);
  if (!limits) return tl::unexpected(limits.error());
  SolveSettings settings;
  settings.sampler = "uniform";
  settings.plan.seed = seed;
  settings.plan.limits = std::make_shared<const RateLimits>(*limits);
  if (options.is_by_length) settings.plan.minimize_time = false;
  settings.plan.improve = options.improve;
  const auto result = solve(problem, nullptr, settings);
  if (!result) return tl::unexpected(result.error());
  if (!result->plan.is_solved()) return {};
  if (options.is_without_obstacles && !problem.scene.obstacles.empty()) {
    Problem alone = problem;
    alone.scene.obstacles.clear();
    return time_problem(alone, seed, options, tally);
  }
  const auto checker = CollisionChecker::make(problem.robot, problem.scene);
  if (!checker) return tl::unexpected(checker.error());
  const MotionVerifier verifier(*checker);
  const auto motion = time_path(problem.robot, result->plan.path, *limits, timing, verifier,
                                options.most_slower_than_brute_force(), problem.name, tally);
  if (!motion) return {};
  const double preparation_s = result->preparation_time_s;
  tally.total_times_s.push_back(result->total_time_s - preparation_s + tally.times_s.back());
  if (auto contact = find_contact(*checker, *motion)) note_flaw(tally, problem.name, *contact);
  return {};
}

Result<void> time_problems(const std::string& where, const Options& options, Tally& tally) {
  const auto inputs = find_bench_problems({where}, options.part);
  if (!inputs) return tl::unexpected(inputs.error());
  const auto loaded = load_bench_problems(*inputs, options.robot, [](const auto&) {});
  if (!loaded) return tl::unexpected(loaded.error());
  for (const LoadedProblem& problem : *loaded) {
    for (int i = 0; i < options.seeds; ++i) {
      const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(i);
      if (auto done = time_problem(problem.problem, seed, options, tally); !done) return done;
    }
  }
  return {};
}

bool run(const Options& options) {
  bool has_passed = true;
  const auto fail_with = [&](const Error& error) {
    fmt::print(stderr, "soak_trajectories: {}\n", error.message);
    has_passed = false;
  };
  print_head();
  if (!options.problems.empty()) {
    Tally tally;
    for (const std::string& where : options.problems) {
      if (auto done = time_problems(where, options, tally); !done) fail_with(done.error());
    }
    print_tally(options.name, tally);
    return has_passed && tally.flawed == 0;
  }
  for (const std::string& name : options.robots) {
    const auto robot =
        find_robot(name).and_then([](const std::string& path) { return load_robot(path); });
    if (!robot) {
      fail_with(robot.error());
      continue;
    }
    const Tally tally = time_random_paths(*robot, options);
    print_tally(name, tally);
    has_passed = has_passed && tally.flawed == 0;
  }
  return has_passed;
}

}  // namespace
}  // namespace mneme::soak

int main(int argc, char** argv) {
  mneme::soak::Options options;
  CLI::App app("Times random paths, or the paths of problems, and looks at the trajectories.");
  app.add_option("--robots", options.robots, "names of robots")->delimiter(',');
  app.add_option("--paths", options.paths, "random paths for each robot")
      ->check(CLI::Range(1, 100000000));
  app.add_option("--seed", options.seed, "seed of everything");
  app.add_option("--problems", options.problems,
                 "what mneme bench run takes, to be planned and timed");
  app.add_option("--robot", options.robot.robot_path, "URDF of the problems");
  app.add_option("--srdf", options.robot.robot.srdf_path, "its SRDF");
  app.add_option("--most-slower", options.most_slower,
                 "greatest duration, as a multiple of what brute force finds");
  app.add_option("--jerk", options.jerk,
                 "limit of jerk of the problems' joints; random paths have random ones");
  app.add_option("--acceleration", options.acceleration,
                 "limit of acceleration of the problems' joints without one");
  app.add_option("--name", options.name, "name of the line of problems");
  app.add_option("--part", options.part, "part of the problems, as 2/2");
  app.add_option("--seeds", options.seeds, "plans of each problem")->check(CLI::Range(1, 1000));
  app.add_flag("--by-length", options.is_by_length, "shorten paths by length instead of time");
  app.add_flag("--without-obstacles", options.is_without_obstacles,
               "follow the paths that are found once the obstacles are gone");
  app.add_option("--improve", options.improve, "seconds to improve the paths of problems");
  app.add_option("--rounds", options.rounds, "rounds in which trajectories leave their path");
  for (CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 1) option->take_last();
  }
  CLI11_PARSE(app, argc, argv);
  return mneme::soak::run(options) ? 0 : 1;
}
