// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "inputs.h"

#include "mneme/benchmark.h"
#include "mneme/collision.h"
#include "mneme/spheres.h"
#include "mneme/report.h"

#include "console.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

namespace mneme::app {

SphereProgress show_sphere_progress() {
  const auto progress = std::make_shared<std::optional<Progress>>();
  return [progress](int done, int total, const std::string& link) {
    if (!*progress) progress->emplace("finding spheres");
    (*progress)->update(done, total, link);
    if (done == total) progress->reset();
  };
}

Result<Robot> load_named_robot(const std::string& robot, const RobotOptions& options) {
  const ApproximatedRobot loaded =
      MNEME_TRY(robot_file(robot).and_then([&](const std::string& path) {
        return load_approximated_robot(path, options, {}, show_sphere_progress());
      }));
  // As problems have them: commands say the same of a robot, whichever way they come by it.
  for (const std::string& note : loaded.notes) print_warning(note);
  for (const std::string& warning : loaded.robot.warnings()) print_warning(warning);
  return loaded.robot;
}

Result<Robot> load_named_robot(const std::string& robot, const RobotOptions& options,
                               std::span<const std::string> outputs) {
  const std::string path = MNEME_TRY(robot_file(robot));
  return check_files_to_write(outputs, robot_files(path, options.srdf_path)).and_then([&] {
    return load_named_robot(robot, options);
  });
}

Result<ProblemOptions> problem_options(const std::string& robot, const RobotOptions& options) {
  ProblemOptions result;
  result.robot = options;
  result.on_approximated = show_sphere_progress();
  if (robot.empty()) return result;
  return robot_file(robot).map([&](const std::string& path) {
    result.robot_path = path;
    return result;
  });
}

Result<Problem> read_problem(const std::string& where, const ProblemOptions& options) {
  Problem problem = MNEME_TRY(load_problem(where, options));
  for (const std::string& warning : problem.warnings) print_warning(warning);
  // Makes the tables of the robot now, so that the first plan is as fast as the second.
  static_cast<void>(CollisionChecker::make(problem.robot, {}));
  return problem;
}

Result<Workspace> load_workspace(const std::string& where, const ProblemOptions& options) {
  const auto from_problem = [](Problem problem) {
    return Workspace{{problem.scene, ""}, std::move(problem)};
  };
  const bool is_compact = where.find(".json#") != std::string::npos || where.ends_with(".json");
  const bool is_pair =
      where.find(".yaml,") != std::string::npos || where.find(".yml,") != std::string::npos;
  if (is_compact || is_pair) return read_problem(where, options).map(from_problem);

  Result<FramedScene> scene = load_framed_scene(where);
  if (scene) {
    for (const std::string& warning : scene->scene.warnings) print_warning(warning);
    return Workspace{std::move(*scene), std::nullopt};
  }
  if (scene.error().code == ErrorCode::io) return tl::unexpected(scene.error());
  Result<Problem> problem = read_problem(where, options);
  if (problem) return from_problem(*std::move(problem));
  // A file without a problem's scene is read as a scene.
  const Result<FramedScene> extracted = extract_scene(where);
  const bool has_scene = extracted || extracted.error().message != scene.error().message;
  if (has_scene) return tl::unexpected(std::move(problem).error());
  return tl::unexpected(scene.error());
}

Configuration PlacedRobot::start_or_zeros() const {
  if (start) return *start;
  return robot.normalized(Configuration(static_cast<std::size_t>(robot.joint_count()), 0.0));
}

Result<PlacedRobot> load_placed_robot(const std::string& robot, const RobotOptions& options,
                                      const std::string& scene) {
  const auto load_alone = [&]() -> Result<PlacedRobot> {
    PlacedRobot placed{MNEME_TRY(load_named_robot(robot, options)), {}, {}, {}};
    placed.files = robot_files(MNEME_TRY(robot_file(robot)), options.srdf_path);
    return placed;
  };
  if (scene.empty()) return load_alone();
  const ProblemOptions overrides = MNEME_TRY(problem_options(robot, options));
  const Workspace workspace = MNEME_TRY(load_workspace(scene, overrides));
  const std::optional<Problem>& problem = workspace.problem;
  PlacedRobot placed =
      MNEME_TRY(problem ? Result<PlacedRobot>(PlacedRobot{problem->robot, {}, problem->start, {}})
                        : load_alone());
  if (problem) {
    add_problem_files("a file of the problem", *problem, options.srdf_path, placed.files);
  } else {
    add_files("a file of the scene", workspace.framed.files, placed.files);
  }
  placed.scene = MNEME_TRY(in_root_frame(workspace.framed, placed.robot));
  return placed;
}

void note_record_flaw(const Database& database) {
  const DatabaseInfo info = database.info();
  if (!info.record_flaw.empty()) print_note(fmt::format("{}: {}", info.url, info.record_flaw));
}

Result<Database> open_memory(const std::string& url, const Robot& robot,
                             const SolveSettings& settings, const DatabaseSettings& kept) {
  const bool can_insert = settings.learn_budget_s > 0 || settings.remember_after.has_value();
  const auto mode = can_insert ? OpenMode::create : OpenMode::read_only;
  Result<Database> database = Database::open(url, make_signature(robot), mode, kept);
  if (database) note_record_flaw(*database);
  if (database &&
      compare_robots(database->signature(), make_signature(robot)) == RobotDifference::shapes) {
    print_note(fmt::format(
        "{}: was learned with another collision model of the robot, which does not matter",
        database->info().url));
  }
  return std::move(database).map_error([&](Error error) {
    std::error_code ignored;
    if (error.code == ErrorCode::io && !can_insert && !std::filesystem::exists(url, ignored)) {
      error.message +=
          "; 'mneme learn' makes a database, and so does planning with --remember-after or "
          "--learn-budget";
    }
    return error;
  });
}

void remove_database(const std::string& file) {
  std::error_code ignored;
  for (const char* ending : {"", "-wal", "-shm", ".tally", ".index"}) {
    std::filesystem::remove(file + ending, ignored);
  }
}

void store_remembered(Database& database, const std::string& what) {
  constexpr double kLongest_s = 30;
  if (const auto stored = database.flush(kLongest_s); !stored) {
    print_note(fmt::format("{} not remembered: {}", what, stored.error().message));
    database.stop_waiting();
  }
  const QueuedRows rows = database.queued_rows();
  if (rows.lost > 0) print_note(fmt::format("{} not remembered: {}", what, rows.failure));
}

std::string describe_lost_rows(const QueuedRows& rows) {
  const std::int64_t lost = rows.lost + rows.waiting;
  if (lost == 0) return "";
  // A first insertion that is still under way has no error yet.
  const std::string reason = !rows.failure.empty()
                                 ? rows.failure
                                 : "the database had not stored them when the process ended";
  return fmt::format("{} remembered rows were lost: {}", lost, reason);
}

}  // namespace mneme::app
