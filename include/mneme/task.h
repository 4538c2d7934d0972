// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tasks: sequences of stages such as approach, grasp, lift and place, with alternatives among
/// which a search chooses.
#pragma once

#include "mneme/base.h"
#include "mneme/path.h"
#include "mneme/pipeline.h"
#include "mneme/problem.h"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace mneme {

enum class StageKind {
  move,     ///< plans a path around obstacles
  line,     ///< moves a link on a straight line
  attach,   ///< a link takes an obstacle, which moves with it from now on
  detach,   ///< a held object becomes an obstacle where it is
  allow,    ///< pairs may touch from now on
  gripper,  ///< moves joints outside of the planning group
};
[[nodiscard]] std::string_view to_string(StageKind kind);

/// Alternative poses for a link, or for the object that it holds.
struct PoseChoice {
  std::string link;         ///< the link to bring there
  std::string object = {};  ///< held object whose poses these are; empty: they are the link's
  /// Link or obstacle whose frame the poses are given in; empty: the root link. An obstacle's frame
  /// is the pose of its first shape, or of its first mesh file if it was attached at the start with
  /// mesh files alone. A link's frame is taken at the task's start.
  std::string frame = {};
  std::vector<Transform> poses;
};

/// A configuration, or a region in the root link's frame.
using MoveGoal = std::variant<Configuration, PoseGoal>;

/// A stage of a task. Each kind uses the fields listed for it, and `name`.
struct Stage {
  StageKind kind = StageKind::move;
  std::string name = {};  ///< empty: its kind and number
  /// move: any one of these to end at. Without these and `poses`, a move ends where the next line
  /// begins.
  std::vector<MoveGoal> goals = {};
  /// move, line: poses to end at; any one of them.
  PoseChoice poses = {};
  /// line: the link to move. Default: the last link of the group.
  std::string link = {};
  /// line: unit vector in the frame of `along`. A line with poses may leave it 0 where its first
  /// configuration is known.
  Vec3 direction = Vec3::Zero();
  std::string along = {};    ///< line: link whose frame `direction` is in; empty: the root link
  double distance = 0;       ///< line: metres, > 0, with a direction
  std::string object = {};   ///< attach, detach: name of the obstacle
  std::string carrier = {};  ///< attach: link that takes the object
  std::vector<std::string> may_touch = {};  ///< attach: links that touch the object; the carrier
                                            ///< and links that no joint of the group moves against
                                            ///< it always may
  std::vector<std::pair<std::string, std::string>> pairs = {};  ///< allow
  std::map<std::string, double> values = {};                    ///< gripper: by joint
  std::vector<OrientationConstraint> constraints = {};          ///< move: in addition to the task's
  double speed = 1;   ///< move, line: share of the velocity limits, in (0, 1]
  bool stop = false;  ///< the robot stops at its end; else only where hand or fingers change
};

/// A robot, a scene, a start, and stages.
struct Task {
  std::string name = {};
  Robot robot;
  std::string robot_path = {};  ///< path of the URDF
  Scene scene = {};
  Configuration start = {};
  std::vector<Stage> stages;
  std::vector<OrientationConstraint> constraints = {};  ///< hold in each move and line
  /// As Problem::start_velocity: the first stage is a move then.
  std::vector<double> start_velocity = {};
  std::vector<std::string> warnings = {};
  std::vector<std::string> files = {};
};

/// `solve.plan` is for each move; its `improve` and `improve_rounds` stand for those of the task
/// that are not set.
struct TaskSettings {
  int branches = 4;
  int siblings = 8;
  std::uint64_t first_iterations = 2000;
  double improve = 0;
  std::optional<int> improve_plans = {};
  SolveSettings solve = {};
};

/// Declares the settings of this struct; `solve` declares its own.
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, TaskSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("branches", s.branches, 1, 64,
        "Largest number of configurations of inverse kinematics to try for a pose. More find plans "
        "in narrower places and take longer where there is none.");
  visit("siblings", s.siblings, 1, 1000000,
        "Paths that fail from one configuration before the search returns to the stage before.");
  visit("first-iterations", s.first_iterations, std::uint64_t{1}, ~std::uint64_t{0},
        "Iteration limit of each path in the first round. Each further round has eight times the "
        "limit, until the time limit.");
  visit("improve-task", s.improve, 0.0, 1e6,
        "Time to look for shorter plans of the task after the first one, seconds. Part of the time "
        "limit.");
  visit("improve-plans", s.improve_plans, 1, 1000000,
        "Largest number of plans that improvement compares. With a seed the result is repeatable. "
        "Default: as many as the time allows.");
}

/// Why alternatives were dropped.
enum class DropReason { reach, contact, place, kinematics, line, attach, world, path };
inline constexpr std::size_t kDropReasons = 8;
/// Returns "out of reach", "contact", "no place" (a grasp with which the object fits nowhere), "no
/// inverse kinematics", "no straight line", "not at the object", "no valid robot or scene" or "no
/// path". No valid robot or scene: after an attach, detach, allow or gripper stage.
[[nodiscard]] std::string_view to_string(DropReason reason);

