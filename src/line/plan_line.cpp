// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/line.h"
#include "mneme/goal.h"
#include "mneme/planning.h"

#include "base/as_index.h"
#include "base/check_ranges.h"
#include "base/fail.h"
#include "check/end_motions.h"
#include "check/link_distances.h"
#include "geometry/solids.h"
#include "line/line_search.h"
#include "planning/end_contacts.h"
#include "robot/kinematics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mneme {
namespace {

using internal::JointVector;
using internal::LineStop;

constexpr double kDegree = std::numbers::pi / 180;
/// Metres and radians below which a line has no length.
constexpr double kLeastLength = 1e-6;
constexpr double kFarthest = 100;  // metres
/// Half a turn has no unique axis.
constexpr double kMostAngle = std::numbers::pi - 1e-3;

std::string describe_place(const internal::LineSegment& segment, double s) {
  return segment.length() > kLeastLength
             ? fmt::format("{:.1f} of {:.1f} cm", 100 * s * segment.length(),
                           100 * segment.length())
             : fmt::format("{:.1f} of {:.1f} degrees", s * segment.angle() / kDegree,
                           segment.angle() / kDegree);
}

/// One call of plan_line().
class LinePlan {
 public:
  LinePlan(const CollisionChecker& checker, const Line& line, std::span<const double> from,
           const LineSettings& settings)
      : checker_(checker),
        robot_(checker.robot()),
        line_(line),
        from_(from.begin(), from.end()),
        settings_(settings) {}

  Result<LineResult> run() {
    MNEME_TRY(check());
    if (const auto violation = robot_.describe_violation(from_, "start")) {
      result_.reason = *violation;
      if (internal::is_near_limits(robot_, from_, EndTolerances())) {
        result_.reason += "; a line leads no start inside its limits: plan a motion there first";
      }
      return std::move(result_);
    }
    MNEME_TRY(find_ends());
    const auto chain =
        MNEME_TRY(internal::LinkChain::make(robot_, robot_.links()[link_].name, line_.free_axis));
    const std::vector<Configuration> starts = find_starts();
    const internal::LineSegment segment(result_.begin, result_.end);
    internal::LineTracker tracker(chain, segment, checker_,
                                  {line_.position_tolerance, line_.rotation_tolerance});
    internal::LineSearch search(tracker, checker_, start_region(), settings_);
    search.run(settled(starts, search, tracker), line_.start.has_value());
    finish(search, tracker);
    return std::move(result_);
  }

 private:
  template <class... Args>
  static tl::unexpected<Error> refuse(fmt::format_string<Args...> what, Args&&... args) {
    return fail(ErrorCode::invalid, fmt::format(what, std::forward<Args>(args)...));
  }

  Result<void> check() {
    MNEME_TRY(internal::check_ranges(settings_));
    if (!checker_.constraints().empty()) {
      return fail(ErrorCode::unsupported,
                  "lines are planned without orientation constraints: the line itself keeps the "
                  "rotation");
    }
    if (!(line_.position_tolerance >= 1e-6 && line_.position_tolerance <= 1)) {
      return refuse("the line's position tolerance is {} m: expected 1e-6 to 1",
                    line_.position_tolerance);
    }
    if (!(line_.rotation_tolerance >= 1e-5 && line_.rotation_tolerance <= 1)) {
      return refuse("the line's rotation tolerance is {} rad: expected 1e-5 to 1",
                    line_.rotation_tolerance);
    }
    return find_link();
  }

  Result<void> find_link() {
    std::string name = line_.link;
    if (name.empty()) {
      const std::vector<std::string> tips = find_tips(robot_);
      if (tips.size() != 1) {
        return refuse("the group of robot {} has {} tips ({}): expected the line's link",
                      robot_.name(), tips.size(), fmt::join(tips, ", "));
      }
      name = tips.front();
    }
    link_ = internal::as_index(MNEME_TRY(index_of(name, "link")));
    return {};
  }

