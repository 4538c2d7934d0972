// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Loads robots from URDF files with their defaults, plans between random valid pairs of
/// configurations without obstacles, and has FCL check every path on the exact geometry, over all
/// pairs of links. Or compares random configurations with FCL. Succeeds if all robots load, no path
/// touches and no configuration that touches counts as valid.
#include "mneme/collision.h"
#include "mneme/pipeline.h"
#include "mneme/spheres.h"

#include "check/free_cells.h"
#include "collision/fcl_robot.h"
#include "tables/make_tables.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>
#include <time.h>

namespace mneme::soak {
namespace {

struct Options {
  std::vector<std::string> files;
  RobotOptions robot;
  int pairs = 20;
  double timeout_s = 5;
  double step = 0.02;  ///< radians between the states that FCL checks
  std::uint64_t seed = 1;
  int states = 0;  ///< random configurations to compare with FCL instead of plans
  int cells = 0;   ///< random configurations to compare proofs of cells at instead of plans
};

double cpu_time_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Element at `share` of the sorted values: 0 the least, 1 the largest.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(
      std::ceil(share * static_cast<double>(values.size() - 1)))];
}

/// The first pair of links that touches on the path, as text; empty if none does.
std::string contact_on(const Path& path, test::FclRobot& oracle,
                       const std::vector<test::LinkPair>& pairs, const Robot& robot, double step) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    double length = 0;
    for (std::size_t j = 0; j < path[i].size(); ++j) {
      length = std::max(length, std::abs(path[i][j] - path[i - 1][j]));
    }
    const int count = 1 + static_cast<int>(length / step);
    for (int k = i == 1 ? 0 : 1; k <= count; ++k) {
      Configuration q = path[i - 1];
      for (std::size_t j = 0; j < q.size(); ++j) q[j] += (path[i][j] - q[j]) * k / count;
      oracle.move_to(q);
      if (const auto* pair = oracle.touching(pairs)) {
        return robot.links()[static_cast<std::size_t>(pair->first)].name + " and " +
               robot.links()[static_cast<std::size_t>(pair->second)].name;
      }
    }
  }
  return {};
}

/// Error: none of many random configurations is valid.
Result<Configuration> free_configuration(const CollisionChecker& checker, Rng& rng) {
  constexpr int kTries = 100000;
  for (int i = 0; i < kTries; ++i) {
    Configuration q = test::sampled_configuration(checker.robot(), rng);
    if (checker.is_valid(std::span<const double>(q))) return q;
  }
  return tl::unexpected(
      Error{ErrorCode::invalid, fmt::format("robot '{}': none of {} random configurations is valid",
                                            checker.robot().name(), kTries)});
}

/// Returns the joint, and its value, that every way from start to goal must pass and at which none
/// of 2000 random states of the others is valid: no proof, but a sign that there is no way. Empty
/// if there is none.
std::string apart_by(const CollisionChecker& checker, const Configuration& start,
                     const Configuration& goal, Rng& rng) {
  constexpr int kValues = 32, kStates = 2000;
  const Robot& robot = checker.robot();
  const auto is_blocked = [&](std::size_t joint, double value) {
    for (int k = 0; k < kStates; ++k) {
      Configuration q = test::sampled_configuration(robot, rng);
      q[joint] = value;
      if (checker.is_valid(std::span<const double>(q))) return false;
    }
    return true;
  };
  for (std::size_t j = 0; j < start.size(); ++j) {
    const Joint& joint = robot.group_joint(static_cast<int>(j));
    if (joint.type == JointType::continuous) continue;
    for (int i = 1; i < kValues; ++i) {
      const double value = start[j] + (goal[j] - start[j]) * i / kValues;
      if (is_blocked(j, value)) return fmt::format("{} at {:.2f}", joint.name, value);
    }
  }
  return {};
}

struct Tally {
  int solved = 0;
  int apart = 0;  ///< unsolved, start and goal are held apart by one joint
  int touching = 0;
  std::vector<double> times_s;  ///< of planning; infinite without a path
};

