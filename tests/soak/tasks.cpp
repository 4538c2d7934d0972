// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Random tasks with a known plan. Checks every stage of every plan by exact distances, with
/// --motion also all states of the timed motion, and its limits. Succeeds if all tasks are solved
/// without a contact. With --optimum compares improved plans with the best of all choices instead.
#include "mneme/experience.h"

#include "soak/measures.h"
#include "soak/random_task.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace mneme::soak {
namespace {

struct Options {
  int tasks = 100;
  Choices choices;
  std::uint64_t seed = 1;
  double resolution = 0.005;
  double moved = 0.05;  ///< how far the cup is moved for the second time, metres
  bool has_motion = false, is_first_only = false, is_verbose = false;
  int optimum_plans = 0;  ///< plans that improvement compares, per choice; 0: no comparison
};

/// The tasks that leave one pose to each stage.
std::vector<Task> single_choices(const Task& task) {
  std::vector<Task> tasks = {task};
  for (std::size_t i = 0; i < task.stages.size(); ++i) {
    const std::vector<Transform>& poses = task.stages[i].poses.poses;
    if (poses.size() < 2) continue;
    std::vector<Task> further;
    for (const Task& each : tasks) {
      for (const Transform& pose : poses) {
        further.push_back(each);
        further.back().stages[i].poses.poses = {pose};
      }
    }
    tasks = std::move(further);
  }
  return tasks;
}

struct Sums {
  int tasks = 0, solved = 0, contacts = 0, stages = 0, motions = 0;
  std::vector<double> times_ms, states;

  void print(const std::string& name) const {
    fmt::print("{:18} {:5}/{:<5} {:9.2f} {:9.2f} {:9.0f} {:9.0f} {:6} {:5}\n", name, solved, tasks,
               quantile(times_ms, 0.5), quantile(times_ms, 0.95), quantile(states, 0.5),
               quantile(states, 0.95), stages, contacts);
  }
};

class Campaign {
 public:
  explicit Campaign(const Options& options) : options_(options) {}

  Result<bool> run() {
    const std::string urdf = MNEME_TRY(find_robot("panda"));
    const Robot panda = MNEME_TRY(load_approximated_robot(urdf)).robot;
    if (options_.optimum_plans > 0) return compare_with_optimum(panda);
    for (int i = 0; i < options_.tasks; ++i) {
      const std::uint64_t seed = derive_seed(options_.seed, static_cast<std::uint64_t>(i));
      const Task task = MNEME_TRY(random_task(panda, options_.choices, seed));
      MNEME_TRY(solve_and_check(task, nullptr, without_));
      if (options_.is_first_only) continue;
      MNEME_TRY(repeat_with_memory(task, seed));
      MNEME_TRY(solve_and_check(blocked_task(panda, options_.choices, seed), nullptr, refused_));
    }
    fmt::print("{:18} {:>11} {:>9} {:>9} {:>9} {:>9} {:>6} {:>5}\n", "tasks", "solved", "p50 ms",
               "p95 ms", "p50 st.", "p95 st.", "stages", "hits");
    without_.print("first time");
    first_.print("storing choices");
    again_.print("cup moved");
    again_without_.print("moved, no memory");
    refused_.print("blocked");
    const double hours = stopwatch_.elapsed_s() / 3600;
    fmt::print("{} motions checked, largest share of a limit {:.9f}; {:.0f} tasks per hour\n",
               without_.motions + first_.motions + again_.motions + again_without_.motions, use_,
               without_.tasks / hours);
    const bool is_whole =
        without_.solved == without_.tasks && again_.solved == again_without_.solved;
    const int hits =
        without_.contacts + first_.contacts + again_.contacts + again_without_.contacts;
    return is_whole && hits == 0 && refused_.solved == 0 && use_ <= 1 + kLimitShare;
  }

 private:
  /// Succeeds if plans of all choices together take at most 5 % longer than the best single choice,
  /// in 95 of 100 tasks.
  Result<bool> compare_with_optimum(const Robot& panda) {
    std::vector<double> ratios;
    for (int i = 0; i < options_.tasks; ++i) {
      const std::uint64_t seed = derive_seed(options_.seed, static_cast<std::uint64_t>(i));
      const Task task = MNEME_TRY(random_task(panda, options_.choices, seed));
      double best_s = std::numeric_limits<double>::infinity();
      const std::vector<Task> choices = single_choices(task);
      for (const Task& choice : choices) {
        best_s = std::min(best_s, MNEME_TRY(improved_time_s(choice, options_.optimum_plans)));
      }
      const int plans = options_.optimum_plans * static_cast<int>(choices.size());
      ratios.push_back(MNEME_TRY(improved_time_s(task, plans)) / best_s);
      if (options_.is_verbose) fmt::print("  {:.4f} of {:.3f} s\n", ratios.back(), best_s);
    }
    const auto within = std::ranges::count_if(ratios, [](double ratio) { return ratio <= 1.05; });
    fmt::print(
        "time by the best choice's: p50 {:.4f}, p95 {:.4f}, max {:.4f}; {} of {} within 5 %\n",
        quantile(ratios, 0.5), quantile(ratios, 0.95), quantile(ratios, 1), within, ratios.size());
    return 100 * within >= 95 * std::ssize(ratios);
  }

  /// Infinity for a task without a plan.
  static Result<double> improved_time_s(const Task& task, int plans) {
    TaskSettings settings;
    settings.solve.plan.timeout_s = settings.improve = 1e4;  // plans are the limit
    settings.improve_plans = plans;
    const TaskResult result = MNEME_TRY(solve_task(task, nullptr, settings));
    return result.is_solved() ? result.path_time_s : std::numeric_limits<double>::infinity();
  }

