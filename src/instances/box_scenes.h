// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Parts of random problems: free configurations and paths in a scene, and boxes that keep
/// a distance to paths.
#pragma once

#include "mneme/collision.h"
#include "mneme/instances.h"
#include "mneme/planning.h"

#include "base/threads.h"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

namespace mneme::internal {

/// Returns a free configuration; nothing if 10000 samples are in contact.
[[nodiscard]] std::optional<Configuration> sample_free(const CollisionChecker& checker,
                                                       SampleStream& states);

/// Returns a path of RRT-Connect; empty if there is none within `iterations`.
[[nodiscard]] Path find_path(const CollisionChecker& checker, const Sampler& sampler,
                             const PlanQuery& query, std::uint64_t iterations, std::uint64_t seed,
                             const std::atomic<bool>* cancel);

/// True if the box keeps `clearance` to the path, and to links that no joint moves.
[[nodiscard]] Result<bool> is_clear_of(const Box& box, const Robot& robot, const Path& path,
                                       double clearance);

/// Returns the largest of some fractions of `box` with edges of at least `least` that `fits`.
template <class Fits>
Result<std::optional<Box>> shrink_to_fit(const Box& box, double least, const Fits& fits) {
  constexpr std::array kFractions = {1.0, 0.7, 0.5, 0.35};
  for (const double fraction : kFractions) {
    const Box smaller{box.pose, fraction * box.half_extents};
    if (smaller.half_extents.minCoeff() < least / 2) break;
    const bool is_fitting = MNEME_TRY(fits(smaller));
    if (is_fitting) return std::optional(smaller);
  }
  return std::optional<Box>();
}

/// Returns `count` boxes that `sample` returns; fewer once `most_failures` in a row returned none.
template <class Sample>
Result<Scene> sample_boxes(int count, int most_failures, const std::atomic<bool>* cancel,
                           const Sample& sample) {
  Scene scene;
  int failures = 0;
  while (failures < most_failures && std::ssize(scene.obstacles) < count && !is_set(cancel)) {
    const std::optional<Box> box = MNEME_TRY(sample());
    failures = box ? 0 : failures + 1;
    if (box) scene.obstacles.push_back({fmt::format("box_{}", scene.obstacles.size()), {*box}});
  }
  return scene;
}

template <class Instances>
void report_progress(const GeneratorRun& run, const Instances& made) {
  if (run.on_progress) run.on_progress(static_cast<int>(made.instances.size()), made.dropped);
}

}  // namespace mneme::internal
