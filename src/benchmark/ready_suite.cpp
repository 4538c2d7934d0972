// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "mneme/baselines.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace mneme {
namespace {

Result<void> open_for_robots(const std::string& name, const std::string& path, OpenMode mode,
                             BenchPlan& plan) {
  const Result<Database> any = Database::inspect(path);
  if (!any) return tl::unexpected(any.error());
  for (const LoadedProblem& loaded : plan.problems) {
    const Robot& robot = loaded.problem.robot;
    const std::pair key{name, robot.hash()};
    const ExperienceSpace space = make_space(robot);
    const bool applies = compare_robots(any->space(), space) <= RobotDifference::shapes;
    if (plan.memories.contains(key) || !applies) continue;
    Result<Database> database = Database::open(path, space, mode);
    if (!database) return tl::unexpected(database.error());
    plan.memories.emplace(key, std::make_shared<Database>(std::move(*database)));
  }
  return {};
}

/// An empty memory becomes one of the robot that is planned for with it first.
Result<void> begin_memory(const std::string& name, const std::string& path, const BenchPlan& plan) {
  const Result<Database> any = Database::inspect(path);
  if (!any) return tl::unexpected(any.error());
  if (any->size() > 0) return {};
  for (const LoadedProblem& loaded : plan.problems) {
    const bool is_used = std::any_of(plan.cases.begin(), plan.cases.end(), [&](const BenchCase& c) {
      return c.memory == name && c.is_of_set(loaded.set);
    });
    if (!is_used) continue;
    const auto made = Database::open(path, make_space(loaded.problem.robot), OpenMode::create);
    return made ? Result<void>() : tl::unexpected(made.error());
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

Result<void> add_setting(const SuiteSetting& setting, const OnNote& on_note, ReadySuite& ready) {
  if (auto checked = check_sets(setting, ready.plan.problems); !checked) return checked;
  BenchCase base;
  base.setting = setting.name;
  base.memory = setting.memory;
  base.sets = setting.sets;
  base.settings = setting.solve;
  base.description = describe_settings(setting.solve);
  if (!setting.memory.empty()) {
    base.description += (base.description.empty() ? "memory=" : " memory=") + setting.memory;
  }
  std::vector<std::string> planners;
  for (const std::string& planner : setting.planners) {
    if (find_rival(planner) != nullptr || find_planner(planner)) {
      planners.push_back(planner);
    } else {
      on_note(fmt::format("left out: {}, because this build has no OMPL", planner));
    }
  }
  append_cases(base, planners, setting.samplers, ready.plan.cases);
  return {};
}

bool learns_online(const Suite& suite, const std::string& memory) {
  return std::any_of(suite.settings.begin(), suite.settings.end(), [&](const SuiteSetting& s) {
    return s.memory == memory && learns_while_planning(s.solve);
  });
}

/// Learns what is not there yet; `row` is told what it took and what there is now.
Result<bool> learn_memory(const SuiteMemory& memory, const std::string& path,
                          const std::vector<MemoryRow>& known, const SuiteHooks& hooks,
                          MemoryRow& row) {
  LearnedMemory learned;
  if (memory.file.empty()) {
    hooks.on_note(fmt::format("memory {}", memory.name));
    const Result<LearnedMemory> result = hooks.learn(memory, path);
    if (!result) return tl::unexpected(result.error());
    learned = *result;
  }
  const Result<Database> database = Database::inspect(path);
  if (!database) return tl::unexpected(database.error());
  const DatabaseInfo info = database->info();
  row = {memory.name, info.samplers, info.components, info.bytes, learned.time_s};
  const auto before = std::ranges::find(known, memory.name, &MemoryRow::name);
  const bool is_same = before != known.end() && before->primitives == row.primitives &&
                       before->components == row.components;
  if (is_same) row.learning_time_s = before->learning_time_s;
  return !learned.is_cancelled;
}

/// Gives the cases of planners with experience of their own that of the paths which their memory is
/// learned from: `directory`/MEMORY.Lightning, kept if it is there. False if interrupted.
Result<bool> train_planners(const Suite& suite, const std::string& directory,
                            const SuiteHooks& hooks, std::vector<BenchCase>& cases) {
  for (BenchCase& bench_case : cases) {
    const std::string& planner = bench_case.settings.planner;
    const auto entry = find_planner(planner);
    if (!entry || !(*entry)->train) continue;
    const auto memory = std::ranges::find(suite.memories, bench_case.memory, &SuiteMemory::name);
    if (memory == suite.memories.end() || memory->problems.empty()) {
      return fail(ErrorCode::invalid,
                  fmt::format("setting {}: {} needs a memory that is learned from problems",
                              bench_case.setting, planner));
    }
    const std::string name = planner.substr(planner.find(':') + 1);
    bench_case.settings.plan.experience_path =
        fmt::format("{}/{}.{}", directory, memory->name, name);
    if (std::filesystem::exists(bench_case.settings.plan.experience_path)) continue;
    hooks.on_note(
        fmt::format("experience of {} from the problems of memory {}", planner, memory->name));
    const Result<bool> trained =
        hooks.train(*memory, planner, bench_case.settings.plan.experience_path);
    if (!trained || !*trained) return trained;
  }
  return true;
}

}  // namespace

std::string memory_file(const SuiteMemory& memory, const std::string& directory) {
  return memory.file.empty() ? fmt::format("{}/{}.db", directory, memory.name) : memory.file;
}

Result<ReadySuite> prepare_suite(const Suite& suite, const std::string& directory,
                                 const std::vector<MemoryRow>& known, const SuiteHooks& hooks) {
  ReadySuite ready;
  auto problems = load_bench_problems(suite.problems, {}, hooks.on_note);
  if (!problems) return tl::unexpected(problems.error());
  ready.plan.problems = std::move(*problems);
  ready.plan.first_seed = suite.first_seed;
  ready.plan.seed_count = suite.seed_count;
  for (const SuiteSetting& setting : suite.settings) {
    const auto added = add_setting(setting, hooks.on_note, ready);
    if (!added) return tl::unexpected(added.error());
  }
  for (const SuiteMemory& memory : suite.memories) {
    const std::string path = memory_file(memory, directory);
    const auto learned = learn_memory(memory, path, known, hooks, ready.memories.emplace_back());
    if (!learned) return tl::unexpected(learned.error());
    if ((ready.is_interrupted = !*learned)) return ready;
    const bool grows = learns_online(suite, memory.name);
    const auto begun = grows ? begin_memory(memory.name, path, ready.plan) : Result<void>();
    if (!begun) return tl::unexpected(begun.error());
    const OpenMode mode = grows ? OpenMode::read_write : OpenMode::read_only;
    const auto opened = open_for_robots(memory.name, path, mode, ready.plan);
    if (!opened) return tl::unexpected(opened.error());
  }
  const auto trained = train_planners(suite, directory, hooks, ready.plan.cases);
  if (!trained) return tl::unexpected(trained.error());
  ready.is_interrupted = !*trained;
  return ready;
}

}  // namespace mneme
