// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/approximate_robot.h"

#include "mneme/spheres.h"

#include "base/as_index.h"
#include "base/check_ranges.h"
#include "base/fail.h"
#include "base/files.h"
#include "base/threads.h"
#include "spheres/approximate_solid.h"
#include "spheres/fit_capsule.h"
#include "spheres/triangle_mesh.h"
#include "robot/kinematics.h"
#include "robot/planning_group.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <map>
#include <mutex>
#include <thread>

namespace mneme::internal {
namespace {

using Json = nlohmann::json;

Json to_json(const LinkSpheres& link) {
  Json spheres = Json::array();
  for (const Sphere& s : link.spheres) {
    spheres.push_back({s.center.x(), s.center.y(), s.center.z(), s.radius});
  }
  Json capsules = Json::array();
  for (const Capsule& c : link.capsules) {
    capsules.push_back({c.a.x(), c.a.y(), c.a.z(), c.b.x(), c.b.y(), c.b.z(), c.radius});
  }
  return {{"spheres", spheres},
          {"capsules", capsules},
          {"uncovered", link.uncovered},
          {"mean_excess", link.mean_excess},
          {"max_excess", link.max_excess}};
}

LinkSpheres from_json(const Json& json) {
  LinkSpheres link;
  for (const auto& [x, y, z, radius] :
       json.at("spheres").get<std::vector<std::array<double, 4>>>()) {
    link.spheres.push_back({Vec3(x, y, z), radius});
  }
  for (const auto& c : json.at("capsules").get<std::vector<std::array<double, 7>>>()) {
    link.capsules.push_back({Vec3(c[0], c[1], c[2]), Vec3(c[3], c[4], c[5]), c[6]});
  }
  json.at("uncovered").get_to(link.uncovered);
  json.at("mean_excess").get_to(link.mean_excess);
  json.at("max_excess").get_to(link.max_excess);
  return link;
}

}  // namespace

std::string sphere_key(const TriangleMesh& surface, const SphereSettings& settings) {
  std::vector<double> numbers = {kSphereVersion, settings.excess,
                                 static_cast<double>(settings.max_spheres)};
  for (const Triangle& triangle : surface) {
    poll_interrupt();
    for (const Vec3& corner : {triangle.a, triangle.b, triangle.c}) {
      // Adding zero makes -0 the same as 0.
      for (const double coordinate : corner) numbers.push_back(coordinate + 0.0);
    }
  }
  return ContentCache::hash_of(
      {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
}

std::optional<LinkSpheres> SphereCache::find(const std::string& key) const {
  const auto text = files_.find(key);
  if (!text) return std::nullopt;
  try {
    return from_json(Json::parse(*text));
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

CachedSurface approximate_surface(const TriangleMesh& surface, const SphereSettings& settings,
                                  const SphereCache& cache) {
  const std::string key = sphere_key(surface, settings);
  if (auto known = cache.find(key)) return {*std::move(known), true, false};
  CachedSurface result{approximate_solid(surface, settings)};
  result.is_stored = cache.store(key, result.spheres);
  return result;
}

bool SphereCache::store(const std::string& key, const LinkSpheres& spheres) const {
  return files_.store(key, to_json(spheres).dump());
}

namespace {

/// The approximation of a surface that one or more links have.
struct Attempt {
  std::string key;
  SphereSettings settings;
  TriangleMesh surface;
  std::vector<Link*> links;
  CachedSurface made;
};

void replace_solids(Link& link, const LinkSpheres& made, const Mesh& surface) {
  link.solids.clear();
  link.spheres.insert(link.spheres.end(), made.spheres.begin(), made.spheres.end());
  link.capsules.insert(link.capsules.end(), made.capsules.begin(), made.capsules.end());
  link.approximation = {surface, static_cast<int>(made.spheres.size()),
                        static_cast<int>(made.capsules.size()), made.max_excess};
}

/// Numbers of independent joints.
struct Joints {
  int before = 0;
  int beyond = 0;  ///< on the longest way to a tip
};

}  // namespace

std::vector<bool> find_arm_ends(const Robot::Parts& parts) {
  constexpr int kFewestBefore = 4;
  constexpr int kMostBeyond = 2;
  std::vector<Joints> joints(parts.links.size());
  bool has_changed = true;
  // Joints are in any order, and a robot with a loop is refused later.
  for (std::size_t pass = 0; has_changed && pass < parts.joints.size(); ++pass) {
    has_changed = false;
    for (const Joint& joint : parts.joints) {
      const int own = is_free(joint) ? 1 : 0;
      Joints& parent = joints[as_index(joint.parent_link)];
      Joints& child = joints[as_index(joint.child_link)];
      const Joints known{parent.before + own, child.beyond + own};
      has_changed |= child.before != known.before || parent.beyond < known.beyond;
      child.before = known.before;
      parent.beyond = std::max(parent.beyond, known.beyond);
    }
  }
  std::vector<bool> are_ends;
  for (const Joints& link : joints) {
    are_ends.push_back(link.before >= kFewestBefore && link.beyond <= kMostBeyond);
  }
  return are_ends;
}

namespace {

/// The distinct surfaces of all links with solids, the most expensive first.
Result<std::vector<Attempt>> find_surfaces(Robot::Parts& parts, const SphereSettings& settings) {
  const std::vector<bool> are_ends = find_arm_ends(parts);
  std::vector<Attempt> attempts;
  for (std::size_t i = 0; i < parts.links.size(); ++i) {
    Link& link = parts.links[i];
    if (link.solids.empty()) continue;
    Attempt attempt{{}, settings, MNEME_TRY(link_surface(link)), {&link}, {}};
    if (are_ends[i]) attempt.settings.excess = std::min(settings.excess, settings.tip_excess);
    attempt.key = sphere_key(attempt.surface, attempt.settings);
    const auto same = std::ranges::find(attempts, attempt.key, &Attempt::key);
    if (same == attempts.end()) {
      attempts.push_back(std::move(attempt));
    } else {
      same->links.push_back(&link);
    }
  }
  std::ranges::stable_sort(attempts, std::greater(), [](const Attempt& attempt) {
    return surface_area(attempt.surface) / std::pow(attempt.settings.excess, 2);
  });
  return attempts;
}

}  // namespace

Result<CachedSpheres> approximate_robot(Robot::Parts parts, const SphereSettings& settings,
                                        const SphereCache& cache,
                                        const SphereProgress& on_approximated) {
  std::ranges::for_each(parts.links, join_capsules);
  std::vector<Attempt> attempts = MNEME_TRY(find_surfaces(parts, settings));
  std::mutex mutex;
  int done = 0;
  run_parallel(attempts.size(), std::thread::hardware_concurrency(), [&](std::size_t i) {
    Attempt& attempt = attempts[i];
    attempt.made = approximate_surface(attempt.surface, attempt.settings, cache);
    const std::scoped_lock locked(mutex);
    if (!on_approximated) return;
    on_approximated(++done, static_cast<int>(attempts.size()), attempt.links.front()->name);
  });
  std::map<const Link*, LinkSpheres> made;
  CachedSpheres result;
  for (Attempt& attempt : attempts) {
    const Mesh surface{{}, std::make_shared<Parts<Triangle>>(std::move(attempt.surface)), 0};
    const int count = static_cast<int>(attempt.links.size());
    if (attempt.made.is_found) result.found += count;
    if (attempt.made.is_stored) result.stored += count;
    for (Link* link : attempt.links) {
      replace_solids(*link, attempt.made.spheres, surface);
      made[link] = attempt.made.spheres;
      made[link].link = link->name;
    }
  }
  for (const Link& link : parts.links) {
    if (const auto found = made.find(&link); found != made.end()) {
      result.robot.links.push_back(std::move(found->second));
    }
  }
  result.robot.parts = std::move(parts);
  return result;
}

}  // namespace mneme::internal

namespace mneme {
namespace {

std::string describe(const internal::CachedSpheres& made, const internal::SphereCache& cache) {
  std::size_t spheres = 0;
  double worst = 0;
  for (const LinkSpheres& link : made.robot.links) {
    spheres += link.spheres.size() + link.capsules.size();
    worst = std::max(worst, link.max_excess);
  }
  const auto links = made.robot.links.size();
  std::string text = fmt::format(
      "approximated the geometry of {} {} by {} {} that stick out by up to {:.3f} m", links,
      links == 1 ? "link" : "links", spheres, spheres == 1 ? "shape" : "shapes", worst);
  const auto known = static_cast<std::size_t>(made.found + made.stored);
  if (made.found > 0) text += fmt::format("; {} from the cache {}", made.found, cache.directory());
  if (known < links) text += fmt::format("; the cache '{}' cannot be written", cache.directory());
  return text;
}

}  // namespace

SphereProgress terminal_progress() {
  constexpr double kSilence_s = 0.5;
  if (::isatty(STDERR_FILENO) == 0) return {};
  return [stopwatch = Stopwatch()](int done, int total, const std::string&) {
    if (stopwatch.elapsed_s() < kSilence_s) return;
    std::fprintf(stderr, "\rmneme: approximated %d of %d links%s", done, total,
                 done == total ? "\n" : "");
  };
}

Result<RobotSpheres> approximate_robot(Robot::Parts parts, const SphereSettings& settings,
                                       const SphereProgress& on_approximated) {
  MNEME_TRY(internal::check_ranges(settings));
  const internal::SphereCache cache(internal::cache_directory());
  return internal::approximate_robot(std::move(parts), settings, cache, on_approximated)
      .map([&](internal::CachedSpheres result) {
        if (!result.robot.links.empty()) {
          result.robot.notes.push_back(describe(result, cache));
        }
        return std::move(result.robot);
      });
}

namespace {

/// The pairs that may touch if there is no SRDF. make_usable() adds pairs that always touch.
Result<std::vector<std::pair<std::string, std::string>>> find_adjacent_pairs(
    const Robot::Parts& parts) {
  constexpr PairSettings kNoContacts{.samples = 1};
  return derive_allowed_pairs(parts, kNoContacts).map([](const std::vector<AllowedPair>& allowed) {
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const AllowedPair& pair : allowed) {
      if (pair.reason == AllowedReason::adjacent) pairs.emplace_back(pair.first, pair.second);
    }
    return pairs;
  });
}

/// A warning if the group moves no collision geometry: mostly a URDF with <visual> alone.
std::vector<std::string> describe_missing_shapes(const Robot& robot) {
  const std::vector<bool> is_moving = internal::find_moving_links(robot);
  for (std::size_t i = 0; i < is_moving.size(); ++i) {
    if (is_moving[i] && internal::has_shapes(robot.links()[i])) return {};
  }
  return {
      fmt::format("no link that the group of robot {} moves has collision geometry, so that no "
                  "contact is found; expected <collision> elements in its URDF",
                  robot.name())};
}

/// make_robot. Pairs that always touch are allowed, and pairs of which often only the spheres do
/// are checked by exact geometry: few configurations would be valid otherwise. An SRDF that does
/// not allow a pair that always touches is a warning.
Result<Robot> make_usable(Robot::Parts parts, RobotOptions options, bool has_srdf,
                          std::vector<std::string>& notes) {
  auto robot = make_robot(parts, options);
  if (!robot) return robot;
  internal::InseparablePairs inseparable = internal::find_inseparable_pairs(*robot);
  auto missing = describe_missing_shapes(*robot);
  if (inseparable.always.empty() && inseparable.only_spheres.empty() &&
      inseparable.often_spheres.empty() && missing.empty()) {
    return robot;
  }
  std::ranges::move(missing, std::back_inserter(parts.warnings));
  for (const auto& pair : inseparable.always) {
    options.allowed_pairs.push_back(pair);
    (has_srdf ? parts.warnings : notes)
        .push_back(fmt::format("links '{}' and '{}' touch in every configuration; this pair is not "
                               "checked",
                               pair.first, pair.second));
  }
  const auto check_exactly = [&](internal::InseparablePairs::Names& pairs, std::string_view often) {
    for (const auto& [first, second] : pairs) {
      notes.push_back(
          fmt::format("the spheres of links '{}' and '{}' {} overlap; they are checked "
                      "by exact geometry",
                      first, second, often));
    }
    std::ranges::move(pairs, std::back_inserter(parts.exact_pairs));
  };
  check_exactly(inseparable.only_spheres, "always");
  check_exactly(inseparable.often_spheres, "often");
  return make_robot(std::move(parts), options);
}

}  // namespace

Result<ApproximatedRobot> load_approximated_robot(const std::string& path,
                                                  const RobotOptions& options,
                                                  const SphereSettings& settings,
                                                  const SphereProgress& on_approximated) {
  MNEME_TRY(internal::check_ranges(settings));
  Robot::Parts parts = MNEME_TRY(read_robot(path, options));
  const auto with_path = internal::naming(path);
  // Approximation takes seconds: what make_robot() would refuse afterwards is refused first.
  MNEME_TRY(internal::choose_group(parts, options).map_error(with_path));
  const auto has_solids = [](const Link& link) { return !link.solids.empty(); };
  std::vector<std::string> notes;
  const bool has_srdf = parts.allowed_pairs.has_value();
  if (std::ranges::any_of(parts.links, has_solids)) {
    RobotSpheres made = MNEME_TRY(
        approximate_robot(std::move(parts), settings, on_approximated).map_error(with_path));
    notes = std::move(made.notes);
    parts = std::move(made.parts);
    if (!has_srdf) parts.allowed_pairs = MNEME_TRY(find_adjacent_pairs(parts).map_error(with_path));
  }
  Robot robot =
      MNEME_TRY(make_usable(std::move(parts), options, has_srdf, notes).map_error(with_path));
  return ApproximatedRobot{std::move(robot), std::move(notes)};
}

}  // namespace mneme