Result<Tally> plan_pairs(const std::string& file, const Robot& robot, const Options& options) {
  test::FclRobot oracle(robot);
  const auto pairs = MNEME_TRY(test::pairs_to_check(file, robot, oracle, options.robot));
  const auto checker = MNEME_TRY(CollisionChecker::make(robot, {}));
  Rng rng(options.seed);
  Tally tally;
  for (int i = 0; i < options.pairs; ++i) {
    const Configuration start = MNEME_TRY(free_configuration(checker, rng));
    const Configuration goal = MNEME_TRY(free_configuration(checker, rng));
    Problem problem{.name = "pair", .robot = robot, .scene = {"empty", {}}, .start = start};
    problem.goals = {goal};
    SolveSettings settings;
    settings.plan.timeout_s = options.timeout_s;
    const SolveResult result = MNEME_TRY(solve(problem, nullptr, settings));
    const bool is_solved = result.plan.is_solved();
    tally.times_s.push_back(is_solved ? result.planning_time_s
                                      : std::numeric_limits<double>::infinity());
    if (!is_solved) {
      const std::string joint = apart_by(checker, problem.start, goal, rng);
      tally.apart += joint.empty() ? 0 : 1;
      fmt::print("  unsolved: pair {}{}{}\n", i, joint.empty() ? "" : ": apart by ", joint);
      continue;
    }
    ++tally.solved;
    const std::string contact = contact_on(result.plan.path, oracle, pairs, robot, options.step);
    if (contact.empty()) continue;
    ++tally.touching;
    fmt::print("  WRONG: pair {}: {} touch\n", i, contact);
  }
  return tally;
}

/// The pairs of links that refuse configurations in which nothing touches.
class Refusals {
 public:
  void add(const std::vector<Contact>& contacts) {
    for (const Contact& contact : contacts) ++counts_[contact.link + " and " + contact.other];
  }
  /// Prints the pairs that refuse most.
  void print() const {
    constexpr std::size_t kMost = 5;
    std::vector<std::pair<int, std::string>> rows;
    for (const auto& [pair, count] : counts_) rows.emplace_back(count, pair);
    std::ranges::sort(rows, std::greater());
    rows.resize(std::min(rows.size(), kMost));
    for (const auto& [count, pair] : rows)
      fmt::print("  refused though free: {} {}\n", count, pair);
  }

 private:
  std::map<std::string, int> counts_;
};

/// Compares random configurations with FCL. Prints the robot's row; true if no contact was missed.
Result<bool> compare_states(const std::string& file, const Robot& robot, const Options& options) {
  test::FclRobot oracle(robot);
  const auto pairs = MNEME_TRY(test::pairs_to_check(file, robot, oracle, options.robot));
  const auto checker = MNEME_TRY(CollisionChecker::make(robot, {}));
  Rng rng(options.seed);
  int valid = 0, touching = 0, missed = 0;
  Refusals refusals;
  for (int i = 0; i < options.states; ++i) {
    const Configuration q = test::sampled_configuration(robot, rng);
    oracle.move_to(q);
    const auto* pair = oracle.touching(pairs);
    const bool is_valid = checker.is_valid(std::span<const double>(q));
    valid += is_valid ? 1 : 0;
    touching += pair != nullptr ? 1 : 0;
    if (pair == nullptr) refusals.add(checker.contacts(q));
    if (!is_valid || pair == nullptr) continue;
    ++missed;
    const auto name = [&](int link) { return robot.links()[static_cast<std::size_t>(link)].name; };
    fmt::print("  WRONG: state {}: {} and {} touch\n", i, name(pair->first), name(pair->second));
  }
  fmt::print("{:28} {:6} {:9} {:9} {:9} {:9} {:9}\n", std::filesystem::path(file).stem().string(),
             pairs.size(), options.states, touching, options.states - valid, valid, missed);
  refusals.print();
  std::fflush(stdout);
  return missed == 0;
}

/// Compares proofs of cells that two links stay apart with the distance of their exact geometry at
/// random configurations. Prints a row for each pair; true if no proof is wrong.
Result<bool> compare_cells(const std::string&, const Robot& robot, const Options& options) {
  constexpr double kRounding = 1e-6;
  const auto checked = MNEME_TRY(internal::share_checked_robot(robot));
  const internal::LinkDistances& links = checked->links;
  const auto name = [&](int link) { return robot.links()[static_cast<std::size_t>(link)].name; };
  bool is_right = true;
  for (const auto& [first, second] : robot.exact_pairs()) {
    Rng rng(options.seed);
    int proven = 0, apart = 0, by_spheres = 0, wrong = 0;
    const auto& cells = links.free_cells(robot, first, second);
    for (int i = 0; i < options.cells; ++i) {
      const Configuration q = test::sampled_configuration(robot, rng);
      const std::vector<float> state(q.begin(), q.end());
      const auto posed = links.posed(robot.link_poses(Configuration(state.begin(), state.end())));
      const double gap = links.between(posed, {first, second, true}, internal::kCellSpare);
      const bool is_apart = gap >= internal::kCellSpare - kRounding;
      const bool are_spheres_apart = links.between_spheres(posed, first, second, 0) > 0;
      const bool is_proven = std::ranges::any_of(
          cells, [&](const auto& proofs) { return !proofs->unproven(state, {}, {}); });
      apart += is_apart ? 1 : 0;
      proven += is_proven ? 1 : 0;
      by_spheres += are_spheres_apart && !is_proven ? 1 : 0;
      wrong += is_proven && !is_apart ? 1 : 0;
    }
    fmt::print("{:50} {:9} {:9} {:9} {:9} {:9}\n", name(first) + " and " + name(second),
               options.cells, apart, proven, by_spheres, wrong);
    is_right &= wrong == 0;
  }
  std::fflush(stdout);
  return is_right;
}

