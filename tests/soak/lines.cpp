// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random lines in the scenes of problems. Checks every path independently, and searches the lines
/// that are not possible as a whole exhaustively. Succeeds if no path is wrong.
#include "mneme/benchmark.h"
#include "mneme/line.h"

#include "line/line_oracle.h"
#include "soak/measures.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace mneme::soak {
namespace {

struct Options {
  std::vector<std::string> problems;
  int lines = 1000;
  int states = 100;  ///< checked per motion
  std::uint64_t seed = 1;
  double oracle_step = 0.001, oracle_cell = 0.1;
  int most_searched = 100;  ///< lines that the oracle searches
  bool is_verbose = false, is_confirming = false;
  LineSettings line;
};

struct Tally {
  int lines = 0, whole = 0, searched = 0, missed = 0, wrong = 0;
  std::vector<double> times_s, whole_times_s;
  double position = 0, rotation = 0;  ///< largest deviations by the independent check
  double waypoints = 0;

  void print(const std::string& name) {
    fmt::print(
        "{:22} {:6} {:6} {:5}/{:5} {:5} {:7.1f} {:9.4f} {:9.4f} {:8.0f} {:8.0f} {:8.0f} "
        "{:8.0f} {:8.0f}\n",
        name, lines, whole, missed, searched, wrong, waypoints / std::max(1, whole), 1e3 * position,
        rotation * 57.29578, 1e6 * quantile(whole_times_s, 0.5),
        1e6 * quantile(whole_times_s, 0.99), 1e6 * quantile(times_s, 0.5),
        1e6 * quantile(times_s, 0.99), 1e6 * quantile(times_s, 1));
  }
};

Configuration random_valid(const CollisionChecker& checker, Rng& rng) {
  const Robot& robot = checker.robot();
  for (;;) {
    Configuration q;
    for (int j = 0; j < robot.joint_count(); ++j) {
      q.push_back(rng.uniform(robot.group_joint(j).lower, robot.group_joint(j).upper));
    }
    if (checker.is_valid(std::span<const double>(q))) return q;
  }
}

/// A line of 10 to 40 cm in a random direction from where the link is at `q`.
Line random_line(const std::string& link, Rng& rng) {
  Line line;
  line.link = link;
  const Vec3 direction = Vec3(rng.normal(), rng.normal(), rng.normal()).normalized();
  line.displacement = rng.uniform(0.1, 0.4) * direction;
  return line;
}

class Campaign {
 public:
  explicit Campaign(const Options& options) : options_(options), rng_(options.seed) {}

  Result<void> run() {
    fmt::print("{:22} {:>6} {:>6} {:>11} {:>5} {:>7} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8}\n",
               "robot, start", "lines", "whole", "missed/of", "wrong", "points", "off mm",
               "off deg", "p50 us", "p99 us", "all p50", "all p99", "max us");
    std::vector<std::string> names;
    for (const std::string& file : options_.problems) {
      for (const std::string& name : MNEME_TRY(list_problems(file))) {
        names.push_back(file + "#" + name);
      }
    }
    const auto cache = make_problem_cache();
    const double each = static_cast<double>(options_.lines) /
                        static_cast<double>(std::max<std::size_t>(1, names.size()));
    double due = 0;
    for (const std::string& name : names) {
      due += each;
      if (due < 1) continue;
      ProblemOptions problem_options;
      problem_options.cache = cache;
      const Problem problem = MNEME_TRY(load_problem(name, problem_options));
      for (; due >= 1; due -= 1) MNEME_TRY(run_line(problem));
    }
    for (auto& [name, tally] : tallies_) {
      tally.print(name);
      wrong_ += tally.wrong;
    }
    if (options_.is_confirming) {
      fmt::print("the search finds {} of {} whole lines\n", confirmed_, confirmable_);
    }
    return {};
  }
  [[nodiscard]] int wrong() const { return wrong_; }

 private:
  Result<void> run_line(const Problem& problem) {
    const CollisionChecker checker =
        MNEME_TRY(CollisionChecker::make(problem.robot, problem.scene));
    const std::string link = find_tips(problem.robot).front();
    const bool is_given = rng_.uniform() < 0.5;
    const bool is_grasp = rng_.uniform() < 0.3 && !problem.goals.empty();
    Configuration q = is_grasp ? problem.goals.front() : random_valid(checker, rng_);
    if (!checker.is_valid(std::span<const double>(q))) q = random_valid(checker, rng_);
    Line line = random_line(link, rng_);
    if (!is_given) {
      line.start =
          problem.robot.link_poses(q)[static_cast<std::size_t>(*problem.robot.find_link(link))];
    }
    const double begin_s = cpu_time_s();
    const LineResult result = MNEME_TRY(plan_line(checker, line, q, options_.line));
    const double time_s = cpu_time_s() - begin_s;
    Tally& tally = tallies_[problem.robot.name() + (is_given ? ", given" : ", any branch")];
    ++tally.lines;
    tally.times_s.push_back(time_s);
    if (result.is_whole()) {
      ++tally.whole;
      tally.whole_times_s.push_back(time_s);
      tally.waypoints += static_cast<double>(result.line.path.size());
    }
    check(problem, checker, link, result, tally);
    if (!result.is_whole() || options_.is_confirming)
      search(problem, checker, link, line, q, result, tally);
    return {};
  }