  [[nodiscard]] Result<int> index_of(const std::string& name, const char* what) const {
    const auto found = robot_.find_link(name);
    if (found) return *found;
    std::vector<std::string> names;
    for (const Link& link : robot_.links()) names.push_back(link.name);
    return refuse("the line's {} \"{}\" is no link of robot {}{}", what, name, robot_.name(),
                  did_you_mean(name, names));
  }

  static bool is_pose(const Transform& pose) {
    return pose.translation.allFinite() && internal::is_rotation(pose.rotation);
  }

  /// The frame of the line, in the root link's frame.
  [[nodiscard]] Result<Transform> find_frame(const std::vector<Transform>& poses) const {
    if (line_.frame.empty()) return Transform{};
    const auto known = robot_.find_frame(line_.frame);
    if (known == 0 || (!known && line_.frame == "world")) return Transform{};
    const auto frame = internal::as_index(MNEME_TRY(index_of(line_.frame, "frame")));
    if (frame == link_) return result_.begin;
    return line_.start ? find_frame_at_pose(frame, poses) : poses[frame];
  }

  /// The frame where only the link's pose is known, and not the joints.
  [[nodiscard]] Result<Transform> find_frame_at_pose(std::size_t frame,
                                                     const std::vector<Transform>& poses) const {
    Configuration other = from_;
    for (std::size_t j = 0; j < other.size(); ++j) other[j] += 0.1 + 0.01 * static_cast<double>(j);
    const std::vector<Transform> moved = robot_.link_poses(other);
    if (is_same(poses[frame], moved[frame])) return poses[frame];
    const Transform X_LF = poses[link_].inverse() * poses[frame];
    if (is_same(X_LF, moved[link_].inverse() * moved[frame])) return result_.begin * X_LF;
    return refuse(
        "the line's frame \"{}\" moves with the joints: for a line from a pose, expected a link "
        "that is fixed to the base or to link \"{}\"",
        line_.frame, robot_.links()[link_].name);
  }

  static bool is_same(const Transform& a, const Transform& b) {
    return (a.translation - b.translation).norm() < 1e-9 && (a.rotation - b.rotation).norm() < 1e-9;
  }

  Result<void> find_ends() {
    const std::vector<Transform> poses = robot_.link_poses(from_);
    result_.begin = line_.start.value_or(poses[link_]);
    const bool is_finite = line_.target ? is_pose(*line_.target) : line_.displacement.allFinite();
    if (!is_finite || !is_pose(result_.begin)) {
      return refuse(
          "expected finite numbers and rotations with orthonormal columns as the line's "
          "{}",
          is_finite      ? "start"
          : line_.target ? "target"
                         : "displacement");
    }
    const Transform X_RF = MNEME_TRY(find_frame(poses));
    result_.end = result_.begin;
    if (line_.target) {
      result_.end = X_RF * *line_.target;
      if (line_.keeps_rotation) result_.end.rotation = result_.begin.rotation;
      if (line_.free_axis) turn_freely();
    } else {
      result_.end.translation += X_RF.rotation * line_.displacement;
    }
    return check_length();
  }

  /// Turns the end about the free axis to where it is nearest to the begin.
  void turn_freely() {
    const Vec3 axis = Vec3::Unit(static_cast<int>(*line_.free_axis));
    const Eigen::Matrix3d turn = result_.begin.rotation.transpose() * result_.end.rotation;
    Eigen::Matrix3d cross;
    cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
    // The trace of turn * rotation_about(axis, angle) is largest there.
    const double angle = std::atan2((turn * cross).trace(), turn.trace() - axis.dot(turn * axis));
    result_.end.rotation = result_.end.rotation * rotation_about(axis, angle);
  }

