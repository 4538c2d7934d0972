// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include "base/fail.h"
#include "base/files.h"
#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <utility>

namespace mneme {
namespace {

namespace fs = std::filesystem;

bool is_yaml(const fs::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

/// Distinguishes problems from scenes, grids and settings by a line for the goal.
bool is_problem_file(const fs::path& path) {
  std::istringstream text(internal::read_text_file(path).value_or(""));
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("goal:") || line.starts_with("goals:") ||
        line.starts_with("goal_constraints:")) {
      return true;
    }
  }
  return false;
}

/// `path` without its extension, relative to `directory`.
std::string set_name(const fs::path& path, const fs::path& directory) {
  const fs::path name = directory.empty() ? path.stem() : path.lexically_relative(directory);
  return fs::path(name).replace_extension().generic_string();
}

std::string directory_name(const fs::path& path, const fs::path& directory) {
  const std::string name = path.parent_path().lexically_relative(directory).generic_string();
  if (!name.empty() && name != ".") return name;
  return fs::absolute(path).lexically_normal().parent_path().filename().string();
}

Result<void> append_file(const fs::path& path, const fs::path& directory,
                         std::vector<SuiteProblems>& problems) {
  if (path.extension() != ".json") {
    problems.push_back({path.string(), directory_name(path, directory), ""});
    return {};
  }
  const std::vector<std::string> names = MNEME_TRY(list_problems(path.string()));
  for (const std::string& name : names) {
    problems.push_back({path.string() + "#" + name, set_name(path, directory), ""});
  }
  return {};
}

Result<void> append_directory(const fs::path& directory, std::vector<SuiteProblems>& problems) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(directory, error), end; !error && it != end;
       it.increment(error)) {
    const fs::path& path = it->path();
    if (path.extension() == ".json" || (is_yaml(path) && is_problem_file(path))) {
      files.push_back(path);
    }
  }
  if (error) {
    return fail(ErrorCode::io, "cannot read '{}': {}", directory.string(), error.message());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& path : files) MNEME_TRY(append_file(path, directory, problems));
  return {};
}

/// Prefixes equal names of different problems in one set with the names of their own sets.
void make_names_unique(const std::vector<std::string>& own_sets,
                       std::vector<LoadedProblem>& problems) {
  const auto key = [](const LoadedProblem& of) { return std::pair(of.set, of.problem.name); };
  std::map<std::pair<std::string, std::string>, std::set<std::string>> sets_of;
  for (std::size_t i = 0; i < problems.size(); ++i) sets_of[key(problems[i])].insert(own_sets[i]);
  for (std::size_t i = 0; i < problems.size(); ++i) {
    if (sets_of[key(problems[i])].size() == 1) continue;
    problems[i].problem.name = fmt::format("{}#{}", own_sets[i], problems[i].problem.name);
  }
}

/// A loaded problem, its entry among the arguments, and its own file and set.
struct FoundProblem {
  const SuiteProblems* entry;
  SuiteProblems own;
  Problem problem;
};

Result<std::vector<FoundProblem>> load_each(const std::vector<SuiteProblems>& entries,
                                            const ProblemOptions& overrides,
                                            const OnNote& on_note) {
  std::vector<FoundProblem> problems;
  std::set<std::string> warnings;
  const auto cache = make_problem_cache();
  for (const SuiteProblems& entry : entries) {
    ProblemOptions options = overrides;
    if (!entry.robot.empty()) options.robot_path = entry.robot;
    if (!entry.srdf.empty()) options.robot.srdf_path = entry.srdf;
    options.cache = cache;
    const auto all = MNEME_TRY(find_bench_problems({entry.where}, entry.part));
    for (const SuiteProblems& own : all) {
      Problem problem = MNEME_TRY(load_problem(own.where, options));
      for (const std::string& warning : problem.warnings) {
        if (on_note && warnings.insert(warning).second) on_note("warning: " + warning);
      }
      problems.push_back({&entry, own, std::move(problem)});
    }
  }
  return problems;
}

}  // namespace

std::optional<Part> parse_part(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto index = internal::parse_number<std::size_t>(text.substr(0, slash));
  const auto count = internal::parse_number<std::size_t>(text.substr(slash + 1));
  if (!index || !count || *count < 1 || *index > *count) return std::nullopt;
  return Part{*index, *count};
}

Result<std::vector<SuiteProblems>> find_bench_problems(const std::vector<std::string>& arguments,
                                                       const std::string& part) {
  std::vector<SuiteProblems> problems;
  for (const std::string& argument : arguments) {
    std::error_code ignored;
    const std::size_t before = problems.size();
    const std::size_t hash = argument.find(".json#");
    if (fs::is_directory(argument, ignored)) {
      MNEME_TRY(append_directory(argument, problems));
    } else if (hash != std::string::npos) {
      problems.push_back({argument, set_name(argument.substr(0, hash + 5), {}), ""});
    } else {
      MNEME_TRY(append_file(argument, {}, problems));
    }
    if (problems.size() == before) {
      return fail(ErrorCode::invalid, "there are no problems in '{}'", argument);
    }
  }
  if (part.empty()) return problems;
  const std::optional<Part> parsed = parse_part(part);
  if (!parsed || parsed->index == 0) {
    return fail(ErrorCode::invalid, "'{}' is no part; expected I/N with 1 <= I <= N, such as 1/2",
                part);
  }
  std::size_t position = 0;
  std::erase_if(problems, [&](const SuiteProblems&) { return !parsed->holds(position++); });
  return problems;
}

Result<std::vector<LoadedProblem>> load_bench_problems(const std::vector<SuiteProblems>& found,
                                                       const ProblemOptions& overrides,
                                                       const OnNote& on_note) {
  std::vector<LoadedProblem> problems;
  std::vector<std::string> own_sets;
  std::vector<FoundProblem> loaded = MNEME_TRY(load_each(found, overrides, on_note));
  for (auto& [entry, own, problem] : loaded) {
    problems.push_back({entry->set.empty() ? own.set : entry->set, std::move(problem)});
    own_sets.push_back(own.set);
  }
  make_names_unique(own_sets, problems);
  return problems;
}

Result<std::vector<Problem>> load_lesson_problems(const std::vector<SuiteProblems>& found,
                                                  const ProblemOptions& overrides,
                                                  const OnNote& on_note) {
  std::vector<Problem> problems;
  std::vector<FoundProblem> loaded = MNEME_TRY(load_each(found, overrides, on_note));
  for (auto& [entry, own, problem] : loaded) {
    if (!problems.empty() && problems.front().robot.hash() != problem.robot.hash()) {
      return fail(
          ErrorCode::invalid,
          "'{}': its robot '{}' differs from the robot of '{}'; expected problems of one robot",
          own.where, problem.robot.name(), loaded.front().own.where);
    }
    problem.name = fmt::format("{}#{}", own.set, problem.name);
    problems.push_back(std::move(problem));
  }
  return problems;
}

}  // namespace mneme
