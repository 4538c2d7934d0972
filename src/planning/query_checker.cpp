// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/planning.h"

#include "path/path_conversion.h"
#include "planning/end_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace mneme::internal {

bool is_clear(const CollisionChecker& checker, const Configuration& q) {
  const std::vector<float> values = to_floats(checker.robot().normalized(q));
  CheckCounters ignored;
  return checker.is_motion_valid(values, values, ignored, {1, kVerificationMargin});
}

}  // namespace mneme::internal

namespace mneme {
namespace {

struct CoverOnly {
  Contact contact;
  CoveredContact behind;
};

/// Contacts at `q`, which has some, if all are of covers of which the solids are clear.
std::vector<CoverOnly> find_cover_contacts(const CollisionChecker& checker,
                                           const Configuration& q) {
  const Configuration inside = checker.robot().normalized(q);
  std::vector<CoverOnly> found;
  for (const Contact& contact : checker.contacts(inside)) {
    const auto behind = look_behind_covers(checker.robot(), checker.scene(), inside, contact);
    const double margin = contact.is_self ? 0 : checker.margin();
    if (!behind || !(behind->distance > margin + kSolidClearance)) return {};
    found.push_back({contact, *behind});
  }
  return found;
}

std::string describe(const CoverOnly& found, const std::string& end) {
  const Contact& contact = found.contact;
  const double excess = 1e3 * found.behind.excess, distance = 1e3 * found.behind.distance;
  if (found.behind.covers == 2) {
    return fmt::format(
        "{}: links '{}' and '{}' touch with their covers only, which together stick out by up to "
        "{:.2g} mm; they are checked by what these cover, {:.2g} mm apart",
        end, contact.link, contact.other, excess, distance);
  }
  return fmt::format(
      "{}: link '{}' comes close to {} '{}' with {} cover only, which sticks out by up to {:.2g} "
      "mm; they are checked by what it covers, {:.2g} mm away",
      end, contact.link, contact.is_self ? "link" : "obstacle", contact.other,
      contact.is_self ? "a" : "its", excess, distance);
}

/// False if it is known.
bool add_by_solid(const Contact& contact, Scene& scene) {
  if (!contact.is_self) {
    std::vector<std::string>& links = scene.find(contact.other)->by_solid;
    if (std::ranges::count(links, contact.link) > 0) return false;
    links.push_back(contact.link);
    return true;
  }
  const std::pair pair(contact.link, contact.other);
  if (std::ranges::count(scene.by_solid, pair) > 0) return false;
  scene.by_solid.push_back(pair);
  return true;
}

}  // namespace

Result<QueryChecker> make_query_checker(const Robot& robot, const Scene& scene,
                                        const CheckerSettings& settings, const PlanQuery& ends) {
  auto plain = CollisionChecker::make(robot, scene, settings);
  if (!plain) return tl::unexpected(plain.error());
  QueryChecker result{*std::move(plain), {}, true};
  std::optional<Scene> by_solid;
  const auto judge = [&](const Configuration& q, const std::string& end) {
    const bool is_configuration = !robot.describe_violation(q, "");
    if (is_configuration && internal::is_clear(result.checker, q)) return;
    result.are_ends_clear = false;
    if (!is_configuration) return;
    for (const CoverOnly& found : find_cover_contacts(result.checker, q)) {
      if (!by_solid) by_solid = scene;
      if (add_by_solid(found.contact, *by_solid)) result.notes.push_back(describe(found, end));
    }
  };
  judge(ends.start, "start");
  for (const Configuration& goal : ends.goals) judge(goal, "goal");
  if (!by_solid) return result;
  return CollisionChecker::make(robot, *by_solid, settings).map([&](CollisionChecker checker) {
    result.checker = std::move(checker);
    return std::move(result);
  });
}

}  // namespace mneme
