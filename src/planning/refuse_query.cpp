// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/planning.h"

#include "path/path_conversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace mneme {
namespace {

bool is_near(const Contact& contact) { return contact.distance >= 0; }

/// Contacts first, then what is only within the margin.
std::string describe_contacts(std::vector<Contact> contacts, double margin) {
  constexpr std::size_t kMostNamed = 4;
  std::stable_partition(contacts.begin(), contacts.end(), std::not_fn(is_near));
  std::string text = is_near(contacts.front())
                         ? fmt::format(" is within the margin of {:.4g} m: ", margin)
                         : " is in contact: ";
  for (std::size_t i = 0; i < std::min(contacts.size(), kMostNamed); ++i) {
    const Contact& contact = contacts[i];
    text += fmt::format(
        "{}link '{}' {} {} '{}'", i == 0 ? "" : ", ", contact.link,
        is_near(contact) ? fmt::format("is {:.2g} m from", contact.distance) : "touches",
        contact.is_self ? "link" : "obstacle", contact.other);
    if (!is_near(contact)) text += fmt::format(" by {:.2g} mm", -1e3 * contact.distance);
  }
  if (contacts.size() > kMostNamed)
    text += fmt::format(" and {} more", contacts.size() - kMostNamed);
  return text;
}

/// What `q`, a configuration of the robot, is in contact with, or nothing. The kernels decide,
/// because they are what the planner sees; exact distances, which cost a thousand times more, have
/// their say close to contact.
std::optional<std::string> find_contact(const CollisionChecker& checker, const Configuration& q) {
  const Configuration inside = checker.robot().normalized(q);
  const std::vector<float> values = internal::to_floats(inside);
  CheckCounters ignored;
  if (checker.is_motion_valid(values, values, ignored, {1, kVerificationMargin})) {
    return std::nullopt;
  }
  const std::vector<Contact> contacts = checker.contacts(inside);
  if (!contacts.empty()) return describe_contacts(contacts, checker.margin());
  if (!checker.is_valid(std::span<const float>(values))) {
    return " is within rounding error of contact";
  }
  return std::nullopt;
}

/// Which constraint `q` breaks, or nothing.
std::optional<std::string> find_tilt(const CollisionChecker& checker, const Configuration& q) {
  const Configuration inside = checker.robot().normalized(q);
  for (const OrientationConstraint& constraint : checker.constraints()) {
    const double leaning = tilt(checker.robot(), constraint, inside);
    if (leaning <= constraint.angle - kTiltMargin) continue;
    return fmt::format(": {} is tilted by {:.5g} rad, the constraint allows {:.5g}",
                       constraint.link, leaning, constraint.angle);
  }
  return std::nullopt;
}

/// Why `q` cannot be planned from or to, or nothing.
std::optional<std::string> find_problem(const CollisionChecker& checker, const Configuration& q,
                                        const std::string& what) {
  if (auto violation = checker.robot().describe_violation(q, what)) return violation;
  if (const auto tilt = find_tilt(checker, q)) return what + *tilt;
  auto contact = find_contact(checker, q);
  if (!contact) return std::nullopt;
  return what + *std::move(contact);
}

std::string name_of_goal(std::size_t goal, std::size_t count) {
  return count == 1 ? "goal" : fmt::format("goal {}", goal);
}

PlanResult refusal(PlanStatus status, std::string message) {
  PlanResult result;
  result.status = status;
  result.message = std::move(message);
  return result;
}

}  // namespace

std::optional<PlanResult> refuse_query(const CollisionChecker& checker, const PlanQuery& query) {
  if (auto problem = find_problem(checker, query.start, "start")) {
    return refusal(PlanStatus::invalid_start, *std::move(problem));
  }
  if (query.goals.empty()) return refusal(PlanStatus::invalid_goal, "there is no goal");
  for (std::size_t i = 0; i < query.goals.size(); ++i) {
    const std::string what = name_of_goal(i, query.goals.size());
    if (auto problem = find_problem(checker, query.goals[i], what)) {
      return refusal(PlanStatus::invalid_goal, *std::move(problem));
    }
  }
  return std::nullopt;
}

std::vector<std::string> drop_goals_in_contact(const CollisionChecker& checker,
                                               std::vector<Configuration>& goals) {
  if (goals.size() == 1) return {};
  std::vector<std::string> notes;
  std::vector<Configuration> kept;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const bool is_sound = !checker.robot().describe_violation(goals[i], "goal");
    const auto contact = is_sound ? find_contact(checker, goals[i]) : std::nullopt;
    if (contact) {
      notes.push_back(name_of_goal(i, goals.size()) + *contact + ": left out");
    } else {
      kept.push_back(goals[i]);
    }
  }
  if (kept.empty()) return {};
  goals = std::move(kept);
  return notes;
}

}  // namespace mneme
