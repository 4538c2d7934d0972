// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/path.h"

#include "path/path_conversion.h"
#include "path/sweep.h"
#include "path/path_conversion.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace mneme {
namespace {

constexpr double kTurnRounding = 1e-5;  ///< radians; more than single precision loses

}  // namespace

MotionVerifier::MotionVerifier(const CollisionChecker& checker, Verification verification,
                               std::function<bool()> must_stop)
    : checker_(checker), verification_(verification), must_stop_(std::move(must_stop)) {
  // Links of planar arms are so thin that they pass through each other between two states, however
  // close.
  const bool is_thin = verification == Verification::states && checker.robot().is_planar();
  if (verification == Verification::motions || is_thin) {
    sweep_ =
        std::make_shared<const internal::Sweep>(checker.robot(), checker.scene(), checker.margin());
  }
}

bool MotionVerifier::is_free(std::span<const float> from, std::span<const float> to, bool is_at_end,
                             CheckCounters& counters) const {
  return is_free(Configuration(from.begin(), from.end()), Configuration(to.begin(), to.end()),
                 is_at_end, counters);
}

bool MotionVerifier::is_free(std::span<const double> from, std::span<const double> to,
                             bool is_at_end, CheckCounters& counters) const {
  if (verification_ == Verification::none) return true;
  return has_one_way(from, to) && are_states_free(from, to, is_at_end, counters) &&
         (!sweep_ || sweep_->is_free(from, to, must_stop_));
}

bool MotionVerifier::has_one_way(std::span<const double> from, std::span<const double> to) const {
  const Robot& robot = checker_.robot();
  const Configuration delta = robot.difference(from, to);
  for (int i = 0; i < robot.joint_count(); ++i) {
    const bool is_continuous = robot.group_joint(i).type == JointType::continuous;
    const double turn = std::abs(delta[static_cast<std::size_t>(i)]);
    if (is_continuous && turn > std::numbers::pi - kTurnRounding) return false;
  }
  return true;
}

bool MotionVerifier::are_states_free(std::span<const double> from, std::span<const double> to,
                                     bool is_at_end, CheckCounters& counters) const {
  const std::vector<float> begin = internal::to_floats(from), end = internal::to_floats(to);
  const auto has_margin = [&](const std::vector<float>& q) {
    return checker_.is_motion_valid(q, q, counters, {1, kVerificationMargin});
  };
  const double margin =
      is_at_end && !(has_margin(begin) && has_margin(end)) ? 0.0 : kVerificationMargin;
  return checker_.is_motion_valid(begin, end, counters, {kVerificationRefinement, margin});
}

bool MotionVerifier::is_curve_free(std::span<const float> states, CheckCounters& counters) const {
  if (verification_ == Verification::none) return true;
  if (!checker_.are_states_valid(states, counters, kVerificationMargin)) return false;
  const auto joints = static_cast<std::size_t>(checker_.robot().joint_count());
  for (std::size_t i = joints; sweep_ && i < states.size(); i += joints) {
    const auto from = states.subspan(i - joints, joints), to = states.subspan(i, joints);
    if (!sweep_->is_free(Configuration(from.begin(), from.end()),
                         Configuration(to.begin(), to.end()), must_stop_)) {
      return false;
    }
  }
  return true;
}

int MotionVerifier::find_invalid_motion(const Path& path, CheckCounters& counters) const {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const bool is_at_end = i == 1 || i + 1 == path.size();
    if (!is_free(path[i - 1], path[i], is_at_end, counters)) return static_cast<int>(i) - 1;
  }
  return -1;
}

int find_invalid_motion(const CollisionChecker& checker, const Path& path, CheckCounters& counters,
                        Verification verification) {
  return MotionVerifier(checker, verification).find_invalid_motion(path, counters);
}

}  // namespace mneme