  Result<void> check_length() const {
    const Eigen::Matrix3d turn = result_.end.rotation * result_.begin.rotation.transpose();
    if (turn.trace() < 1 + 2 * std::cos(kMostAngle)) {
      return refuse(
          "the target turns link \"{}\" by half a turn, about no unique axis: divide the "
          "line in two",
          robot_.links()[link_].name);
    }
    const internal::LineSegment segment(result_.begin, result_.end);
    if (!(segment.length() <= kFarthest)) {
      return refuse("the line of link \"{}\" is {:.4g} m long: expected metres, at most {}",
                    robot_.links()[link_].name, segment.length(), kFarthest);
    }
    if (segment.length() < kLeastLength && segment.angle() < kLeastLength) {
      return refuse(
          "the line of link \"{}\" has no length: expected a displacement, or a target "
          "other than the pose at the start",
          robot_.links()[link_].name);
    }
    return {};
  }

  [[nodiscard]] PoseGoal start_region() const {
    PoseGoal goal;
    goal.link = robot_.links()[link_].name;
    goal.pose = result_.begin;
    if (line_.free_axis) {
      goal.axis = *line_.free_axis;
      goal.turn = std::numbers::pi;
    }
    return goal;
  }

  /// Start configurations; without any, writes the reason.
  std::vector<Configuration> find_starts() {
    if (!line_.start) {
      check_exactly(from_);
      if (checker_.is_valid(std::span<const double>(from_))) return {from_};
      const JointVector q = internal::to_vector(from_);
      result_.reason = "the line cannot start: " + describe_contact(q, q) + advise_on_held();
      return {};
    }
    IkSettings settings;
    settings.seeds = 512;
    settings.solutions = 16;
    settings.apart = 0.2;
    settings.seed = settings_.seed;
    const PoseGoal region = start_region();
    auto source = PoseGoalSource::make(checker_, {&region, 1}, from_, settings, 0);
    std::vector<Configuration> starts = source->find_all();
    if (!starts.empty()) return starts;
    const auto kinematics = InverseKinematics::make(robot_, region.link, checker_.isa());
    for (Configuration& q : kinematics->solve(region, from_, settings).solutions) {
      if (check_exactly(q)) starts.push_back(std::move(q));
    }
    if (starts.empty()) result_.reason = "the line cannot start: " + source->describe_failure();
    return starts;
  }

  /// Checks pairs by exact geometry whose spheres alone touch at `q`. Returns true if `q` is valid.
  bool check_exactly(const Configuration& q) {
    if (checker_.is_valid(std::span<const double>(q))) return true;
    const auto made = internal::make_end_checker(
        checker_, {checker_.resolution(), checker_.margin(), checker_.isa(), {}}, q,
        internal::kLineClearance);
    if (!made || made->notes.empty()) return false;
    checker_ = made->checker;
    result_.notes.insert(result_.notes.end(), made->notes.begin(), made->notes.end());
    result_.scene = checker_.scene();
    return checker_.is_valid(std::span<const double>(q));
  }

  /// The starts that the search begins at.
  std::vector<JointVector> settled(const std::vector<Configuration>& starts,
                                   const internal::LineSearch& search,
                                   const internal::LineTracker& tracker) {
    std::vector<JointVector> states;
    for (const Configuration& q : starts) {
      JointVector state = search.with_free_axis(q, 0);
      if (!line_.start || tracker.settle(0, state)) states.push_back(state);
    }
    result_.branches = static_cast<int>(states.size());
    if (states.empty() && result_.reason.empty()) {
      result_.reason = "the line cannot start: its pose is too near to a singularity";
    }
    return states;
  }

  void finish(const internal::LineSearch& search, internal::LineTracker& tracker) {
    result_.steps = search.steps();
    result_.checks = tracker.checks();
    result_.is_cancelled = search.is_cancelled();
    result_.is_timed_out = search.is_timed_out();
    std::vector<LinePath> whole = search.whole();
    if (!whole.empty()) {
      result_.line = std::move(whole.front());
      result_.others.assign(std::make_move_iterator(whole.begin() + 1),
                            std::make_move_iterator(whole.end()));
      return;
    }
    result_.line = search.farthest();
    if (result_.branches == 0 || !settings_.has_reason) return;
    result_.reason = fmt::format(
        "{} after {}: {}",
        result_.branches == 1 ? "branch ends"
                              : fmt::format("the longest of {} branches ends", result_.branches),
        describe_place(tracker.segment(), result_.line.fraction()), describe(search.stop()));
  }

