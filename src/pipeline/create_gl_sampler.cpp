// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Algorithm 2 of the paper, "Create GL-Sampler".
#include <algorithm>
#include <limits>

#include "base/stopwatch.h"
#include "mneme/pipeline.h"
#include "pipeline/check_settings.h"
#include "pipeline/complete_settings.h"
#include "pipeline/database_check.h"
#include "pipeline/recall_paths.h"
#include "pipeline/synthesize.h"

namespace mneme {
namespace {

/// Seconds of the time limit that learning leaves, because an insertion waits for the disk.
constexpr double kInsertionTime = 0.01;

/// Lines 6 and 7: creates the local sampler of a primitive that has no match, and inserts it.
Result<void> learn_on_miss(const Robot& robot, const SolveSettings& settings, double deadline_s,
                           const std::string& kind, Database& database,
                           PrimitiveRetrieval& retrieval) {
  LearnSettings learning = settings.learn;
  if (learning.resolution == 0) learning.resolution = settings.resolution;
  auto learned = learn_local_sampler(robot, retrieval.primitive.key, learning, settings.plan.seed,
                                     deadline_s, settings.plan.cancel);
  if (!learned) return tl::unexpected(learned.error());
  // What a short budget left without a component may be no obstacle with a longer one.
  if (learned->sampler.component_count() == 0) return {};
  Experience row;
  row.kind = kind;
  row.key = retrieval.primitive.key;
  row.sampler = std::move(learned->sampler);
  row.provenance = {
      "mneme " + std::string(version()), describe(learning) + " budget", settings.plan.seed, {}};
  std::vector<Experience> rows;
  rows.push_back(std::move(row));
  if (auto inserted = database.insert(std::move(rows)); !inserted)
    return tl::unexpected(inserted.error());
  retrieval.is_learned = true;
  return {};
}

}  // namespace

Result<GlSampler> create_gl_sampler(const Robot& robot, const Scene& scene, Database& database,
                                    const SolveSettings& asked) {
  const internal::Stopwatch stopwatch;
  if (auto checked = internal::check_ranges(asked); !checked) {
    return tl::unexpected(checked.error());
  }
  const SolveSettings settings = internal::complete_settings(asked, robot, &database);
  GlSampler gl;
  if (auto checked = internal::check_database(robot, settings, database); !checked) {
    return tl::unexpected(checked.error());
  }
  auto primitives = decompose(robot, scene, settings.decompose);
  if (!primitives) return tl::unexpected(primitives.error());
  const std::string kind = decomposer_version(settings.decompose.decomposer).value();
  // A key always matches itself: what was learned for it, now or before, serves it.
  const double threshold = std::max(settings.similarity, std::numeric_limits<double>::denorm_min());
  const auto retrieve = [&](PrimitiveRetrieval& retrieval) {
    return find_matches(database, kind, retrieval.primitive, threshold, settings.max_matches)
        .map([&](std::vector<Match> matches) { retrieval.matches = std::move(matches); });
  };
  // Local queries are made for arms threaded through pairs of circles only.
  const bool can_learn = robot.is_planar() && settings.decompose.decomposer == "pairs";
  const auto is_over = [&] {
    return (settings.plan.cancel != nullptr && settings.plan.cancel->load()) ||
           stopwatch.elapsed_s() >= settings.plan.timeout_s;
  };
  for (LocalPrimitive& primitive : *primitives) {
    if (is_over()) break;
    PrimitiveRetrieval& retrieval = gl.primitives.emplace_back();
    retrieval.primitive = std::move(primitive);
    if (auto done = retrieve(retrieval); !done) return tl::unexpected(done.error());
    const double rest_s = settings.plan.timeout_s - stopwatch.elapsed_s() - kInsertionTime;
    const double budget_s = std::min(settings.learn_budget_s - gl.learning_time_s, rest_s);
    if (!retrieval.matches.empty() || budget_s <= 0 || !can_learn) continue;
    const internal::Stopwatch learning;
    auto learned = learn_on_miss(robot, settings, budget_s, kind, database, retrieval);
    if (!learned) return tl::unexpected(learned.error());
    if (retrieval.is_learned) {
      if (auto done = retrieve(retrieval); !done) return tl::unexpected(done.error());
    }
    gl.learning_time_s += learning.elapsed_s();
  }
  gl.mixture = std::make_shared<const GaussianMixture>(internal::synthesize(robot, gl.primitives));
  gl.retrieval_time_s = stopwatch.elapsed_s() - gl.learning_time_s;
  return gl;
}

Result<GlSampler> create_gl_sampler(const Problem& problem, Database& database,
                                    const SolveSettings& asked) {
  if (auto checked = internal::check_ranges(asked); !checked) {
    return tl::unexpected(checked.error());
  }
  const SolveSettings settings = internal::complete_settings(asked, problem.robot, &database);
  if (settings.decompose.decomposer != "paths") {
    return create_gl_sampler(problem.robot, problem.scene, database, settings);
  }
  if (auto checked = internal::check_database(problem.robot, settings, database); !checked) {
    return tl::unexpected(checked.error());
  }
  return internal::recall_paths(problem, database, settings);
}

}  // namespace mneme
