// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Inputs of several subcommands: robots by name, scenes alone or in problems, databases.
#pragma once

#include "mneme/spheres.h"
#include "mneme/experience.h"
#include "mneme/pipeline.h"
#include "mneme/problem.h"
#include "mneme/report.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme::app {

/// Progress on standard error while geometry is approximated by spheres.
[[nodiscard]] SphereProgress show_sphere_progress();

/// The robot of robot_file(); what was noticed on the way are notes on standard error.
[[nodiscard]] Result<Robot> load_named_robot(const std::string& robot,
                                             const RobotOptions& options = {});
/// The same, unless it is read from one of `outputs`, which are to be written.
[[nodiscard]] Result<Robot> load_named_robot(const std::string& robot, const RobotOptions& options,
                                             std::span<const std::string> outputs);
/// The flags that replace a problem's robot; with an empty `robot` the problem's is used.
[[nodiscard]] Result<ProblemOptions> problem_options(const std::string& robot,
                                                     const RobotOptions& options);

/// load_problem, with its warnings as notes on standard error.
[[nodiscard]] Result<Problem> read_problem(const std::string& where,
                                           const ProblemOptions& options = {});

/// A scene, and the problem that it came in, if it did.
struct Workspace {
  FramedScene framed;  ///< that of a problem is in the frame of the root link
  std::optional<Problem> problem;
};
/// Reads a scene file or a problem (whatever load_problem takes).
[[nodiscard]] Result<Workspace> load_workspace(const std::string& where,
                                               const ProblemOptions& options);

/// A robot in a scene.
struct PlacedRobot {
  Robot robot;
  Scene scene;                         ///< in the frame of the root link; empty without a file
  std::optional<Configuration> start;  ///< of the problem, if the scene came with one
  std::vector<ReadFile> files;         ///< what robot and scene were read from

  /// The start, or zeros, within the limits.
  [[nodiscard]] Configuration start_or_zeros() const;
};
/// The robot as the problem has it if the scene comes with one: its group and fixed joints count.
/// An empty `scene` leaves it out.
[[nodiscard]] Result<PlacedRobot> load_placed_robot(const std::string& robot,
                                                    const RobotOptions& options,
                                                    const std::string& scene);

/// Notes why losses of rows of a database would not be found, if its record is there but unusable.
void note_record_flaw(const Database& database);

/// Opens the database at `url` for planning: for writing only if planning may add to it.
[[nodiscard]] Result<Database> open_memory(const std::string& url, const Robot& robot,
                                           const SolveSettings& settings,
                                           const DatabaseSettings& kept);

/// Removes the SQLite file of a database, and those that mneme keeps beside it.
void remove_database(const std::string& file);

/// Waits until what was remembered is stored; notes what is not. `what`: such as "the path was".
void store_remembered(Database& database, const std::string& what);

/// How many queued rows a process loses that ends now, and why; empty for none.
[[nodiscard]] std::string describe_lost_rows(const QueuedRows& rows);

}  // namespace mneme::app
