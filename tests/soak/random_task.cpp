// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "soak/random_task.h"

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <string>
#include <utility>

namespace mneme::soak {
namespace {

constexpr const char* kHand = "panda_hand";
constexpr double kTableTop = 0.2, kShelfTop = 0.46;  // metres
constexpr double kCupRadius = 0.033, kCupHeight = 0.11;
/// Metres between the hand's origin and the middle of the cup.
constexpr std::array<double, 2> kReachToCup = {0.105, 0.125};
constexpr double kApproach = 0.08, kLift = 0.08;
constexpr int kClutter = 6;  ///< boxes on the table

class TaskMaker {
 public:
  TaskMaker(const Robot& panda, const Choices& choices, Rng& rng)
      : panda_(panda), choices_(choices), rng_(rng) {}

  Task make() {
    Task task{"task", panda_, "", {}, {0, -0.785, 0, -2.356, 0, 1.571, 0.785}, {}};
    side_ = rng_.uniform() < 0.5 ? -1 : 1;
    add_box(task.scene, "table", {0.5, 0, kTableTop / 2}, {0.3, 0.4, kTableTop / 2});
    add_box(task.scene, "shelf", {0.35, 0.6 * side_, kShelfTop - 0.01}, {0.25, 0.15, 0.01});
    add_box(task.scene, "shelf_top", {0.35, 0.6 * side_, kShelfTop + 0.4}, {0.25, 0.15, 0.01});
    add_box(task.scene, "shelf_back", {0.35, 0.76 * side_, 0.45}, {0.25, 0.01, 0.45});
    const Vec3 cup = {rng_.uniform(0.35, 0.6), side_ * rng_.uniform(-0.3, 0.1), stand(kTableTop)};
    Obstacle obstacle{"cup",
                      {Cylinder{{Eigen::Matrix3d::Identity(), cup}, kCupRadius, kCupHeight}}};
    task.scene.obstacles.push_back(std::move(obstacle));
    for (int i = 0; i < kClutter; ++i) add_clutter(task.scene, cup, i);
    add_stages(task);
    return task;
  }

  /// Covers the placements of the task that was made last.
  void block(Task& task) const {
    add_box(task.scene, "slab", {0.5, 0.28 * side_, kTableTop + 0.09}, {0.3, 0.13, 0.03});
    task.scene.obstacles.back().shapes.push_back(Box{
        {Eigen::Matrix3d::Identity(), {0.35, 0.6 * side_, kShelfTop + 0.09}}, {0.25, 0.15, 0.03}});
  }

 private:
  static double stand(double top) { return top + kCupHeight / 2 + 5e-4; }

  static void add_box(Scene& scene, const std::string& name, const Vec3& middle, const Vec3& half) {
    scene.obstacles.push_back({name, {Box{{Eigen::Matrix3d::Identity(), middle}, half}}});
  }

  void add_clutter(Scene& scene, const Vec3& cup, int number) {
    const Vec3 half = {rng_.uniform(0.015, 0.04), rng_.uniform(0.015, 0.04),
                       rng_.uniform(0.03, 0.1)};
    const Vec3 middle = {rng_.uniform(0.3, 0.75), rng_.uniform(-0.35, 0.35), kTableTop + half.z()};
    const double apart = (middle - cup).head<2>().norm();
    if (apart < half.head<2>().norm() + kCupRadius + 0.02) return;
    add_box(scene, fmt::format("clutter_{}", number), middle, half);
  }

  /// A pose of the hand in the cup's frame: from any side, tilted, at any height.
  Transform grasp() {
    const double around = rng_.uniform(-std::numbers::pi, std::numbers::pi);
    const double down = rng_.uniform(-0.3, std::numbers::pi / 2);
    const double turn = rng_.uniform() < 0.5 ? 0 : std::numbers::pi;
    const Eigen::Matrix3d rotation = rotation_about(Vec3::UnitZ(), around) *
                                     rotation_about(Vec3::UnitY(), std::numbers::pi / 2 + down) *
                                     rotation_about(Vec3::UnitZ(), turn);
    const Vec3 at = {0, 0, rng_.uniform(-0.03, 0.04)};
    const double away = rng_.uniform(kReachToCup[0], kReachToCup[1]);
    return {rotation, at - away * rotation.col(2)};
  }

