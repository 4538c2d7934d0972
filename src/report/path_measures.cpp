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

/// L2 joint distance between the samples.
constexpr double kStep = 1.0 / 32;
constexpr double kPlanarStep = 0.02;
/// A link moves at most about this far from a sample before the next one is nearer, metres: samples
/// that are farther from obstacles than the nearest one by more are not refined.
constexpr double kReach = 0.02;
/// Parts into which the intervals around a sample are divided, and how often.
constexpr int kParts = 8, kRefinements = 3;

class ClearanceSearch {
 public:
  ClearanceSearch(const Robot& robot, const Scene& scene, const Path& path)
      : robot_(robot),
        path_(path),
        links_(robot),
        obstacles_(internal::obstacle_shapes(robot, scene)) {}

  [[nodiscard]] Clearance least() {
    if (obstacles_.empty() || path_.empty()) return nearest_;
    sample();
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      if (is_dip(i) && samples_[i].distance < nearest_.distance + kReach) refine(i);
    }
    return nearest_;
  }

 private:
  /// A place on the path: number of a motion plus the fraction of it.
  struct Sample {
    double place = 0;
    double distance = 0;  ///< metres; any larger value far from the nearest
  };

  void sample() {
    samples_.push_back({0, measure(0)});
    const double step = robot_.is_planar() ? kPlanarStep : kStep;
    for (std::size_t i = 1; i < path_.size(); ++i) {
      const int count =
          std::max(1, static_cast<int>(std::ceil(robot_.distance(path_[i - 1], path_[i]) / step)));
      for (int k = 1; k <= count; ++k) {
        const double place = static_cast<double>(i - 1) + static_cast<double>(k) / count;
        samples_.push_back({place, measure(place)});
      }
    }
  }

  /// Metres from the obstacles; exact up to the least so far and kReach, otherwise any larger
  /// value.
  double measure(double place) {
    internal::poll_interrupt();
    const auto last = static_cast<double>(path_.size() - 1);
    const double motion = std::clamp(std::floor(place), 0.0, std::max(0.0, last - 1));
    const auto i = static_cast<std::size_t>(motion);
    const Configuration& to = path_[std::min(i + 1, path_.size() - 1)];
    const Configuration q = internal::interpolate(robot_, path_[i], to, place - motion);
    const auto found = internal::find_clearance(links_, links_.posed(robot_.link_poses(q)),
                                                obstacles_, nearest_.distance + kReach);
    if (found.link >= 0 && found.distance < nearest_.distance) nearest_ = found;
    return found.distance;
  }

  /// True if the sample is nearer than its neighbours.
  [[nodiscard]] bool is_dip(std::size_t i) const {
    const double distance = samples_[i].distance;
    return (i == 0 || distance < samples_[i - 1].distance) &&
           (i + 1 == samples_.size() || distance <= samples_[i + 1].distance);
  }

  /// Closes in on the least distance between the neighbours of a sample.
  void refine(std::size_t i) {
    Sample least = samples_[i];
    double before = i == 0 ? 0 : least.place - samples_[i - 1].place;
    double after = i + 1 == samples_.size() ? 0 : samples_[i + 1].place - least.place;
    for (int round = 0; round < kRefinements; ++round) {
      const double middle = least.place;
      for (int k = -kParts; k <= kParts; ++k) {
        const double place =
            std::clamp(middle + (k < 0 ? before : after) * k / kParts, 0.0, samples_.back().place);
        const double distance = measure(place);
        if (distance < least.distance) least = {place, distance};
      }
      before /= kParts;
      after /= kParts;
    }
  }

  const Robot& robot_;
  const Path& path_;
  internal::LinkDistances links_;
  std::vector<internal::ObstacleShape> obstacles_;
  std::vector<Sample> samples_;
  Clearance nearest_{std::numeric_limits<double>::infinity(), -1, -1};
};

}  // namespace

PathMeasures measure_path(const Robot& robot, const Scene& scene, const Path& path) {
  PathMeasures measures;
  if (path.empty()) return measures;
  measures.length = path_length(robot, path);
  measures.straight = robot.distance(path.front(), path.back());
  const Clearance clearance = ClearanceSearch(robot, scene, path).least();
  if (clearance.link < 0) return measures;
  measures.clearance = {clearance.distance, robot.links()[internal::as_index(clearance.link)].name,
                        scene.obstacles[internal::as_index(clearance.obstacle)].name};
  return measures;
}

}  // namespace mneme