  Result<TaskResult> solve_and_check(const Task& task, Database* database, Sums& sums) {
    TaskSettings settings;
    if (database != nullptr) {
      settings.solve.remember_after = 0;
      settings.solve.replay = 0.5;
    }
    TaskResult result = MNEME_TRY(solve_task(task, database, settings));
    ++sums.tasks;
    sums.times_ms.push_back(1e3 *
                            (result.is_solved() ? result.first_plan_time_s : result.total_time_s));
    sums.states.push_back(static_cast<double>(result.states_checked));
    if (options_.is_verbose) {
      fmt::print("  {} {:.2f} ms, {} states {}\n", to_string(result.status), sums.times_ms.back(),
                 result.states_checked, result.message);
    }
    if (!result.is_solved()) return result;
    ++sums.solved;
    Configuration at = task.start;
    for (const StageResult& stage : result.stages) {
      ++sums.stages;
      const Problem& world = *stage.world;
      const bool follows = task.robot.distance(at, stage.path.front()) < 1e-6;
      const bool is_free = stage.path.size() < 2 ||
                           is_path_free(world.robot, world.scene, stage.path, options_.resolution,
                                        end_tolerances(settings.solve));
      if (!follows || !is_free) {
        ++sums.contacts;
        fmt::print("  {}: {}\n", stage.name, follows ? "in contact" : "does not follow");
      }
      at = stage.path.back();
    }
    if (options_.has_motion) MNEME_TRY(check_motion(task, result, settings.solve, sums));
    return result;
  }

  /// The timed motion, every 4 ms, by exact distances in the world of each stage.
  Result<void> check_motion(const Task& task, const TaskResult& result,
                            const SolveSettings& settings, Sums& sums) {
    constexpr double kStep_s = 0.004;
    const RateLimits limits = MNEME_TRY(find_rate_limits(task.robot));
    const TaskMotion motion = MNEME_TRY(time_task(task, result, settings, limits));
    for (std::size_t i = 0; i < result.stages.size(); ++i) {
      const StageResult& stage = result.stages[i];
      if (!motion.stages[i] || stage.gripper) continue;
      ++sums.motions;
      Path states;
      for (const Trajectory::Point& point : MNEME_TRY(motion.stages[i]->sample(kStep_s))) {
        states.push_back(point.position);
        for (std::size_t j = 0; j < point.velocity.size(); ++j) {
          use_ = std::max({use_, std::abs(point.velocity[j]) / limits.velocity[j],
                           std::abs(point.acceleration[j]) / limits.acceleration[j]});
        }
      }
      const Problem& world = *stage.world;
      if (is_path_free(world.robot, world.scene, states, options_.resolution,
                       end_tolerances(settings))) {
        continue;
      }
      ++sums.contacts;
      fmt::print("  {}: its motion is in contact\n", stage.name);
    }
    return {};
  }

  /// Solves the task with an empty database, then with the cup moved.
  Result<void> repeat_with_memory(const Task& task, std::uint64_t seed) {
    const std::string file =
        (std::filesystem::temp_directory_path() / fmt::format("mneme_tasks_{}.db", seed)).string();
    std::filesystem::remove(file);
    {
      Database database =
          MNEME_TRY(Database::open(file, make_signature(task.robot), OpenMode::create));
      MNEME_TRY(solve_and_check(task, &database, first_));
      MNEME_TRY(database.flush());
      Rng rng(derive_seed(seed, 77));
      Task moved = task;
      Transform shift;
      const Vec3 way(rng.uniform(-1, 1), rng.uniform(-1, 1), 0);
      shift.translation = rng.uniform(0, options_.moved) * way / std::max(1.0, way.norm());
      MNEME_TRY(moved.scene.move("cup", shift));
      MNEME_TRY(solve_and_check(moved, nullptr, again_without_));
      MNEME_TRY(solve_and_check(moved, &database, again_));
    }
    std::filesystem::remove(file);
    return {};
  }

  /// Share of a limit by which rounding may exceed it.
  static constexpr double kLimitShare = 1e-6;

  const Options& options_;
  Stopwatch stopwatch_;
  double use_ = 0;  ///< largest share of a velocity or acceleration limit
  Sums without_, first_, again_, again_without_, refused_;
};

}  // namespace
}  // namespace mneme::soak

int main(int argc, char** argv) {
  mneme::soak::Options options;
  CLI::App app("Random tasks of pick and place, each with a known plan");
  app.add_option("--tasks", options.tasks, "number of tasks");
  app.add_option("--grasps", options.choices.grasps, "grasps of each task");
  app.add_option("--placements", options.choices.placements, "placements of each task");
  app.add_option("--seed", options.seed, "seed of the tasks");
  app.add_option("--resolution", options.resolution, "largest step of the check, radians");
  app.add_option("--moved", options.moved, "how far the cup is moved for the second time, metres");
  app.add_flag("--motion", options.has_motion, "check the timed motions, too");
  app.add_flag("--first-only", options.is_first_only, "without memory, and without blocked tasks");
  app.add_option("--optimum", options.optimum_plans,
                 "compare with the best choice, each improved by this number of plans");
  app.add_flag("--verbose", options.is_verbose, "print each task");
  CLI11_PARSE(app, argc, argv);
  const auto passed = mneme::soak::Campaign(options).run();
  if (!passed) fmt::print(stderr, "soak_tasks: {}\n", passed.error().message);
  return passed && *passed ? 0 : 1;
}
