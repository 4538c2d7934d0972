// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Straight lines of a link: paths that keep the link on a line, with proven bounds on the
/// deviation.
#pragma once

#include "mneme/base.h"
#include "mneme/collision.h"
#include "mneme/path.h"
#include "mneme/problem.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include <atomic>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace mneme {

/// A straight motion of a link. The origin of the link moves along a segment at even speed, and the
/// link turns about one axis at even speed, or keeps its rotation.
struct Line {
  /// Link that moves. Empty: the only tip of the planning group (find_tips()).
  std::string link = {};
  /// Link whose frame at the line's start `displacement` and `target` are in. Empty: the root link.
  /// The moved link itself: along its own axes.
  std::string frame = {};
  /// Motion of the link's origin, metres; the link keeps its rotation. Not used with a `target`.
  Vec3 displacement = Vec3::Zero();
  /// Pose of the link where the line ends.
  std::optional<Transform> target = {};
  /// With a `target`: keeps the rotation of the start, so that only the target's origin counts.
  bool keeps_rotation = false;
  /// Axis of the link, such as that of a round tool, about which the link may turn freely.
  std::optional<Axis> free_axis = {};
  /// Pose of the link, in the root link's frame, where the line starts. All branches of inverse
  /// kinematics at this pose are tried. Unset: the line starts at a given configuration.
  std::optional<Transform> start = {};
  double position_tolerance = 1e-4;                ///< Largest deviation, metres, at least 1e-6.
  double rotation_tolerance = 0.1 * 0.0174532925;  ///< Largest deviation, radians, at least 1e-5.
};

struct LineSettings {
  double timeout_s = 1;
  int line_steps = 1000;
  int line_paths = 1;
  std::uint64_t seed = 1;
  /// False leaves LineResult::reason empty, for callers that only try: saves most of the time of a
  /// line that is not possible.
  bool has_reason = true;
  const std::atomic<bool>* cancel = nullptr;  ///< May be null.
};

/// Declares each setting once: name, range, meaning.
template <class Settings, class Visitor>
requires std::same_as<std::remove_const_t<Settings>, LineSettings>
void visit_settings(Settings& s, Visitor&& visit) {
  visit("timeout", s.timeout_s, 0.0, 1e6, "Time limit, seconds.");
  visit("line-steps", s.line_steps, 1, 100000000,
        "Largest number of steps along the line, over all branches. More search for longer before "
        "a line counts as impossible.");
  visit("line-paths", s.line_paths, 1, 1000,
        "Number of whole paths, each from another start configuration, that ends the search.");
  visit("seed", s.seed, std::uint64_t{0}, ~std::uint64_t{0}, "Seed of all random numbers.");
}

/// A path along a line, or along its first part.
struct LinePath {
  Path path;  ///< Joined by straight motions of the joints. Empty if the line cannot start.
  std::vector<double> fractions;  ///< Share of the line at each waypoint, from 0 on.
  /// Proven bounds everywhere on the path. On the motion from waypoint i to i + 1, the pose of the
  /// line moves from fractions[i] to fractions[i + 1] at even speed; the link is this near to it.
  double position_deviation = 0;  ///< Metres.
  double rotation_deviation = 0;  ///< Radians, of the free axis if there is one.

  [[nodiscard]] double fraction() const { return fractions.empty() ? 0 : fractions.back(); }
};

struct LineResult {
  LinePath line;                      ///< Whole, or the longest part that was found.
  std::vector<LinePath> others = {};  ///< Further whole paths, if settings ask for several.
  Transform begin, end;               ///< Poses of the link at the line's ends, in the root frame.
  /// Why the rest of the line is not possible, such as "branch ends after 12 cm: joint 'j4' at its
  /// limit". Empty for a whole line.
  std::string reason = {};
  /// The scene with pairs that are checked by exact geometry, because their spheres alone touch at
  /// the start; nothing if there are none. `notes` has a sentence for each.
  std::optional<Scene> scene = {};
  std::vector<std::string> notes = {};
  int branches = 0;  ///< Number of start configurations.
  int steps = 0;     ///< Number of steps along the line.
  CheckCounters checks = {};
  bool is_cancelled = false, is_timed_out = false;

  [[nodiscard]] bool is_whole() const { return line.fraction() == 1; }
};

/// Finds a path whose link stays on a line, within the joint limits and proven free as paths of
/// solve() are. The path follows one branch of inverse kinematics. Joints that are not needed move
/// away from limits, or around contacts. `from` is the configuration where the line starts. If
/// Line::start is set, `from` gives the values of joints that do not move the link, and branches
/// near `from` are tried first.
///
/// Not an error: a line that is only possible in part, or a `from` that is no configuration of the
/// robot, with which no line begins. LineResult::reason says why.
/// Where spheres alone touch at the start, these pairs are checked by exact geometry, as in
/// solve(). The result depends on the arguments alone, except through the time limit.
/// Errors: a link or frame that the robot lacks; no single tip; numbers that are not finite; a line
/// of no length or of more than 100 m; tolerances or settings out of range. Also fewer than six
/// joints that move the link, or five with a free axis, and orientation constraints.
[[nodiscard]] Result<LineResult> plan_line(const CollisionChecker& checker, const Line& line,
                                           std::span<const double> from,
                                           const LineSettings& settings = {});
/// As above, with a checker made for this call.
[[nodiscard]] Result<LineResult> plan_line(const Robot& robot, const Scene& scene, const Line& line,
                                           std::span<const double> from,
                                           const LineSettings& settings = {});

}  // namespace mneme
