// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_robot.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "covering/cover_solid.h"
#include "covering/link_surface.h"

namespace mneme {
namespace internal {
namespace {

/// What became of one link.
struct Attempt {
  Result<LinkCover> cover;
  bool is_found = false;
  bool is_stored = false;
};

Attempt attempt(const Link& link, const CoverSettings& settings, const CoverCache& cache) {
  const auto surface = link_surface(link);
  if (!surface) return {tl::unexpected(surface.error())};
  const std::string key = cover_key(*surface, settings);
  std::optional<LinkCover> known = cache.find(key);
  Attempt result{known ? *std::move(known) : cover_solid(*surface, settings), known.has_value()};
  if (!result.is_found) result.is_stored = cache.store(key, *result.cover);
  result.cover->link = link.name;
  return result;
}

/// Calls `work(i)` for each i < count, in any order, from as many threads as the machine has.
template <class Work>
void run_parallel(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next = 0;
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  const std::size_t thread_count =
      std::min<std::size_t>(std::max(1U, std::thread::hardware_concurrency()), count);
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < thread_count; ++i) threads.emplace_back(run);
  run();
}

}  // namespace

Result<CachedCovering> cover_robot(Robot::Parts parts, const CoverSettings& settings,
                                   const CoverCache& cache) {
  std::vector<Link*> links;
  for (Link& link : parts.links) {
    if (!link.solids.empty()) links.push_back(&link);
  }
  std::vector<Attempt> attempts(links.size());
  run_parallel(links.size(),
               [&](std::size_t i) { attempts[i] = attempt(*links[i], settings, cache); });
  CachedCovering result;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Attempt& made = attempts[i];
    if (!made.cover) return tl::unexpected(made.cover.error());
    links[i]->solids.clear();
    links[i]->spheres.insert(links[i]->spheres.end(), made.cover->spheres.begin(),
                             made.cover->spheres.end());
    result.covering.links.push_back(*made.cover);
    result.found += made.is_found ? 1 : 0;
    result.stored += made.is_stored ? 1 : 0;
  }
  result.covering.parts = std::move(parts);
  return result;
}

}  // namespace internal

Result<Covering> cover_robot(Robot::Parts parts, const CoverSettings& settings) {
  return internal::cover_robot(std::move(parts), settings, internal::CoverCache(""))
      .map([](internal::CachedCovering result) { return std::move(result.covering); });
}

}  // namespace mneme
