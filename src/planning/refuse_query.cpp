// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/planning.h"

#include "base/as_index.h"
#include "base/threads.h"
#include "planning/end_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme {
namespace {

bool is_near(const Contact& contact) { return contact.distance >= 0; }

/// Two digits, and all of them from 100 mm on.
std::string millimetres(double metres) {
  const double length = 1e3 * metres;
  return length < 99.5 ? fmt::format("{:.2g} mm", length) : fmt::format("{:.0f} mm", length);
}

/// `has_exact`: the link has exact geometry, and the contact is of its spheres.
std::string describe(const Contact& contact, bool has_exact) {
  const std::string_view kind = contact.is_self ? "link" : "obstacle";
  if (is_near(contact)) {
    return fmt::format("link '{}' is {:.2g} m from {} '{}'", contact.link, contact.distance, kind,
                       contact.other);
  }
  return fmt::format("link '{}' touches {} '{}'{} by {}{}", contact.link, kind, contact.other,
                     has_exact ? " with spheres" : "", contact.may_be_deeper ? "at least " : "",
                     millimetres(-contact.distance));
}

std::string describe(const ExactContact& behind) {
  const bool are_two = behind.approximated_links == 2;
  const std::string spheres =
      fmt::format("the spheres {} out by up to {}", are_two ? "together stick" : "stick",
                  millimetres(behind.excess));
  if (behind.distance == 0) return fmt::format(" ({}; the exact geometry touches, too)", spheres);
  return fmt::format(" ({}; the exact geometry is {} away)", spheres, millimetres(behind.distance));
}

/// The reason for a refusal, and the way out.
struct Refusal {
  std::string reason;
  std::string advice = {};
};

/// `room`: least distance of the exact geometry, metres per approximated link.
std::string advise(double room) {
  constexpr double kFinest = 0.001;
  const double excess = kFinest * std::floor(room / kFinest);
  if (!(excess >= kFinest) || !std::isfinite(excess)) return {};
  return fmt::format(
      ". Try finer spheres (`mneme robot spheres --excess {:.3g}`), or `allow` what may touch",
      excess);
}

/// Spheres of links can be made finer; those of attached objects cannot.
bool can_be_finer(const Robot& robot, const Contact& contact) {
  return !robot.is_attached(contact.link) && !(contact.is_self && robot.is_attached(contact.other));
}

/// The way out for an attached object; empty for other contacts.
std::string advise_on_held(const Robot& robot, const Contact& contact) {
  if (can_be_finer(robot, contact)) return {};
  return fmt::format(
      ". What the robot holds may leave contact after the start and enter it before the goal "
      "within `--allow-at-ends`, or farther with `allow: [{{pair: [{}, {}], at_ends: METRES}}]`",
      contact.link, contact.other);
}

std::string advise_on_held(const Robot& robot, const std::vector<Contact>& contacts) {
  for (const Contact& contact : contacts) {
    if (is_near(contact)) continue;
    if (std::string advice = advise_on_held(robot, contact); !advice.empty()) return advice;
  }
  return {};
}

/// The way out for links of the robot that also touch where all joints are zero, if there are any:
/// people often have no SRDF yet.
std::string advise_at_rest(const CollisionChecker& checker, const std::vector<Contact>& contacts) {
  constexpr std::size_t kMostNamed = 12;
  const Robot& robot = checker.robot();
  const Configuration zeros(internal::as_index(robot.joint_count()), 0.0);
  const std::vector<Contact> at_rest = checker.contacts(robot.normalized(zeros));
  std::string named;
  std::size_t count = 0;
  for (const Contact& contact : contacts) {
    if (!contact.is_self || is_near(contact) || !can_be_finer(robot, contact)) continue;
    const bool is_same = std::ranges::any_of(at_rest, [&](const Contact& other) {
      return other.is_self && other.link == contact.link && other.other == contact.other;
    });
    if (!is_same || ++count > kMostNamed) continue;
    named += fmt::format("{}[{}, {}]", count == 1 ? "" : ", ", contact.link, contact.other);
  }
  if (count == 0) return {};
  const std::string these = count == 1 ? "These links" : fmt::format("{} pairs of links", count);
  return fmt::format(
      ". {} touch at rest, too: if they may, put `allow: [{}]`{} into the problem, or "
      "`disable_collisions` into an SRDF (`mneme robot srdf` writes one)",
      these, named, count > kMostNamed ? " and the others" : "");
}

/// Names contacts first, then pairs within the margin.
Refusal describe_contacts(const CollisionChecker& checker, const Configuration& q,
                          std::vector<Contact> contacts) {
  constexpr std::size_t kMostNamed = 4;
  std::stable_partition(contacts.begin(), contacts.end(), std::not_fn(is_near));
  std::string text = is_near(contacts.front())
                         ? fmt::format(" is within the margin of {:.4g} m: ", checker.margin())
                         : " is in contact: ";
  double room = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto behind = find_exact_contact(checker.robot(), checker.scene(), q, contacts[i]);
    const double margin = contacts[i].is_self ? 0 : checker.margin();
    const bool can_help = behind && can_be_finer(checker.robot(), contacts[i]);
    room = can_help ? std::min(room, (behind->distance - margin) / behind->approximated_links) : 0;
    if (i >= kMostNamed) continue;
    text += (i == 0 ? "" : ", ") + describe(contacts[i], behind.has_value()) +
            (behind ? describe(*behind) : "");
  }
  if (contacts.size() > kMostNamed)
    text += fmt::format(" and {} more", contacts.size() - kMostNamed);
  return {std::move(text), advise(room) + advise_on_held(checker.robot(), contacts) +
                               advise_at_rest(checker, contacts)};
}

