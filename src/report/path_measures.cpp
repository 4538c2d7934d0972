// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "check/link_distances.h"
#include "report/picture.h"
#include "robot/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme {
namespace {

using internal::Clearance;

/// L2 joint distance between the states that are measured, and the number of parts into which the
/// intervals beside the nearest of them are divided then.
constexpr double kStep = 1.0 / 32;
constexpr double kPlanarStep = 0.02;
constexpr int kRefinement = 16;

class ClearanceSearch {
 public:
  ClearanceSearch(const Robot& robot, const Scene& scene)
      : robot_(robot), links_(robot), obstacles_(internal::obstacle_shapes(robot, scene)) {}

  [[nodiscard]] Clearance along(const Path& path) {
    if (obstacles_.empty() || path.empty()) return nearest_;
    measure(path.front(), path.front(), 0);
    const double step = robot_.is_planar() ? kPlanarStep : kStep;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const int count =
          std::max(1, static_cast<int>(std::ceil(robot_.distance(path[i - 1], path[i]) / step)));
      for (int k = 1; k <= count; ++k) {
        if (measure(path[i - 1], path[i], static_cast<double>(k) / count)) step_ = 1.0 / count;
      }
    }
    refine();
    return nearest_;
  }

 private:
  /// Measures a state of a motion. Returns true if it is the nearest so far.
  bool measure(const Configuration& from, const Configuration& to, double fraction) {
    internal::poll_interrupt();
    const Configuration q = internal::interpolate(robot_, from, to, fraction);
    const auto found = internal::find_clearance(links_, links_.posed(robot_.link_poses(q)),
                                                obstacles_, nearest_.distance);
    if (found.link < 0) return false;
    nearest_ = found;
    from_ = from, to_ = to, fraction_ = fraction;
    return true;
  }

  void refine() {
    if (from_.empty()) return;
    const Configuration from = from_, to = to_;
    const double middle = fraction_;
    for (int k = -kRefinement; k <= kRefinement; ++k) {
      measure(from, to, std::clamp(middle + step_ * k / kRefinement, 0.0, 1.0));
    }
  }

  const Robot& robot_;
  internal::LinkDistances links_;
  std::vector<internal::ObstacleShape> obstacles_;
  Clearance nearest_{std::numeric_limits<double>::infinity(), -1, -1};
  Configuration from_, to_;
  double fraction_ = 0;
  double step_ = 0;  ///< fraction of the motion between two states
};

}  // namespace

PathMeasures measure_path(const Robot& robot, const Scene& scene, const Path& path) {
  PathMeasures measures;
  if (path.empty()) return measures;
  measures.length = path_length(robot, path);
  measures.straight = robot.distance(path.front(), path.back());
  const Clearance clearance = ClearanceSearch(robot, scene).along(path);
  if (clearance.link < 0) return measures;
  measures.clearance = {clearance.distance, robot.links()[internal::as_index(clearance.link)].name,
                        scene.obstacles[internal::as_index(clearance.obstacle)].name};
  return measures;
}

}  // namespace mneme
