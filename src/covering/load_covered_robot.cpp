// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/covering.h"

#include <algorithm>

#include <fmt/format.h>

#include "covering/cover_robot.h"
#include "covering/inseparable_pairs.h"
#include "base/cache_directory.h"

namespace mneme {
namespace {

std::string describe(const internal::CachedCovering& made, const internal::CoverCache& cache) {
  std::size_t spheres = 0;
  double worst = 0;
  for (const LinkCover& link : made.covering.links) {
    spheres += link.spheres.size();
    worst = std::max(worst, link.max_excess);
  }
  const auto links = made.covering.links.size();
  std::string text = fmt::format(
      "covered the geometry of {} {} with {} {}, which stick out by up to {:.3f} m", links,
      links == 1 ? "link" : "links", spheres, spheres == 1 ? "sphere" : "spheres", worst);
  const auto known = static_cast<std::size_t>(made.found + made.stored);
  if (made.found > 0) text += fmt::format("; {} from the cache {}", made.found, cache.directory());
  if (known < links) text += fmt::format("; the cache '{}' cannot be written", cache.directory());
  return text;
}

/// Without an SRDF only what is adjacent, or cannot be apart, may touch.
Result<std::vector<std::pair<std::string, std::string>>> derive_pairs(const Robot::Parts& parts) {
  return derive_allowed_pairs(parts).map([](const std::vector<AllowedPair>& allowed) {
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const AllowedPair& pair : allowed) {
      if (pair.reason == AllowedReason::never) continue;
      pairs.emplace_back(pair.first, pair.second);
    }
    return pairs;
  });
}

/// make_robot, with pairs that no configuration parts allowed, because nothing would be valid.
Result<Robot> make_usable(Robot::Parts parts, const RobotOptions& options,
                          std::vector<std::string>& notes) {
  auto robot = make_robot(parts, options);
  if (!robot) return robot;
  const auto inseparable = internal::find_inseparable_pairs(*robot);
  if (inseparable.empty()) return robot;
  RobotOptions allowing = options;
  for (const auto& pair : inseparable) {
    allowing.allowed_pairs.push_back(pair);
    notes.push_back(fmt::format(
        "links '{}' and '{}' touch in every configuration; they are not checked against each other",
        pair.first, pair.second));
  }
  return make_robot(std::move(parts), allowing);
}

}  // namespace

Result<CoveredRobot> load_covered_robot(const std::string& path, const RobotOptions& options,
                                        const CoverSettings& settings) {
  auto parts = read_robot(path, options);
  if (!parts) return tl::unexpected(parts.error());
  const auto has_solids = [](const Link& link) { return !link.solids.empty(); };
  std::vector<std::string> notes;
  if (std::ranges::any_of(parts->links, has_solids)) {
    const internal::CoverCache cache(internal::cache_directory());
    auto made = internal::cover_robot(std::move(*parts), settings, cache);
    if (!made) {
      return fail(made.error().code, fmt::format("{}: {}", path, made.error().message));
    }
    notes.push_back(describe(*made, cache));
    parts = std::move(made->covering.parts);
    if (!parts->allowed_pairs) {
      auto pairs = derive_pairs(*parts);
      if (!pairs)
        return fail(pairs.error().code, fmt::format("{}: {}", path, pairs.error().message));
      parts->allowed_pairs = std::move(*pairs);
    }
  }
  auto robot = make_usable(std::move(*parts), options, notes);
  if (!robot) return fail(robot.error().code, fmt::format("{}: {}", path, robot.error().message));
  return CoveredRobot{std::move(*robot), std::move(notes)};
}

}  // namespace mneme
