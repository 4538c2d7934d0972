// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/baseline_samplers.h"

#include "mneme/baselines.h"

#include "baselines/cvae_sampler.h"
#include "baselines/scene_image.h"
#include "memory/moved_means.h"
#include "pipeline/memory_steps.h"
#include "pipeline/memory_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace mneme::internal {
namespace {

/// The kind of memory whose keys are circles.
constexpr std::string_view kCircles = "pairs";

GaussianMixture pool_matches(const MemoryQuery& query, std::vector<Match> matches) {
  PrimitiveRetrieval retrieval;
  retrieval.matches = std::move(matches);
  return pool_moved_means(query, {&retrieval, 1});
}

/// The row of a path as a local sampler: one component at each waypoint.
std::shared_ptr<const Experience> with_waypoints_as_means(const Experience& row) {
  LocalSampler sampler;
  sampler.joint_count = row.path().joint_count;
  sampler.means = row.path().waypoints;
  auto pooled = std::make_shared<Experience>(row);
  pooled->content = std::move(sampler);
  return pooled;
}

/// Mean over the circles of `a` of the squared distance to the nearest of `b`.
double one_way_distance(const PrimitiveKey& a, const PrimitiveKey& b) {
  double sum = 0;
  for (std::size_t i = 0; i + 2 < a.size(); i += 3) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j + 2 < b.size(); j += 3) {
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) squared += std::pow(a[i + k] - b[j + k], 2);
      nearest = std::min(nearest, squared);
    }
    sum += nearest;
  }
  return sum / (static_cast<double>(a.size()) / 3);
}

}  // namespace

double scene_distance(const PrimitiveKey& a, const PrimitiveKey& b) {
  return one_way_distance(a, b) + one_way_distance(b, a);
}

Result<GaussianMixture> pool_all(const Query& query, const MemoryQuery& request) {
  std::vector<Match> matches;
  MNEME_TRY(query.database->for_each([&](const auto& row) {
    matches.push_back({row->is_path() ? with_waypoints_as_means(*row) : row, 0, {}});
  }));
  return pool_matches(request, std::move(matches));
}

Result<GaussianMixture> recall_nearest_scenes(const Query& query, const MemoryQuery& request) {
  const KindSettings& kind = query.kinds.front();
  const auto primitives = MNEME_TRY(decompose(request, kind));
  if (kind.kind->name != kCircles) {
    return fail(ErrorCode::unsupported, "sampler 'nearest_scenes' needs scenes of circles");
  }
  const PrimitiveKey circles = circles_of(query.problem.scene);
  if (circles.empty()) return GaussianMixture{query.problem.robot.joint_count(), {}, {}, {}, {}};
  const double direction = mean_direction(circles);
  std::vector<Match> matches;
  for (const bool is_mirrored : {false, true}) {
    const Symmetry to_scene{direction, is_mirrored};
    const PrimitiveKey canonical = moved_key(inverse(to_scene), circles);
    MNEME_TRY(query.database->for_each([&](const auto& row) {
      if (row->kind != kind.kind->version) return;
      matches.push_back({row, scene_distance(canonical, row->key), to_scene});
    }));
  }
  const auto wanted = static_cast<std::size_t>(kind.matches.max_matches) * primitives.size();
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
    return a.similarity_error < b.similarity_error;
  });
  matches.resize(std::min(wanted, matches.size()));
  return pool_matches(request, std::move(matches));
}

}  // namespace mneme::internal

namespace mneme {
namespace {

using internal::MemorySampler;
using SharedSampler = std::shared_ptr<const Sampler>;

SharedSampler pooled(MemorySampler& memory) {
  return memory.from_mixture(
      [&memory] { return internal::pool_all(memory.query(), memory.memory_query()); });
}

SharedSampler nearest_scenes(MemorySampler& memory) {
  return memory.from_mixture(
      [&memory] { return internal::recall_nearest_scenes(memory.query(), memory.memory_query()); });
}

SharedSampler cvae(MemorySampler& memory) {
  return memory.from_sampler([&memory]() -> Result<SharedSampler> {
    const std::string path = internal::cvae_path(*memory.query().database);
    const auto weights = MNEME_TRY(internal::keep_cvae(path));
    return internal::make_cvae_sampler(memory.memory_query(), *weights);
  });
}

constexpr std::array<SamplerEntry, 3> kBaselines = {
    {{.name = "pooled",
      .summary = "baseline: all components of the memory, without retrieval",
      .make = pooled,
      .uses_memory = true},
     {.name = "nearest_scenes",
      .summary = "baseline: components of the scenes that are most similar to the whole scene",
      .make = nearest_scenes,
      .uses_memory = true},
     {.name = "cvae",
      .summary = "baseline: a conditional variational autoencoder trained on the memory's pairs",
      .make = cvae,
      .uses_memory = true}}};

}  // namespace

void add_baseline_samplers() { add_samplers(kBaselines); }

}  // namespace mneme
