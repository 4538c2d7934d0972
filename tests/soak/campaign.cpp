// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "soak/campaign.h"

#include "soak/fcl_oracle.h"
#include "soak/memory.h"
#include "soak/random_problem.h"
#include "support/kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace mneme::soak {
namespace {

/// Samplers that need no more than a database of any kind.
constexpr std::array<std::string_view, 4> kSamplers = {"gl", "uniform", "halton", "pooled"};
constexpr double kRefusalClearance = 1e-4;
constexpr double kLimitTolerance = 1e-9;
/// Planners with each sampler.
constexpr int kWays = 12;

/// Lets the last link keep a direction in a cone that start and goal are in. Without effect where
/// they are nearly opposite, or no joint turns the link.
void add_cone(Problem& problem) {
  constexpr double kRoom = 0.2, kOpposite = 0.1;
  const Robot& robot = problem.robot;
  const auto last = static_cast<std::size_t>(robot.group_joint(robot.joint_count() - 1).child_link);
  const auto up_at = [&](const Configuration& q) -> Vec3 {
    return robot.link_poses(q)[last].rotation.col(2);
  };
  const Vec3 sum = up_at(problem.start) + up_at(problem.goals[0]);
  if (sum.norm() < kOpposite) return;
  OrientationConstraint cone{.link = robot.links()[last].name, .up = sum.normalized()};
  cone.angle = tilt(robot, cone, problem.start) + kRoom;
  if (!describe_fault(robot, cone)) problem.constraints.push_back(cone);
}

/// Returns a flaw of the path other than contact.
std::optional<std::string> flaw_of(const Problem& problem, const Path& path) {
  constexpr double kResolution = 0.002, kTiltTolerance = 1e-6;
  for (const OrientationConstraint& cone : problem.constraints) {
    const double most = largest_tilt(problem.robot, cone, path, kResolution);
    if (most > cone.angle + kTiltTolerance) {
      return fmt::format("{} tilts by {:.6f} rad, allowed are {:.6f}", cone.link, most, cone.angle);
    }
  }
  if (path.size() < 2) return "fewer than two waypoints";
  if (path.front() != problem.start) return "another start";
  // Continuous joints are unwrapped.
  if (problem.robot.distance(path.back(), problem.goals[0]) > kLimitTolerance) {
    return "another goal";
  }
  for (const Configuration& waypoint : path) {
    const Configuration q = problem.robot.normalized(waypoint);
    for (std::size_t i = 0; i < q.size(); ++i) {
      const Joint& joint = problem.robot.group_joint(static_cast<int>(i));
      const bool is_inside =
          q[i] >= joint.lower - kLimitTolerance && q[i] <= joint.upper + kLimitTolerance;
      if (!is_inside) return fmt::format("{} is at {}, outside its limits", joint.name, q[i]);
    }
  }
  return std::nullopt;
}

SolveSettings settings_of(int plan, const CampaignSettings& campaign, const Robot& robot) {
  const auto number = static_cast<std::size_t>(plan);
  SolveSettings settings;
  settings.planner = planners()[number % planners().size()].name;
  settings.sampler = kSamplers.at(number / planners().size() % kSamplers.size());
  settings.margin = campaign.margin;
  settings.retrieve_after = 0;
  const bool has_paths = plan % 2 == 1;  // as Memory::database()
  if (has_paths) settings.memory = test::of_kind("paths");
  const bool may_learn =
      robot.is_planar() && !has_paths && find_sampler(settings.sampler).value()->uses_memory;
  settings.learn_budget_s = may_learn ? 0.01 : 0;
  settings.learn.starts_per_link = 1;
  settings.learn.paths_per_start = 1;
  settings.plan.seed = derive_seed(campaign.seed, number);
  settings.plan.timeout_s = 5;
  settings.plan.max_iterations = campaign.max_iterations;
  settings.plan.verify = campaign.verify;
  settings.plan.continuous = campaign.continuous;
  return settings;
}

class Campaign {
 public:
  Campaign(const Robot& robot, Memory memory, const CampaignSettings& settings)
      : robot_(robot), memory_(std::move(memory)), settings_(settings) {
    const CheckerSettings defaults;
    const auto checker = CollisionChecker::make(robot, {}, defaults);
    resolution_ = checker ? checker->resolution() : 0.02;
  }

  Result<void> run(int plan) {
    Rng rng(derive_seed(settings_.seed ^ 0x50a1, static_cast<std::uint64_t>(plan)));
    Problem problem = random_problem(robot_, settings_.margin, rng);
    if (settings_.near > 0) bring_ends_close(problem, settings_.near, rng);
    const SolveSettings settings = settings_of(plan, settings_, robot_);
    const bool has_cone = !robot_.is_planar() && settings.planner != "prm" && plan / kWays % 3 == 0;
    if (has_cone) add_cone(problem);
    auto solved = solve(problem, &memory_.database(plan), settings);
    if (!solved) return tl::unexpected(solved.error());
    Tally& tally = result_.tallies[fmt::format("{:8} {:12} {}", robot_.name(), settings.planner,
                                               settings.sampler)];
    ++tally.plans;
    where_ = fmt::format("{} plan {} ({} {}, seed {})", robot_.name(), plan, settings.planner,
                         settings.sampler, settings_.seed);
    if (!solved->plan.is_solved()) {
      judge_refusal(problem, solved->plan, tally);
      return {};
    }
    ++tally.solved;
    judge_path(problem, solved->plan.path, tally);
    return memory_.remember(problem, solved->plan.path);
  }

  CampaignResult take() { return std::move(result_); }

 private:
  void judge_refusal(const Problem& problem, const PlanResult& plan, Tally& tally) {
    const bool is_start = plan.status == PlanStatus::invalid_start;
    if (!is_start && plan.status != PlanStatus::invalid_goal) return;
    FclOracle oracle(robot_, problem.scene, settings_.margin);
    const double clearance = oracle.clearance(is_start ? problem.start : problem.goals[0]);
    if (clearance < kRefusalClearance) return;
    ++tally.refused;
    result_.findings.push_back(
        fmt::format("{}: {}, but FCL sees {:.6f} m", where_, plan.message, clearance));
  }

  void judge_path(const Problem& problem, const Path& path, Tally& tally) {
    FclOracle oracle(robot_, problem.scene, settings_.margin);
    std::optional<std::string> flaw = flaw_of(problem, path);
    if (const auto worst = oracle.deepest(path, resolution_ / settings_.refinement)) {
      tally.deepest = std::max(tally.deepest, worst->depth);
      flaw = fmt::format("{} overlap by {:.3g} m", worst->what, worst->depth);
    }
    if (!flaw) return;
    ++tally.invalid;
    result_.findings.push_back(where_ + ": " + *flaw);
  }

  const Robot& robot_;
  Memory memory_;
  const CampaignSettings& settings_;
  double resolution_ = 0;
  std::string where_;
  CampaignResult result_;
};

}  // namespace

Result<CampaignResult> run_campaign(const Robot& robot, const std::string& directory,
                                    const CampaignSettings& settings) {
  auto memory = Memory::create(robot, directory);
  if (!memory) return tl::unexpected(memory.error());
  Campaign campaign(robot, std::move(*memory), settings);
  for (int plan = 0; plan < settings.plans; ++plan) {
    if (auto done = campaign.run(plan); !done) return tl::unexpected(done.error());
  }
  return campaign.take();
}

}  // namespace mneme::soak
