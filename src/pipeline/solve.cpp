// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// decompose the scene -> retrieve (or learn) a local sampler per primitive -> synthesize one
// sampler -> plan
#include <algorithm>
#include <array>

#include "base/stopwatch.h"
#include "mneme/pipeline.h"
#include "pipeline/valid_components.h"

namespace mneme {
namespace {

constexpr std::array<std::string_view, 3> kSamplerNames = {"gl", "uniform", "halton"};

std::string join(std::span<const std::string_view> names) {
  std::string text;
  for (const std::string_view name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

Result<const PlannerEntry*> choose_planner(const std::string& name) {
  if (const PlannerEntry* planner = find_planner(name)) return planner;
  std::vector<std::string_view> names;
  for (const PlannerEntry& planner : planners()) names.push_back(planner.name);
  return fail(ErrorCode::invalid, "unknown planner '" + name + "': expected one of " + join(names));
}

/// Every number of `settings` within its declared range.
template <class Settings>
Result<void> check_ranges(const Settings& settings) {
  std::string problem;
  visit_settings(settings,
                 [&](const char* name, const auto& value, auto least, auto most, const char*) {
                   // Written so that a value that is not a number fails too.
                   if (!(value >= least && value <= most))
                     problem = std::string("setting '") + name + "' is out of range";
                 });
  if (!problem.empty()) return fail(ErrorCode::invalid, problem);
  return {};
}

Result<void> check_settings(const SolveSettings& settings) {
  if (std::find(kSamplerNames.begin(), kSamplerNames.end(), settings.sampler) ==
      kSamplerNames.end()) {
    return fail(ErrorCode::invalid, "unknown sampler '" + settings.sampler + "': expected one of " +
                                        join(kSamplerNames));
  }
  for (const auto& checked : {check_ranges(settings), check_ranges(settings.plan),
                              check_ranges(settings.decompose), check_ranges(settings.learn)}) {
    if (!checked) return checked;
  }
  return {};
}

/// Algorithm 1: samples from memory with probability lambda. Without components it is the uniform
/// sampler.
std::shared_ptr<const Sampler> make_sampler(const Robot& robot, const SolveSettings& settings,
                                            const GlSampler& gl) {
  if (settings.sampler == "halton") return make_halton_sampler(robot);
  std::shared_ptr<const Sampler> uniform = make_uniform_sampler(robot);
  if (gl.mixture == nullptr || gl.mixture->component_count() == 0) return uniform;
  return make_mixed_sampler(settings.lambda,
                            make_mixture_sampler(robot, gl.mixture, settings.sigma), uniform);
}

Result<GlSampler> recall(const Problem& problem, Database& database,
                         const CollisionChecker& checker, const SolveSettings& settings) {
  auto gl = create_gl_sampler(problem.robot, problem.scene, database, settings);
  if (gl && settings.drop_invalid_means) {
    gl->mixture = std::make_shared<const GaussianMixture>(
        internal::keep_valid_components(checker, *gl->mixture));
  }
  return gl;
}

}  // namespace

std::span<const std::string_view> sampler_names() { return kSamplerNames; }

Result<SolveResult> solve(const Problem& problem, Database* database,
                          const SolveSettings& settings) {
  const internal::Stopwatch stopwatch;
  if (auto checked = check_settings(settings); !checked) return tl::unexpected(checked.error());
  const auto planner = choose_planner(settings.planner);
  if (!planner) return tl::unexpected(planner.error());
  CheckerSettings checking;
  checking.resolution = settings.resolution;
  checking.isa = settings.isa;
  const auto checker = CollisionChecker::make(problem.robot, problem.scene, checking);
  if (!checker) return tl::unexpected(checker.error());

  SolveResult result;
  const PlanQuery query = {problem.start, problem.goals};
  if (auto refused = refuse_query(*checker, query)) {
    result.plan = *std::move(refused);
  } else {
    if (settings.sampler == "gl" && database != nullptr) {
      SolveSettings rest = settings;
      rest.plan.timeout_s -= stopwatch.elapsed_s();
      auto gl = recall(problem, *database, *checker, rest);
      if (!gl) return tl::unexpected(gl.error());
      result.gl = std::move(*gl);
    }
    const std::shared_ptr<const Sampler> sampler = make_sampler(problem.robot, settings, result.gl);
    PlanSettings plan = settings.plan;
    // What retrieval and learning took is planning time, so the planner has the rest.
    plan.timeout_s = std::max(0.0, plan.timeout_s - stopwatch.elapsed_s());
    result.plan = (*planner)->plan(*checker, query, *sampler, plan);
  }
  result.planner = settings.planner;
  result.sampler = settings.sampler;
  result.seed = settings.plan.seed;
  result.isa = checker->isa();
  result.total_time_s = stopwatch.elapsed_s();
  result.planning_time_s =
      result.total_time_s - result.plan.simplification_time_s - result.plan.verification_time_s;
  return result;
}

}  // namespace mneme
