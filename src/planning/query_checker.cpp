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

/// Contacts at `q`, if there are any and all are of covers of which the solids are clear.
std::vector<CoverOnly> find_cover_contacts(const CollisionChecker& checker,
                                           const Configuration& q) {
  if (checker.robot().describe_violation(q, "") || internal::is_clear(checker, q)) return {};
  const Configuration inside = checker.robot().normalized(q);
  std::vector<CoverOnly> found;
  for (const Contact& contact : checker.contacts(inside)) {
    if (contact.is_self) return {};
    const auto behind = look_behind_covers(checker.robot(), checker.scene(), inside, contact);
    if (!behind || !(behind->distance > checker.margin() + kSolidClearance)) return {};
    found.push_back({contact, *behind});
  }
  return found;
}

std::string describe(const CoverOnly& found, const std::string& end) {
  return fmt::format(
      "{}: link '{}' comes close to obstacle '{}' with its cover only, which sticks out by up to "
      "{:.2g} mm; they are checked by what it covers, {:.2g} mm away",
      end, found.contact.link, found.contact.other, 1e3 * found.behind.excess,
      1e3 * found.behind.distance);
}

}  // namespace

Result<QueryChecker> make_query_checker(const Robot& robot, const Scene& scene,
                                        const CheckerSettings& settings, const PlanQuery& ends) {
  auto plain = CollisionChecker::make(robot, scene, settings);
  if (!plain) return tl::unexpected(plain.error());
  QueryChecker result{*std::move(plain), {}};
  std::optional<Scene> by_solid;
  const auto judge = [&](const Configuration& q, const std::string& end) {
    for (const CoverOnly& found : find_cover_contacts(result.checker, q)) {
      if (!by_solid) by_solid = scene;
      std::vector<std::string>& links = by_solid->find(found.contact.other)->by_solid;
      if (std::ranges::count(links, found.contact.link) > 0) continue;
      links.push_back(found.contact.link);
      result.notes.push_back(describe(found, end));
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
