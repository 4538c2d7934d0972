// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/threads.h"
#include "problem/moveit_problem.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>
#include <vector>

namespace mneme::internal {
namespace {

void refuse_constraints(const Input& constraints, std::initializer_list<std::string_view> keys,
                        std::string_view what) {
  for (const std::string_view key : keys) {
    if (!constraints.items(key).empty()) {
      constraints.at(key).fail(ErrorCode::unsupported, "{} are not supported; expected {}", key,
                               what);
    }
  }
}

double read_tolerance(const Input& constraint, std::string_view key) {
  const auto tolerance = constraint.find(key);
  if (!tolerance) return 0;
  const double value = tolerance->taking_angles().finite_number();
  if (value < 0) tolerance->fail_expecting("a tolerance of 0 or more");
  return value;
}

std::map<std::string, JointRange> read_goal(const Input& goal) {
  goal.allow_keys({"name", "joint_constraints", "position_constraints", "orientation_constraints",
                   "visibility_constraints"});
  refuse_constraints(goal, {"visibility_constraints"}, "a goal without them");
  std::map<std::string, JointRange> ranges;
  if (is_moveit_pose_goal(goal)) {
    refuse_constraints(goal, {"joint_constraints"},
                       "joint_constraints alone, or constraints of position and orientation");
    return ranges;
  }
  for (const Input& constraint : goal.items("joint_constraints")) {
    constraint.allow_keys(
        {"joint_name", "position", "tolerance_above", "tolerance_below", "weight"});
    const double position = constraint.at("position").taking_angles().finite_number();
    const JointRange range{position - read_tolerance(constraint, "tolerance_below"),
                           position + read_tolerance(constraint, "tolerance_above")};
    const Input joint = constraint.at("joint_name");
    if (!ranges.emplace(joint.text(), range).second) {
      joint.fail(ErrorCode::parse, "expected each joint once, got {} again", joint.text());
    }
  }
  if (ranges.empty()) goal.fail(ErrorCode::parse, "expected joint_constraints, got none");
  return ranges;
}

std::vector<Input> read_path_constraints(const Input& input) {
  constexpr std::string_view kSupported = "a path without constraints other than of orientation";
  std::vector<Input> constraints;
  const auto path = input.find_value("path_constraints");
  if (path) {
    refuse_constraints(*path, {"position_constraints", "visibility_constraints"}, kSupported);
    if (!path->items("joint_constraints").empty()) {
      path->fail(ErrorCode::unsupported, "joint_constraints are not supported here; expected {}",
                 kSupported);
    }
    constraints = path->items("orientation_constraints");
  }
  const auto trajectory = input.find_value("trajectory_constraints");
  if (trajectory && !trajectory->items("constraints").empty()) {
    trajectory->fail(ErrorCode::unsupported,
                     "trajectory_constraints are not supported; expected none");
  }
  return constraints;
}

}  // namespace

bool is_moveit_request(const Input& input) {
  return input.is_map() &&
         (input.find("goal_constraints") || input.find("start_state") || input.find("group_name"));
}

MoveitRequest read_moveit_request(const Input& input) {
  input.allow_keys({"workspace_parameters", "start_state", "goal_constraints", "path_constraints",
                    "trajectory_constraints", "reference_trajectories", "pipeline_id", "planner_id",
                    "group_name", "num_planning_attempts", "allowed_planning_time",
                    "max_velocity_scaling_factor", "max_acceleration_scaling_factor",
                    "cartesian_speed_limited_link", "cartesian_speed_end_effector_link",
                    "max_cartesian_speed"});
  MoveitRequest request;
  request.path_constraints = read_path_constraints(input);
  if (const auto group = input.find_value("group_name")) request.group = group->text();
  if (const auto start = input.find_value("start_state")) {
    request.start = read_moveit_state(*start);
  }
  request.goal_places = input.at("goal_constraints").items();
  for (const Input& goal : request.goal_places) request.goals.push_back(read_goal(goal));
  if (request.goals.empty()) input.at("goal_constraints").fail_expecting("at least one goal");
  return request;
}

namespace {

class AllowedReader {
 public:
  AllowedReader(const Input& matrix, const std::vector<std::string>& known,
                AllowedContacts& contacts)
      : matrix_(matrix), known_(known), contacts_(contacts) {}

  std::vector<std::string> read() {
    matrix_.allow_keys(
        {"entry_names", "entry_values", "default_entry_names", "default_entry_values"});
    read_entries();
    read_defaults();
    std::vector<std::string> notes;
    if (!unknown_.empty()) {
      notes.push_back(matrix_.place(fmt::format(
          "ignored, because there is no such link or object: {}", fmt::join(unknown_, ", "))));
    }
    if (!ambiguous_.empty()) {
      notes.push_back(matrix_.place(fmt::format("ignored, because names have two meanings: {}",
                                                fmt::join(ambiguous_, ", "))));
    }
    return notes;
  }

