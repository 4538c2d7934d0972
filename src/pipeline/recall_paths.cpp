// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/recall_paths.h"

#include <algorithm>
#include <limits>

#include "base/stopwatch.h"
#include "pipeline/warp_paths.h"

namespace mneme::internal {

Result<GlSampler> recall_paths(const Problem& problem, const Database& database,
                               const SolveSettings& settings) {
  const Stopwatch stopwatch;
  GlSampler gl;
  const std::string kind = decomposer_version("paths").value();
  // A query that is remembered exactly always matches itself.
  const double threshold = std::max(settings.similarity, std::numeric_limits<double>::denorm_min());
  for (const Configuration& goal : problem.goals) {
    PrimitiveRetrieval& retrieval = gl.primitives.emplace_back();
    retrieval.primitive = make_query_primitive(problem.robot, problem.start, goal);
    auto matches =
        find_matches(database, kind, retrieval.primitive, threshold, settings.max_matches);
    if (!matches) return tl::unexpected(matches.error());
    retrieval.matches = std::move(*matches);
  }
  gl.mixture = std::make_shared<const GaussianMixture>(
      warp_paths(problem.robot, problem.start, problem.goals, gl.primitives));
  gl.retrieval_time_s = stopwatch.elapsed_s();
  return gl;
}

}  // namespace mneme::internal
