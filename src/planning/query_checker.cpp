// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/planning.h"

#include "base/threads.h"
#include "path/waypoints.h"
#include "planning/end_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace mneme::internal {

bool is_clear(const CollisionChecker& checker, const Configuration& q) {
  const std::vector<float> values = to_floats(checker.robot(), q);
  CheckCounters ignored;
  return checker.is_motion_valid(values, values, ignored, {1, kVerificationMargin});
}

}  // namespace mneme::internal

namespace mneme {
namespace {

struct SpheresOnly {
  Contact contact;
  ExactContact behind;
};

/// The contacts at `q`, if each is of spheres only, with `clearance` between the exact geometry;
/// otherwise none.
std::vector<SpheresOnly> find_sphere_contacts(const CollisionChecker& checker,
                                              const Configuration& q, double clearance) {
  const Configuration inside = checker.robot().normalized(q);
  std::vector<SpheresOnly> found;
  for (const Contact& contact : checker.contacts(inside)) {
    const auto behind = find_exact_contact(checker.robot(), checker.scene(), inside, contact);
    const double margin = contact.is_self ? 0 : checker.margin();
    if (!behind || !(behind->distance > margin + clearance)) return {};
    found.push_back({contact, *behind});
  }
  return found;
}

std::string describe(const SpheresOnly& found, const std::string& end) {
  const Contact& contact = found.contact;
  const double excess = 1e3 * found.behind.excess, distance = 1e3 * found.behind.distance;
  if (found.behind.approximated_links == 2) {
    return fmt::format(
        "{}: links '{}' and '{}' touch only with their spheres, which together stick out by up to "
        "{:.2g} mm; this pair is checked by exact geometry, {:.2g} mm apart",
        end, contact.link, contact.other, excess, distance);
  }
  return fmt::format(
      "{}: link '{}' touches {} '{}' only with {}spheres, which stick out by up to {:.2g} mm; this "
      "pair is checked by exact geometry, {:.2g} mm away",
      end, contact.link, contact.is_self ? "link" : "obstacle", contact.other,
      contact.is_self ? "" : "its ", excess, distance);
}

/// Returns false if the pair is known already.
bool add_exact(const Contact& contact, Scene& scene) {
  if (!contact.is_self) {
    std::vector<std::string>& links = scene.find(contact.other)->exact_links;
    if (std::ranges::count(links, contact.link) > 0) return false;
    links.push_back(contact.link);
    return true;
  }
  const std::pair pair(contact.link, contact.other);
  if (std::ranges::count(scene.exact_pairs, pair) > 0) return false;
  scene.exact_pairs.push_back(pair);
  return true;
}

}  // namespace

bool internal::is_clear_by_exact_geometry(const CollisionChecker& checker, const Configuration& q,
                                          double clearance) {
  return is_clear(checker, q) || !find_sphere_contacts(checker, q, clearance).empty();
}

namespace {

Result<QueryChecker> check_ends(const CollisionChecker& plain, const CheckerSettings& settings,
                                const PlanQuery& ends, const std::vector<std::string>& names,
                                double clearance = kSolidClearance) {
  const Robot& robot = plain.robot();
  QueryChecker result{plain, {}, true};
  std::optional<Scene> checked_scene;
  const auto judge = [&](const Configuration& q, const std::string& end) {
    internal::poll_interrupt();
    const bool is_configuration = robot.is_configuration(q);
    if (is_configuration && internal::is_clear(result.checker, q)) return;
    result.are_ends_clear = false;
    if (!is_configuration) return;
    for (const SpheresOnly& found : find_sphere_contacts(result.checker, q, clearance)) {
      if (!checked_scene) checked_scene = plain.scene();
      if (add_exact(found.contact, *checked_scene)) result.notes.push_back(describe(found, end));
    }
  };
  judge(ends.start, names.at(0));
  for (std::size_t i = 0; i < ends.goals.size(); ++i) judge(ends.goals[i], names.at(i + 1));
  if (!checked_scene) return result;
  result.checker = MNEME_TRY(CollisionChecker::make(robot, *checked_scene, settings));
  return result;
}

}  // namespace

Result<QueryChecker> make_query_checker(const CollisionChecker& plain,
                                        const CheckerSettings& settings, const PlanQuery& ends) {
  std::vector<std::string> names(1 + ends.goals.size(), "goal");
  names.front() = "start";
  return check_ends(plain, settings, ends, names);
}

Result<QueryChecker> make_query_checker(const Robot& robot, const Scene& scene,
                                        const CheckerSettings& settings, const PlanQuery& ends) {
  const CollisionChecker plain = MNEME_TRY(CollisionChecker::make(robot, scene, settings));
  return make_query_checker(plain, settings, ends);
}

Result<QueryChecker> internal::make_query_checker(const Robot& robot, const Scene& scene,
                                                  const CheckerSettings& settings,
                                                  const PlanQuery& ends,
                                                  const std::vector<std::string>& names) {
  const CollisionChecker plain = MNEME_TRY(CollisionChecker::make(robot, scene, settings));
  return check_ends(plain, settings, ends, names);
}

Result<QueryChecker> internal::make_end_checker(const CollisionChecker& plain,
                                                const CheckerSettings& settings,
                                                const Configuration& q, double clearance) {
  return check_ends(plain, settings, {q, {}}, {"start"}, clearance);
}

}  // namespace mneme