 private:
  void read_entries() {
    for (const Input& name : matrix_.items("entry_names")) names_.push_back(name.text());
    const std::vector<Input> rows = matrix_.items("entry_values");
    check_count(matrix_, rows.size(), "row");
    std::vector<std::vector<bool>> values;
    for (const Input& row : rows) values.push_back(read_row(row));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t j = i + 1; j < rows.size(); ++j) {
        if (values[i][j] != values[j][i]) {
          rows[j].fail(
              ErrorCode::parse,
              "expected a symmetric matrix of allowed collisions, got two values for {} and {}",
              names_[i], names_[j]);
        }
        if (values[i][j]) allow(names_[i], names_[j]);
      }
    }
  }

  void check_count(const Input& place, std::size_t count, std::string_view what) const {
    if (count != names_.size()) {
      place.fail(ErrorCode::parse, "expected one {} per name, got {} for {} names", what, count,
                 names_.size());
    }
  }

  /// A row is a list or, as in ROS messages, a map with the list `enabled`.
  std::vector<bool> read_row(const Input& row) const {
    std::vector<bool> values;
    for (const Input& value : row.is_map() ? row.at("enabled").items() : row.items()) {
      values.push_back(value.boolean());
    }
    check_count(row, values.size(), "value");
    return values;
  }

  void read_defaults() {
    const std::vector<Input> names = matrix_.items("default_entry_names");
    const std::vector<Input> values = matrix_.items("default_entry_values");
    if (names.size() != values.size()) {
      matrix_.fail(ErrorCode::parse, "expected one default value per name, got {} for {} names",
                   values.size(), names.size());
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string name = names[i].text();
      if (values[i].boolean() && !contacts_.knows(name)) unknown_.insert(name);
      defaults_[name] = values[i].boolean();
    }
    if (defaults_.empty()) return;
    allow_defaults();
  }

  /// Allows pairs without an entry by their defaults. Walks only pairs with a name that may be
  /// touched by default, in the order of the names.
  void allow_defaults() {
    const std::set<std::string> entered(names_.begin(), names_.end());
    std::vector<std::size_t> everything, touchable;
    for (std::size_t i = 0; i < known_.size(); ++i) {
      everything.push_back(i);
      if (is_touchable(known_[i])) touchable.push_back(i);
    }
    for (std::size_t i = 0; i < known_.size(); ++i) {
      poll_interrupt();
      const auto& others = is_touchable(known_[i]) ? everything : touchable;
      for (auto k = std::ranges::upper_bound(others, i); k != others.end(); ++k) {
        const std::string& other = known_[*k];
        const bool is_entered = entered.contains(known_[i]) && entered.contains(other);
        if (!is_entered && is_default(known_[i], other)) allow(known_[i], other);
      }
    }
  }

  [[nodiscard]] bool is_touchable(const std::string& name) const {
    const auto found = defaults_.find(name);
    return found != defaults_.end() && found->second;
  }

  [[nodiscard]] bool is_default(const std::string& a, const std::string& b) const {
    const auto of_a = defaults_.find(a), of_b = defaults_.find(b);
    if (of_a == defaults_.end()) return of_b != defaults_.end() && of_b->second;
    return of_a->second && (of_b == defaults_.end() || of_b->second);
  }

  void allow(const std::string& a, const std::string& b) {
    bool is_clear = true;
    for (const std::string& name : {a, b}) {
      const auto ambiguity = contacts_.find_ambiguity(name);
      if (ambiguity) ambiguous_.insert(*ambiguity);
      if (!contacts_.knows(name)) unknown_.insert(name);
      is_clear = is_clear && !ambiguity && contacts_.knows(name);
    }
    // A pair of such names is refused only if both are obstacles.
    if (is_clear) static_cast<void>(contacts_.allow({a, b, {}}));
  }

  const Input& matrix_;
  const std::vector<std::string>& known_;
  AllowedContacts& contacts_;
  std::vector<std::string> names_;
  std::map<std::string, bool> defaults_;
  std::set<std::string> unknown_, ambiguous_;
};

}  // namespace

std::vector<std::string> read_moveit_allowed(const Input& scene,
                                             const std::vector<std::string>& names,
                                             AllowedContacts& contacts) {
  const auto matrix = scene.find_value("allowed_collision_matrix");
  if (!matrix) return {};
  return AllowedReader(*matrix, names, contacts).read();
}

}  // namespace mneme::internal