/// Alternatives that were dropped at a stage for one reason.
struct Dropped {
  DropReason reason = DropReason::reach;
  /// Number of the stage's alternatives; for a stage without any, of the choice that it follows. An
  /// alternative counts once, also under several reasons.
  int count = 0;
  std::string what = {};  ///< the commonest obstacle of this reason, such as "'mug' with 'shelf'"
};

/// The motion of joints outside of the planning group in a gripper stage; the group rests.
struct GripperMotion {
  /// Robot that plans for these joints and the group; scene, start and goal.
  std::shared_ptr<const Problem> world;
  Path path;  ///< from the start straight to the goal
};

/// A stage of a plan. Scene and robot are those while it moves.
struct StageResult {
  std::string name;
  StageKind kind = StageKind::move;
  std::shared_ptr<const Problem> world;  ///< robot with held objects, scene, start of the stage;
                                         ///< never null
  Path path;  ///< from where the stage before ended; one configuration if nothing moves
  double path_time_s = 0;  ///< at the velocity limits of the URDF (path_time()) and its speed
  int alternative = -1;    ///< index of the goal or pose that was chosen; -1: there is no choice
  int alternatives = 0;    ///< number of goals and poses to choose from; goals count first
  std::vector<Dropped> dropped = {};
  std::uint64_t states_checked = 0;                   ///< for the path
  std::shared_ptr<const GripperMotion> gripper = {};  ///< null if no joint outside the group moves
};

struct TaskResult {
  PlanStatus status = PlanStatus::timeout;
  /// Why there is no plan: the stage and what is in its way; empty if solved.
  std::string message = {};
  /// All stages in order; of a task without a plan, those with alternatives that were dropped.
  std::vector<StageResult> stages = {};
  /// Sum of the stages' path times. The duration of the motion, with accelerations and stops, is
  /// that of TaskMotion::trajectory.
  double path_time_s = 0;
  double first_path_time_s = 0;   ///< of the first plan, before improvement
  double preparation_time_s = 0;  ///< making the collision checker; not part of the time limit
  double first_plan_time_s = 0;   ///< from then until the first plan
  double total_time_s = 0;
  std::uint64_t states_checked = 0;
  std::uint64_t iterations = 0, nodes = 0, motions_checked = 0;  ///< of all moves
  int plans = 0;                                                 ///< complete plans that were found
  int remembered_rows = 0;     ///< rows of memory that ranked the alternatives
  bool is_remembered = false;  ///< the choices are queued: Database::flush() waits for them
  std::vector<std::string> notes = {};

  [[nodiscard]] bool is_solved() const { return status == PlanStatus::solved; }
};

/// Checks a task without planning. Errors: no stages, or more than 1000; an unknown link, frame,
/// object or joint; a line without length; an object that is attached twice or detached but not
/// held; values out of range. The message names the stage.
[[nodiscard]] Result<void> check_task(const Task& task);

/// Chooses among the alternatives of the stages and plans the paths between them. Cheap tests come
/// first: reach, contact of the hand alone, inverse kinematics, contact, straight lines; paths are
/// planned last. With a `database`, alternatives that worked for the same object nearby come first,
/// moves use its experience, and a plan is remembered if SolveSettings::remember_after is set. The
/// time limit is that of `settings.solve.plan`. Errors: those of check_task() and check_settings();
/// a scene that cannot be checked.
[[nodiscard]] Result<TaskResult> solve_task(const Task& task, Database* database,
                                            const TaskSettings& settings = {});

/// The motion of a whole task.
struct TaskMotion {
  Trajectory trajectory;
  std::vector<double> begins_s;                   ///< per stage, see JoinedMotion
  std::vector<std::optional<Trajectory>> stages;  ///< per stage, each from 0 on; nothing for one
                                                  ///< without a path, which takes no time
};
/// Times the path of each stage within `limits`, velocities scaled by the stage's speed, and joins
/// them by join_motions(). Stops where a stage attaches, detaches, moves a gripper or has
/// Stage::stop, and where no blend is found. Joints of grippers keep the limits of `limits_file`,
/// as `find_rate_limits()` reads it. Precondition: `result` is a plan of `task`. Errors: those of
/// parameterize() and find_rate_limits().
[[nodiscard]] Result<TaskMotion> time_task(const Task& task, const TaskResult& result,
                                           const SolveSettings& settings, const RateLimits& limits,
                                           const TrajectorySettings& timing = {},
                                           const std::string& limits_file = {});

/// Returns when each stage begins, with the motions of gripper stages.
[[nodiscard]] std::vector<StageBegin> stage_begins(const TaskResult& result,
                                                   const TaskMotion& motion);

}  // namespace mneme
