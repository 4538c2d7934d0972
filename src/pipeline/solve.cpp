// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// decompose the scene -> retrieve (or learn) a local sampler per primitive -> synthesize one
// sampler -> plan
#include <algorithm>
#include <array>
#include <optional>

#include "base/stopwatch.h"
#include "mneme/pipeline.h"
#include "pipeline/complete_settings.h"
#include "pipeline/database_check.h"
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
  // The mixture is drawn from in a fraction lambda of the iterations.
  const Widening widening{settings.first_components,
                          settings.component_growth / std::max(settings.lambda, 1e-3)};
  return make_mixed_sampler(
      settings.lambda, make_mixture_sampler(robot, gl.mixture, settings.sigma, widening), uniform);
}

/// Algorithm 2 for one query, at once or when the planner asks for it.
class Recall {
 public:
  Recall(const Problem& problem, Database& database, const CollisionChecker& checker,
         const SolveSettings& settings)
      : problem_(problem), database_(database), checker_(checker), settings_(settings) {}

  /// What memory has to say, or the uniform sampler if that is nothing.
  std::shared_ptr<const Sampler> make() {
    SolveSettings rest = settings_;
    rest.plan.timeout_s -= stopwatch_.elapsed_s();
    auto gl = create_gl_sampler(problem_.robot, problem_.scene, database_, rest);
    if (!gl) {
      failure_ = gl.error();
      return make_uniform_sampler(problem_.robot);
    }
    gl_ = std::move(*gl);
    if (settings_.drop_invalid_means) {
      gl_.mixture = std::make_shared<const GaussianMixture>(
          internal::keep_valid_components(checker_, *gl_.mixture));
    }
    return make_sampler(problem_.robot, settings_, gl_);
  }

  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }
  GlSampler take() { return std::move(gl_); }

 private:
  internal::Stopwatch stopwatch_;
  const Problem& problem_;
  Database& database_;
  const CollisionChecker& checker_;
  const SolveSettings& settings_;
  GlSampler gl_;
  std::optional<Error> failure_;
};

/// The planner with memory: its time and that of retrieval are one.
Result<void> plan_with_memory(const Problem& problem, Database& database,
                              const CollisionChecker& checker, Planner plan,
                              const SolveSettings& settings, double spent_s, SolveResult& result) {
  if (auto checked = internal::check_database(problem.robot, settings, database); !checked) {
    return checked;
  }
  const internal::Stopwatch stopwatch;
  Recall recall(problem, database, checker, settings);
  std::shared_ptr<const Sampler> sampler;
  if (settings.retrieve_after == 0) {
    sampler = recall.make();
  } else {
    sampler = make_lazy_sampler(make_uniform_sampler(problem.robot), settings.retrieve_after,
                                [&recall] { return recall.make(); });
  }
  if (recall.failure()) return tl::unexpected(*recall.failure());
  PlanSettings rest = settings.plan;
  rest.timeout_s = std::max(0.0, rest.timeout_s - spent_s - stopwatch.elapsed_s());
  result.plan = plan(checker, {problem.start, problem.goals}, *sampler, rest);
  if (recall.failure()) return tl::unexpected(*recall.failure());
  result.gl = recall.take();
  return {};
}

}  // namespace

std::span<const std::string_view> sampler_names() { return kSamplerNames; }

Result<SolveResult> solve(const Problem& problem, Database* database,
                          const SolveSettings& settings) {
  const internal::Stopwatch stopwatch;
  if (auto checked = check_settings(settings); !checked) return tl::unexpected(checked.error());
  const SolveSettings complete = internal::complete_settings(settings, problem.robot);
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
  } else if (settings.sampler == "gl" && database != nullptr) {
    auto planned = plan_with_memory(problem, *database, *checker, (*planner)->plan, complete,
                                    stopwatch.elapsed_s(), result);
    if (!planned) return tl::unexpected(planned.error());
  } else {
    PlanSettings plan = settings.plan;
    plan.timeout_s = std::max(0.0, plan.timeout_s - stopwatch.elapsed_s());
    result.plan =
        (*planner)->plan(*checker, query, *make_sampler(problem.robot, complete, {}), plan);
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