/// Returns the result of `compare_robot` for a robot's file; false if it does not load.
template <class Compare>
bool compare(const std::string& file, const Options& options, const Compare& compare_robot) {
  const auto is_right =
      load_approximated_robot(file, options.robot).and_then([&](const ApproximatedRobot& made) {
        return compare_robot(file, made.robot, options);
      });
  if (!is_right) fmt::print("  WRONG: {}: {}\n", file, is_right.error().message);
  return is_right && *is_right;
}

/// True if the robot loads and no path touches. Prints its row.
bool run(const std::string& file, const Options& options) {
  const double begin_s = cpu_time_s();
  const auto loaded = load_approximated_robot(file, options.robot);
  // The first checker makes the tables of a robot.
  if (loaded) static_cast<void>(CollisionChecker::make(loaded->robot, {}));
  const double load_s = cpu_time_s() - begin_s;
  const auto tally = loaded.and_then(
      [&](const ApproximatedRobot& made) { return plan_pairs(file, made.robot, options); });
  if (!tally) {
    fmt::print("  WRONG: {}: {}\n", file, tally.error().message);
    return false;
  }
  fmt::print("{:28} {:6} {:6.1f} {:6} {:7} {:6} {:8.2f} {:8.2f} {:8.2f} {:8}\n",
             std::filesystem::path(file).stem().string(), loaded->robot.joint_count(), load_s,
             loaded->robot.exact_pairs().size(), fmt::format("{}/{}", tally->solved, options.pairs),
             tally->apart, 1e3 * quantile(tally->times_s, 0.5),
             1e3 * quantile(tally->times_s, 0.95), 1e3 * quantile(tally->times_s, 1),
             tally->touching);
  std::fflush(stdout);
  return tally->touching == 0;
}

}  // namespace
}  // namespace mneme::soak

int main(int argc, char** argv) {
  mneme::soak::Options options;
  CLI::App app("Loads robots, plans between random pairs, and has FCL check every path.");
  app.add_option("files", options.files, "URDF files")->required();
  app.add_option("--package-path", options.robot.package_paths, "directories of packages");
  app.add_option("--group", options.robot.group, "group of the SRDF, or BASE_LINK:TIP_LINK");
  app.add_option("--pairs", options.pairs, "plans per robot")->check(CLI::Range(1, 1000000));
  app.add_option("--timeout", options.timeout_s, "seconds per plan")->check(CLI::PositiveNumber);
  app.add_option("--step", options.step, "radians between the states that FCL checks")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", options.seed, "seed of the pairs");
  app.add_option("--states", options.states,
                 "random configurations of each robot to compare with FCL, instead of plans")
      ->check(CLI::Range(1, 1000000000));
  app.add_option(
         "--cells", options.cells,
         "random configurations to compare proofs of each pair's cells at, instead of plans")
      ->check(CLI::Range(1, 1000000000));
  CLI11_PARSE(app, argc, argv);
  bool is_right = true;
  if (options.states > 0) {
    fmt::print("{:28} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "robot", "pairs", "states",
               "touching", "refused", "valid", "missed");
    for (const std::string& file : options.files)
      is_right &= mneme::soak::compare(file, options, mneme::soak::compare_states);
    return is_right ? 0 : 1;
  }
  if (options.cells > 0) {
    fmt::print("{:50} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "pair", "states", "apart", "proven",
               "spheres", "wrong");
    for (const std::string& file : options.files)
      is_right &= mneme::soak::compare(file, options, mneme::soak::compare_cells);
    return is_right ? 0 : 1;
  }
  fmt::print("{:28} {:>6} {:>6} {:>6} {:>7} {:>6} {:>8} {:>8} {:>8} {:>8}\n", "robot", "joints",
             "load s", "exact", "solved", "apart", "p50 ms", "p95 ms", "max ms", "touching");
  for (const std::string& file : options.files) is_right &= mneme::soak::run(file, options);
  return is_right ? 0 : 1;
}
