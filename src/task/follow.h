// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Straight lines of a stage, which may begin or end in contact of a held object.
#pragma once

#include "mneme/collision.h"
#include "mneme/line.h"

#include "line/floating_body.h"
#include "pipeline/query.h"
#include "task/world.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>

namespace mneme::internal {

/// A world with its checker. Immutable.
struct CheckedWorld {
  World world;
  CollisionChecker checker;  ///< its scene may have more exact pairs than the world's
};
using CheckedWorldPtr = std::shared_ptr<const CheckedWorld>;

/// State that every step of a search over alternatives needs.
struct TaskRun {
  const Task& task;
  const TaskSettings& settings;
  std::vector<Transform> start_poses = {};  ///< of links at the task's start
  Stopwatch stopwatch = {};
  double end_s = settings.solve.plan.timeout_s;  ///< of the search, on the stopwatch
  std::uint64_t states = 0;                      ///< checked so far, without moves
  int round = 0;                                 ///< of the search: later ones try harder
  bool has_tried = false;                        ///< a test that a later round would repeat harder

  /// Seeds of inverse kinematics per alternative in this round.
  [[nodiscard]] int seeds() const { return 16 << std::min(2 * round, 16); }
  /// Steps along a line before it counts as impossible in this round.
  [[nodiscard]] int line_steps() const { return round == 0 ? 40 : LineSettings().line_steps; }
  /// The first round asks spheres alone.
  [[nodiscard]] BodySettings body_settings() const { return {settings.solve.isa, round > 0}; }
  /// Solutions to try per alternative in this round.
  [[nodiscard]] int branches() const {
    return round == 0 ? std::min(2, settings.branches) : settings.branches;
  }

  [[nodiscard]] CheckerSettings checker_settings() const {
    return checker_settings_of(settings.solve);
  }
  /// True if a pair of the world may touch at the end of a line: a held object or one that the
  /// scene names.
  [[nodiscard]] bool may_touch_at_ends(const World& world) const;
  [[nodiscard]] bool is_cancelled() const;
  [[nodiscard]] bool is_over() const;
  [[nodiscard]] double remaining_s() const;
};

[[nodiscard]] Result<CheckedWorldPtr> check_world(World world, const TaskRun& run);
/// check_world(), or null once the call is cancelled.
[[nodiscard]] Result<CheckedWorldPtr> check_unless_cancelled(World world, const TaskRun& run);

/// Why an alternative fails at a stage.
struct Failure {
  DropReason reason = DropReason::contact;
  std::string what = {};
};

/// The line of a link from `q` to `X_WL`.
struct LineTask {
  std::string link;
  Configuration q;
  Transform X_WL;          ///< pose of the link at the other end
  bool is_start = true;    ///< false: the path will be reversed, `q` is where it ends
  bool has_reason = true;  ///< the failure names bodies, which costs more than the test
};

/// True if the robot may be at `q`: free, by exact geometry where spheres touch, or in contact that
/// a line may leave.
[[nodiscard]] bool may_stand(TaskRun& run, const CheckedWorldPtr& world, const Configuration& q);

struct FollowedLine {
  CheckedWorldPtr world;                  ///< as checked
  Path path;                              ///< from `q` on, or up to `q` unless LineTask::is_start
  std::vector<std::string> touches = {};  ///< contacts at `q`, for people
};
/// Returns the path of the line, proven free, or why there is none. If a held object touches
/// something at `q`, the first motion from there leaves the contact within allow-at-ends.
[[nodiscard]] tl::expected<FollowedLine, Failure> follow_line(TaskRun& run,
                                                              const CheckedWorldPtr& world,
                                                              const LineTask& line);

/// Returns "'panda_hand' with 'shelf'", the deepest contact at `q`.
[[nodiscard]] std::string describe_contact(const CollisionChecker& checker, const Configuration& q);

}  // namespace mneme::internal