  Transform placement() {
    const bool is_on_shelf = rng_.uniform() < 0.6;
    const Vec3 middle =
        is_on_shelf
            ? Vec3(rng_.uniform(0.15, 0.55), side_ * rng_.uniform(0.48, 0.7), stand(kShelfTop))
            : Vec3(rng_.uniform(0.25, 0.75), side_ * rng_.uniform(0.15, 0.35), stand(kTableTop));
    return {rotation_about(Vec3::UnitZ(), rng_.uniform(-std::numbers::pi, std::numbers::pi)),
            middle};
  }

  static Stage line(const std::string& name, const Vec3& direction, const std::string& along,
                    double distance) {
    Stage stage{StageKind::line, name};
    stage.link = kHand;
    stage.direction = direction;
    stage.along = along;
    stage.distance = distance;
    return stage;
  }

  void add_stages(Task& task) {
    Stage approach = line("approach", Vec3::UnitZ(), kHand, kApproach);
    approach.poses = {kHand, "", "cup", {}};
    for (int i = 0; i < choices_.grasps; ++i) approach.poses.poses.push_back(grasp());
    Stage lower = line("lower", -Vec3::UnitZ(), "", kLift);
    lower.poses = {kHand, "cup", "", {}};
    for (int i = 0; i < choices_.placements; ++i) lower.poses.poses.push_back(placement());
    Stage take{StageKind::attach, "grasp"};
    take.object = "cup";
    take.carrier = kHand;
    Stage release{StageKind::detach, "release"};
    release.object = "cup";
    task.stages = {{StageKind::move, "reach"},
                   std::move(approach),
                   std::move(take),
                   line("lift", Vec3::UnitZ(), "", kLift),
                   {StageKind::move, "carry"},
                   std::move(lower),
                   std::move(release),
                   line("retreat", -Vec3::UnitZ(), kHand, kApproach)};
  }

  const Robot& panda_;
  const Choices& choices_;
  Rng& rng_;
  double side_ = 1;
};

/// The task with one grasp and one placement.
Task only(const Task& task, std::uint32_t grasp, std::uint32_t placement) {
  Task single = task;
  for (auto [stage, kept] : {std::pair(1, grasp), std::pair(5, placement)}) {
    std::vector<Transform>& poses = single.stages[static_cast<std::size_t>(stage)].poses.poses;
    poses = std::vector<Transform>{poses[kept]};
  }
  return single;
}

/// True if a random pair of a grasp and a placement has a plan by itself.
bool has_plan(const Task& task, Rng& rng) {
  constexpr int kPairs = 60;
  TaskSettings settings;
  settings.solve.plan.max_iterations = 20000;
  const auto count = [&](std::size_t stage) {
    return static_cast<std::uint32_t>(task.stages[stage].poses.poses.size());
  };
  for (int i = 0; i < kPairs; ++i) {
    const std::uint32_t grasp = rng.index(count(1)), placement = rng.index(count(5));
    const auto solved = solve_task(only(task, grasp, placement), nullptr, settings);
    if (solved && solved->is_solved()) return true;
  }
  return false;
}

}  // namespace

Result<Task> random_task(const Robot& panda, const Choices& choices, std::uint64_t seed) {
  constexpr std::uint64_t kTries = 200;
  for (std::uint64_t i = 0; i < kTries; ++i) {
    Rng rng(derive_seed(seed, i));
    Task task = TaskMaker(panda, choices, rng).make();
    if (has_plan(task, rng)) return task;
  }
  return tl::unexpected(
      Error{ErrorCode::invalid, fmt::format("no task with a plan in {} tries", kTries)});
}

Task blocked_task(const Robot& panda, const Choices& choices, std::uint64_t seed) {
  Rng rng(derive_seed(seed, 0));
  TaskMaker maker(panda, choices, rng);
  Task task = maker.make();
  maker.block(task);
  return task;
}

}  // namespace mneme::soak