  [[nodiscard]] std::string describe(const LineStop& stop) const {
    switch (stop.kind) {
      case LineStop::Kind::limit:
        return describe_limit(stop);
      case LineStop::Kind::contact:
        return describe_contact(stop.from, stop.to);
      case LineStop::Kind::kinematics:
        return describe_kinematics();
      case LineStop::Kind::budget:
      case LineStop::Kind::none:
        break;
    }
    return "the search was ended by its limits";
  }

  [[nodiscard]] std::string describe_limit(const LineStop& stop) const {
    const Joint& joint = robot_.group_joint(stop.joint);
    const bool is_lower = stop.to[stop.joint] < joint.lower;
    return fmt::format("joint '{}' at its {} limit of {:.4g} {}", joint.name,
                       is_lower ? "lower" : "upper", is_lower ? joint.lower : joint.upper,
                       joint.type == JointType::prismatic ? "m" : "rad");
  }

  [[nodiscard]] std::string describe_contact(const JointVector& from, const JointVector& to) const {
    constexpr double kNear = 1e-3;
    const internal::LinkDistances links(robot_);
    for (const double share : {1.0, 0.5}) {
      const JointVector state = from + share * (to - from);
      const Configuration q(state.data(), state.data() + robot_.joint_count());
      const auto contacts =
          internal::find_contacts(robot_, links, checker_.scene(), q, checker_.margin() + kNear);
      if (contacts.empty()) continue;
      const Contact& nearest = *std::ranges::min_element(contacts, {}, &Contact::distance);
      return fmt::format("contact of link '{}' with {} '{}'", nearest.link,
                         nearest.is_self ? "link" : "obstacle", nearest.other);
    }
    return "links come too close to each other";
  }

  /// The way out where a held object touches anything at the start.
  [[nodiscard]] std::string advise_on_held() const {
    for (const Contact& contact : checker_.contacts(robot_.normalized(from_))) {
      const std::string& held = robot_.is_attached(contact.link) ? contact.link : contact.other;
      if (!robot_.is_attached(held)) continue;
      return fmt::format(
          "; a line of a task may leave the contact of a held object: make this line the first "
          "stage of one, or put ['{}', '{}'] into `allow`",
          held, held == contact.link ? contact.other : contact.link);
    }
    return {};
  }

  /// Tells a line that leaves the reach from a singularity on it.
  [[nodiscard]] std::string describe_kinematics() const {
    const internal::LineSegment segment(result_.begin, result_.end);
    constexpr double kAhead = 0.005;
    PoseGoal goal = start_region();
    goal.pose = segment.at(std::min(1.0, result_.line.fraction() + kAhead / segment.size()));
    IkSettings settings;
    settings.seeds = 256;
    settings.solutions = 1;
    const auto kinematics = InverseKinematics::make(robot_, goal.link, checker_.isa());
    if (!kinematics->solve(goal, from_, settings).solutions.empty()) {
      return "the arm is at a singularity, and only other branches go on";
    }
    return fmt::format("the next poses are out of reach of link '{}'", goal.link);
  }

  CollisionChecker checker_;
  Robot robot_;
  const Line& line_;
  Configuration from_;
  LineSettings settings_;
  std::size_t link_ = 0;
  LineResult result_;
};

}  // namespace

Result<LineResult> plan_line(const CollisionChecker& checker, const Line& line,
                             std::span<const double> from, const LineSettings& settings) {
  return LinePlan(checker, line, from, settings).run();
}

Result<LineResult> plan_line(const Robot& robot, const Scene& scene, const Line& line,
                             std::span<const double> from, const LineSettings& settings) {
  const CollisionChecker checker = MNEME_TRY(CollisionChecker::make(robot, scene));
  return plan_line(checker, line, from, settings);
}

}  // namespace mneme