/// Returns the contacts of `q`, a configuration within the limits, that forbid it as a start or
/// goal; none if it is within rounding error of contact. Nothing if `q` is allowed.
std::optional<std::vector<Contact>> find_contacts(const CollisionChecker& checker,
                                                  const Configuration& q) {
  if (internal::is_clear(checker, q)) return std::nullopt;
  std::vector<Contact> contacts = checker.contacts(q);
  if (contacts.empty() && checker.is_valid(q)) return std::nullopt;
  return contacts;
}

/// Describes the contacts of `q`, a valid configuration, if any.
std::optional<Refusal> find_contact(const CollisionChecker& checker, const Configuration& q) {
  const Configuration inside = checker.robot().normalized(q);
  auto contacts = find_contacts(checker, inside);
  if (!contacts) return std::nullopt;
  if (contacts->empty()) return Refusal{" is within rounding error of contact"};
  return describe_contacts(checker, inside, *std::move(contacts));
}

/// Describes the constraint that `q` breaks, if any.
std::optional<std::string> find_tilt(const CollisionChecker& checker, const Configuration& q) {
  const Configuration inside = checker.robot().normalized(q);
  for (const OrientationConstraint& constraint : checker.constraints()) {
    const double leaning = tilt(checker.robot(), constraint, inside);
    if (leaning <= constraint.angle - kTiltMargin) continue;
    // The number that was given, which the margin would change to another one.
    const bool is_within = leaning <= constraint.angle;
    return fmt::format(": {} is tilted by {:.6g} rad, the constraint allows {:.6g}{}",
                       constraint.link, leaning, constraint.angle,
                       is_within ? fmt::format(" less a margin of {:g}", kTiltMargin) : "");
  }
  return std::nullopt;
}

/// The reason why `q` cannot be a start or goal, if any.
std::optional<std::string> find_problem(const CollisionChecker& checker, const Configuration& q,
                                        const std::string& what, bool is_clear,
                                        bool has_advice = true) {
  if (auto violation = checker.robot().describe_violation(q, what)) return violation;
  if (const auto tilt = find_tilt(checker, q)) return what + *tilt;
  const auto contact = is_clear ? std::nullopt : find_contact(checker, q);
  if (!contact) return std::nullopt;
  return what + contact->reason + (has_advice ? contact->advice : "");
}

std::string name_of_goal(std::size_t goal, std::size_t count) {
  return count == 1 ? "goal" : fmt::format("goal {}", goal + 1);
}

PlanResult refusal(PlanStatus status, std::string message) {
  PlanResult result;
  result.status = status;
  result.message = std::move(message);
  return result;
}

}  // namespace

std::optional<PlanResult> refuse_query(const CollisionChecker& checker, const PlanQuery& query,
                                       bool are_ends_clear) {
  if (auto problem = find_problem(checker, query.start, "start", are_ends_clear)) {
    return refusal(PlanStatus::invalid_start, *std::move(problem));
  }
  if (query.goals.empty()) return refusal(PlanStatus::invalid_goal, "there is no goal");
  for (std::size_t i = 0; i < query.goals.size(); ++i) {
    const std::string what = name_of_goal(i, query.goals.size());
    if (auto problem = find_problem(checker, query.goals[i], what, are_ends_clear)) {
      return refusal(PlanStatus::invalid_goal, *std::move(problem));
    }
  }
  return std::nullopt;
}

bool internal::is_valid_end(const CollisionChecker& checker, const Configuration& q) {
  if (!checker.robot().is_configuration(q) || find_tilt(checker, q)) return false;
  const Configuration inside = checker.robot().normalized(q);
  // Contacts, which take exact distances, only where the kernels do not decide.
  return is_clear(checker, inside) ||
         (checker.is_valid(inside) && checker.contacts(inside).empty());
}

std::vector<std::string> internal::drop_invalid_goals(const CollisionChecker& checker,
                                                      std::vector<Configuration>& goals,
                                                      bool are_ends_clear, std::size_t first) {
  if (goals.size() == 1) return {};
  std::vector<std::string> notes;
  std::vector<Configuration> kept;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    poll_interrupt();
    const std::string what = name_of_goal(first + i, goals.size());
    if (auto problem = find_problem(checker, goals[i], what, are_ends_clear, false)) {
      notes.push_back(*std::move(problem) + "; this goal is ignored");
    } else {
      kept.push_back(goals[i]);
    }
  }
  if (kept.empty()) return {};
  goals = std::move(kept);
  return notes;
}

std::vector<std::string> drop_invalid_goals(const CollisionChecker& checker,
                                            std::vector<Configuration>& goals,
                                            bool are_ends_clear) {
  return internal::drop_invalid_goals(checker, goals, are_ends_clear, 0);
}

}  // namespace mneme
