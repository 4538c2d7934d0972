// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <exception>
#include <optional>

#include <ompl/util/RandomNumbers.h>

#include "base/stopwatch.h"
#include "mneme/ompl.h"
#include "ompl/ompl_run.h"
#include "ompl/silence.h"
#include "pipeline/check_settings.h"
#include "pipeline/complete_settings.h"
#include "pipeline/database_check.h"
#include "pipeline/make_checker.h"
#include "pipeline/recall.h"
#include "pipeline/remember.h"

namespace mneme {
namespace {

using ompl::OmplPlanner;

Result<const OmplPlanner*> choose_planner(const std::string& name) {
  if (const OmplPlanner* planner = ompl::find_ompl_planner(name)) return planner;
  return fail(ErrorCode::invalid, "unknown planner '" + name + "' of OMPL: expected one of " +
                                      internal::join(ompl_planner_names()));
}

bool is_valid_state_sampler(const std::string& name) {
  const auto names = ompl_sampler_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

Result<void> check_settings(const SolveSettings& settings, const OmplPlanner& planner) {
  for (const auto& checked :
       {internal::check_ranges(settings), internal::check_verification(settings.plan)}) {
    if (!checked) return checked;
  }
  if (!is_valid_state_sampler(settings.sampler)) {
    return internal::check_sampler(settings, sampler_names());
  }
  if (planner.draws_valid_states) return {};
  return fail(ErrorCode::invalid,
              "sampler '" + settings.sampler +
                  "' is for planners that draw valid states, such as PRM, not " +
                  std::string(planner.name));
}

/// OMPL's seeds are a sequence of its own, shared by the process; 0 is none.
void seed_ompl(std::uint64_t seed) {
  ::ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(derive_seed(seed, 0) % 0xFFFFFFFEu + 1));
}

/// The allocator of what settings.sampler names; empty for OMPL's own uniform samples.
Result<::ompl::base::StateSamplerAllocator> make_allocator(
    const Problem& problem, const SolveSettings& settings,
    std::optional<internal::Recall>& recall) {
  if (settings.sampler == "uniform" || is_valid_state_sampler(settings.sampler)) {
    return ::ompl::base::StateSamplerAllocator();
  }
  std::shared_ptr<const Sampler> sampler;
  if (recall) {
    sampler = recall->make_sampler();
    if (recall->failure()) return tl::unexpected(*recall->failure());
  } else {
    sampler = internal::make_sampler(problem.robot, settings, {});
  }
  return ompl::sampler_allocator(std::move(sampler), settings.plan.seed);
}

Result<SolveResult> solve_within(const Problem& problem, Database* database,
                                 const SolveSettings& asked, const OmplSettings& ompl) {
  const internal::Stopwatch stopwatch;
  const auto planner = choose_planner(asked.planner);
  if (!planner) return tl::unexpected(planner.error());
  if (auto checked = check_settings(asked, **planner); !checked) {
    return tl::unexpected(checked.error());
  }
  const SolveSettings settings = internal::complete_settings(asked, problem.robot, database);
  const auto checker = internal::make_checker(problem, settings);
  if (!checker) return tl::unexpected(checker.error());

  SolveResult result;
  if (auto refused = refuse_query(*checker, {problem.start, problem.goals})) {
    result.plan = *std::move(refused);
  } else {
    const internal::Stopwatch recalling;
    const bool asks_memory = internal::is_memory_sampler(settings.sampler) && database != nullptr;
    std::optional<internal::Recall> recall;
    if (asks_memory) {
      auto checked = internal::check_database(problem.robot, settings, *database);
      if (!checked) return tl::unexpected(checked.error());
      recall.emplace(problem, *database, *checker, settings);
    }
    seed_ompl(settings.plan.seed);
    const auto allocator = make_allocator(problem, settings, recall);
    if (!allocator) return tl::unexpected(allocator.error());
    const double recall_time_s = recalling.elapsed_s();
    ompl::OmplRun run(problem, *checker, settings, ompl, **planner, *allocator);
    auto planned = run.plan(stopwatch.elapsed_s());
    if (!planned) return tl::unexpected(planned.error());
    result.plan = std::move(*planned);
    result.plan.planning_time_s += recall_time_s;
    if (recall && recall->failure()) return tl::unexpected(*recall->failure());
    if (recall) result.gl = recall->take();
    // Paths of the paper's settings are not verified: they teach nothing.
    if (recall && !ompl.as_in_paper) {
      result.remembered = internal::remember(problem, result.plan, *database, settings);
    }
  }
  result.planner = settings.planner;
  result.sampler = settings.sampler;
  result.seed = settings.plan.seed;
  result.isa = checker->isa();
  result.total_time_s = stopwatch.elapsed_s();
  result.planning_time_s = result.total_time_s - result.plan.simplification_time_s -
                           result.plan.verification_time_s - result.remembered.time_s;
  return result;
}

}  // namespace

Result<SolveResult> solve_with_ompl(const Problem& problem, Database* database,
                                    const SolveSettings& settings, const OmplSettings& ompl) {
  const ompl::Silence silence;
  try {
    return solve_within(problem, database, settings, ompl);
  } catch (const std::exception& error) {
    return fail(ErrorCode::unsupported, "OMPL's " + settings.planner + ": " + error.what());
  }
}

}  // namespace mneme