  void check(const Problem& problem, const CollisionChecker& checker, const std::string& link,
             const LineResult& result, Tally& tally) {
    const auto off = test::measure_deviation(problem.robot, link, result, options_.states);
    tally.position = std::max(tally.position, off.position);
    tally.rotation = std::max(tally.rotation, off.rotation);
    const bool is_off = off.position > result.line.position_deviation + 1e-9 ||
                        off.rotation > result.line.rotation_deviation + 1e-7;
    const bool is_free =
        result.line.path.size() < 2 ||
        is_path_free(problem.robot, problem.scene, result.line.path, 0.01, EndTolerances{});
    if (!is_off && is_free) return;
    ++tally.wrong;
    fmt::print("  WRONG: {}: {}\n", problem.name,
               is_off ? fmt::format("{} m and {} rad off, beyond the bounds {} and {}",
                                    off.position, off.rotation, result.line.position_deviation,
                                    result.line.rotation_deviation)
                      : "not free");
    (void)checker;
  }

  void search(const Problem& problem, const CollisionChecker& checker, const std::string& link,
              const Line& line, const Configuration& q, const LineResult& result, Tally& tally) {
    if (searched_ >= options_.most_searched) return;
    ++searched_;
    if (!result.is_whole()) ++tally.searched;
    IkSettings settings;
    settings.seeds = 4096;
    const auto kinematics = InverseKinematics::make(problem.robot, link);
    PoseGoal goal;
    goal.link = link;
    goal.pose = result.end;
    if (kinematics->solve(goal, q, settings, &checker, kVerificationMargin).solutions.empty()) {
      return;
    }
    std::vector<Configuration> starts = {q};
    if (line.start) {
      goal.pose = result.begin;
      settings.solutions = 200;
      for (const Configuration& each :
           kinematics->solve(goal, q, settings, &checker, 0).solutions) {
        starts.push_back(each);
      }
    }
    const test::LineOracle oracle(checker, link, options_.oracle_step, options_.oracle_cell);
    const bool is_possible = oracle.is_possible(result, starts);
    if (result.is_whole()) {
      confirmed_ += is_possible;
      ++confirmable_;
      return;
    }
    if (is_possible) ++tally.missed;
    if (options_.is_verbose) {
      fmt::print("  {} {}: {} ({} steps): {}\n", problem.robot.name(),
                 is_possible ? "MISSED" : "not possible", problem.name, result.steps,
                 result.reason);
    }
  }

  Options options_;
  Rng rng_;
  std::map<std::string, Tally> tallies_;
  int searched_ = 0, wrong_ = 0;
  int confirmed_ = 0, confirmable_ = 0;  ///< whole lines that the search finds, too
};

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Plans random lines in the scenes of problems, and checks them.");
  app.add_option("problems", options.problems, "compact files of problems")->required();
  app.add_option("--lines", options.lines, "lines in all")->check(CLI::Range(1, 100000000));
  app.add_option("--states", options.states, "states checked per motion")
      ->check(CLI::Range(1, 10000));
  app.add_option("--seed", options.seed, "seed of everything");
  app.add_option("--oracle-step", options.oracle_step, "metres between layers of the search");
  app.add_option("--oracle-cell", options.oracle_cell, "radians between configurations of a layer");
  app.add_option("--searched", options.most_searched,
                 "lines that are searched exhaustively, at most");
  app.add_option("--line-steps", options.line.line_steps, "steps along a line, at most")
      ->check(CLI::Range(1, 100000000));
  app.add_flag("--confirm", options.is_confirming, "search whole lines, too");
  app.add_flag("--verbose", options.is_verbose, "a line for each search");
  CLI11_PARSE(app, argc, argv);
  Campaign campaign(options);
  const auto done = campaign.run();
  if (!done) fmt::print(stderr, "soak_lines: {}\n", done.error().message);
  return done && campaign.wrong() == 0 ? 0 : 1;
}

}  // namespace
}  // namespace mneme::soak

int main(int argc, char** argv) { return mneme::soak::run(argc, argv); }
