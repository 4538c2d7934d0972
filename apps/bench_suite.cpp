// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "bench_suite.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "bench_problems.h"
#include "bench_solve.h"
#include "console.h"
#include "inputs.h"
#include "output_file.h"
#include "problem_part.h"
#include "suite_memory.h"

namespace mneme::app {
namespace {

Result<void> open_for_robots(const std::string& name, const std::string& path, OpenMode mode,
                             BenchPlan& plan) {
  const Result<Database> any = inspect_database(path);
  if (!any) return tl::unexpected(any.error());
  for (const LoadedProblem& loaded : plan.problems) {
    const Robot& robot = loaded.problem.robot;
    const std::pair key{name, robot.hash()};
    if (plan.memories.contains(key) || any->space().robot_hash != robot.hash()) continue;
    Result<Database> database = open_database(path, robot, mode);
    if (!database) return tl::unexpected(database.error());
    plan.memories.emplace(key, std::move(*database));
  }
  return {};
}

Result<void> check_sets(const SuiteSetting& setting, const std::vector<LoadedProblem>& problems) {
  for (const std::string& set : setting.sets) {
    const bool is_known = std::any_of(problems.begin(), problems.end(),
                                      [&](const LoadedProblem& p) { return p.set == set; });
    if (!is_known) {
      return fail(ErrorCode::invalid,
                  fmt::format("setting {}: there is no set '{}' of problems", setting.name, set));
    }
  }
  return {};
}

Result<void> add_setting(const SuiteSetting& setting, ReadySuite& ready) {
  if (auto checked = check_sets(setting, ready.plan.problems); !checked) return checked;
  std::vector<std::string> planners;
  for (const std::string& planner : setting.planners) {
    if (!is_missing_planner(planner))
      planners.push_back(planner);
    else
      print_note(fmt::format("left out: {}, because this build has no OMPL", planner));
  }
  BenchCase base;
  base.setting = setting.name;
  base.memory = setting.memory;
  base.sets = setting.sets;
  base.settings = setting.solve;
  base.is_ompl_as_in_paper = setting.is_ompl_as_in_paper;
  base.description = describe_settings(setting.solve);
  const auto add = [&](const std::string& text) {
    base.description += (base.description.empty() ? "" : " ") + text;
  };
  if (setting.is_ompl_as_in_paper) add("ompl-defaults=true");
  if (!setting.memory.empty()) add("memory=" + setting.memory);
  append_cases(base, planners, setting.samplers, ready.plan.cases);
  return {};
}

bool learns_online(const Suite& suite, const std::string& memory) {
  return std::any_of(suite.settings.begin(), suite.settings.end(), [&](const SuiteSetting& s) {
    return s.memory == memory && learns_while_planning(s.solve);
  });
}

}  // namespace

Result<std::vector<LoadedProblem>> load_bench_problems(const std::vector<SuiteProblems>& found,
                                                       const ProblemOptions& overrides) {
  std::vector<LoadedProblem> problems;
  std::set<std::string> warnings;
  for (const SuiteProblems& entry : found) {
    auto all = find_bench_problems({entry.where}).and_then([&](auto list) {
      return take_part(std::move(list), entry.part);
    });
    if (!all) return tl::unexpected(all.error());
    for (const BenchProblem& bench : *all) {
      Result<Problem> problem = load_problem(bench.where, overrides);
      if (!problem) return tl::unexpected(problem.error());
      for (const std::string& warning : problem->warnings) {
        if (warnings.insert(warning).second) print_note("warning: " + warning);
      }
      problems.push_back({entry.set.empty() ? bench.set : entry.set, std::move(*problem)});
    }
  }
  return problems;
}

Result<ReadySuite> make_ready(const Suite& suite, const std::string& directory,
                              const std::vector<MemoryRow>& known, int jobs) {
  ReadySuite ready;
  auto problems = load_bench_problems(suite.problems, {});
  if (!problems) return tl::unexpected(problems.error());
  ready.plan.problems = std::move(*problems);
  ready.plan.first_seed = suite.first_seed;
  ready.plan.seed_count = suite.seed_count;
  for (const SuiteSetting& setting : suite.settings) {
    if (auto added = add_setting(setting, ready); !added) return tl::unexpected(added.error());
  }
  if (auto made = make_directory(directory); !made) return tl::unexpected(made.error());
  for (const SuiteMemory& memory : suite.memories) {
    const std::string path = memory_file(memory, directory);
    const auto learned = learn_memory(memory, path, jobs, known, ready.memories.emplace_back());
    if (!learned) return tl::unexpected(learned.error());
    if ((ready.is_interrupted = !*learned)) return ready;
    const OpenMode mode =
        learns_online(suite, memory.name) ? OpenMode::read_write : OpenMode::read_only;
    const auto opened = open_for_robots(memory.name, path, mode, ready.plan);
    if (!opened) return tl::unexpected(opened.error());
  }
  const auto trained = train_experiences(suite, directory, ready.plan.cases);
  if (!trained) return tl::unexpected(trained.error());
  ready.is_interrupted = !*trained;
  return ready;
}

}  // namespace mneme::app
