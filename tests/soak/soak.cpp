// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Plans at random for all robots, planners and samplers, and has FCL look at every path again.
/// Succeeds if nothing was wrong with any of them.
#include "mneme/baselines.h"

#include "soak/campaign.h"
#include "soak/endurance.h"
#include "soak/sampling_limits.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>
#include <unistd.h>

namespace {

using mneme::soak::CampaignResult;
using mneme::soak::CampaignSettings;
using mneme::soak::Tally;

struct Options {
  std::vector<std::string> robots = {"planar8", "fetch", "panda", "ur5"};
  double plans_per_spatial = 5;  ///< how many times cheaper a planar plan is
  CampaignSettings settings;
  bool has_limits = false;
  bool is_detailed = false;
  double endurance_s = 0;
  double most_slower = 1.25;
};

mneme::Result<mneme::Robot> load(const std::string& name) {
  return mneme::find_robot(name).and_then(
      [](const std::string& path) { return mneme::load_robot(path); });
}

std::string make_directory() {
  std::string name = (std::filesystem::temp_directory_path() / "mneme-soak-XXXXXX").string();
  return ::mkdtemp(name.data());
}

std::string line_of(const std::string& name, const Tally& tally) {
  return fmt::format("{:32} {:7} {:7} {:7} {:7} {:10.3g}", name, tally.plans, tally.solved,
                     tally.invalid, tally.refused, tally.deepest);
}

void add(const Tally& tally, Tally& sum) {
  sum.plans += tally.plans;
  sum.solved += tally.solved;
  sum.invalid += tally.invalid;
  sum.refused += tally.refused;
  sum.deepest = std::max(sum.deepest, tally.deepest);
}

/// The robot's line, or one for each planner and sampler, and what was wrong.
Tally print(const CampaignResult& result, const std::string& robot, bool is_detailed) {
  Tally sum;
  for (const auto& [name, tally] : result.tallies) {
    if (is_detailed) fmt::print("{}\n", line_of(name, tally));
    add(tally, sum);
  }
  if (!is_detailed) fmt::print("{}\n", line_of(robot, sum));
  for (const std::string& finding : result.findings) fmt::print("  WRONG: {}\n", finding);
  return sum;
}

mneme::Result<Tally> run(const std::string& name, const std::string& directory,
                         const Options& options) {
  const auto robot = load(name);
  if (!robot) return tl::unexpected(robot.error());
  CampaignSettings settings = options.settings;
  if (!robot->is_planar()) {
    settings.plans = std::max(1, static_cast<int>(settings.plans / options.plans_per_spatial));
  }
  const auto result = mneme::soak::run_campaign(*robot, directory, settings);
  if (!result) return tl::unexpected(result.error());
  return print(*result, name, options.is_detailed);
}

int run_all(const Options& options) {
  fmt::print("{:32} {:>7} {:>7} {:>7} {:>7} {:>10}\n",
             options.is_detailed ? "robot, planner, sampler" : "robot", "plans", "solved",
             "invalid", "refused", "deepest m");
  const std::string directory = make_directory();
  Tally all;
  bool has_failed = false;
  for (const std::string& name : options.robots) {
    const auto tally = run(name, directory, options);
    if (!tally) {
      fmt::print(stderr, "soak: {}\n", tally.error().message);
      has_failed = true;
      continue;
    }
    add(*tally, all);
    std::fflush(stdout);
  }
  std::filesystem::remove_all(directory);
  fmt::print("{}\n", line_of("all", all));
  return has_failed || all.invalid > 0 || all.refused > 0 || all.solved == 0 ? 1 : 0;
}

/// Prints the gaps between states of a motion at the resolutions of planning and verification.
int print_limits(const Options& options) {
  fmt::print("{:12} {:>8} {:>9} {:>8} {:>9} {:>8} {:>9}\n", "robot", "m/rad", "radius m", "plan m",
             "cut m", "verify m", "cut m");
  constexpr int kSamples = 20000;
  for (const std::string& name : options.robots) {
    const auto robot = load(name);
    const auto checker =
        robot.and_then([](const auto& model) { return mneme::CollisionChecker::make(model, {}); });
    if (!checker) {
      fmt::print(stderr, "soak: {}\n", checker.error().message);
      return 1;
    }
    mneme::Rng rng(options.settings.seed);
    const auto limits = mneme::soak::measure_limits(*robot, kSamples, rng);
    const double planned = checker->resolution() * limits.speed;
    const double verified = planned / mneme::kVerificationRefinement;
    fmt::print("{:12} {:8.2f} {:9.4f} {:8.4f} {:9.2g} {:8.4f} {:9.2g}\n", name, limits.speed,
               limits.thinnest, planned, mneme::soak::deepest_cut(limits.thinnest, planned),
               verified, mneme::soak::deepest_cut(limits.thinnest, verified));
  }
  return 0;
}

/// Succeeds if no robot's rounds grow or slow.
int run_endurance(const Options& options) {
  constexpr std::int64_t kMostGrown = 2 << 20;
  fmt::print("{:12} {:>7} {:>7} {:>7} {:>10} {:>12} {:>10} {:>11}\n", "robot", "rounds", "plans",
             "rows", "CPU s", "last / first", "bytes", "grown by");
  const std::string directory = make_directory();
  bool has_failed = false;
  for (const std::string& name : options.robots) {
    const auto rounds = load(name).and_then([&](const mneme::Robot& robot) {
      return mneme::soak::endure(robot, directory,
                                 options.endurance_s / static_cast<double>(options.robots.size()),
                                 options.settings.seed);
    });
    if (!rounds) {
      fmt::print(stderr, "soak: {}\n", rounds.error().message);
      has_failed = true;
      continue;
    }
    const mneme::soak::Drift drift = mneme::soak::drift_of(*rounds);
    const auto count = static_cast<int>(rounds->size());
    const mneme::soak::Round& last = rounds->back();
    fmt::print("{:12} {:7} {:7} {:7} {:10.2f} {:12.2f} {:10} {:11}\n", name, count,
               count * last.plans, count * last.rows, last.cpu_s, drift.time_ratio, last.rss,
               drift.grown_bytes);
    std::fflush(stdout);
    has_failed |= drift.time_ratio > options.most_slower || drift.grown_bytes > kMostGrown ||
                  drift.grown_files > 0 || last.rows == 0;
  }
  std::filesystem::remove_all(directory);
  return has_failed ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  mneme::add_baseline_samplers();
  Options options;
  CampaignSettings& settings = options.settings;
  CLI::App app("Plans at random and has FCL look at every path again.");
  app.add_option("--robots", options.robots, "names of robots")->delimiter(',');
  app.add_option("--plans", settings.plans, "plans for each planar robot")
      ->check(CLI::Range(1, 100000000));
  app.add_option("--ratio", options.plans_per_spatial, "planar plans per plan of other robots")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", settings.seed, "seed of everything");
  app.add_option("--max-iterations", settings.max_iterations, "iteration limit of each plan");
  app.add_option("--margin", settings.margin, "metres added to the robot's shapes");
  app.add_option("--refinement", settings.refinement, "FCL's states per state of the planner")
      ->check(CLI::PositiveNumber);
  app.add_flag("!--no-verify", settings.verify, "return paths without verification");
  app.add_flag("--continuous,!--no-continuous", settings.continuous,
               "verify what lies between states too");
  app.add_option("--near", settings.near, "metres from contact at most, of starts and goals")
      ->check(CLI::PositiveNumber);
  app.add_flag("--detailed", options.is_detailed, "a line for each planner and sampler");
  app.add_flag("--limits", options.has_limits,
               "print instead how deep contact between two checked states can be");
  app.add_option("--endure", options.endurance_s,
                 "instead plan, insert and refresh for so many seconds, and see that nothing grows "
                 "or slows")
      ->check(CLI::PositiveNumber);
  app.add_option("--most-slower", options.most_slower,
                 "how much longer than the first rounds the last may take; a short run beside "
                 "other work needs more")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (options.endurance_s > 0) return run_endurance(options);
  return options.has_limits ? print_limits(options) : run_all(options);
}
