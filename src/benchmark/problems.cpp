// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <utility>

namespace mneme {
namespace {

namespace fs = std::filesystem;

bool is_yaml(const fs::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

/// Scenes, grids and settings lie beside problems: a problem has a line of its own for its goal.
bool is_problem_file(const fs::path& path) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("goal:") || line.starts_with("goals:") ||
        line.starts_with("goal_constraints:")) {
      return true;
    }
  }
  return false;
}

/// `path` without its extension, as seen from `directory`.
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
                         std::vector<BenchProblem>& problems) {
  if (path.extension() != ".json") {
    problems.push_back({directory_name(path, directory), path.string()});
    return {};
  }
  const Result<std::vector<std::string>> names = list_problems(path.string());
  if (!names) return tl::unexpected(names.error());
  for (const std::string& name : *names) {
    problems.push_back({set_name(path, directory), path.string() + "#" + name});
  }
  return {};
}

Result<void> append_directory(const fs::path& directory, std::vector<BenchProblem>& problems) {
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
    return fail(ErrorCode::io,
                fmt::format("cannot read '{}': {}", directory.string(), error.message()));
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& path : files) {
    const Result<void> appended = append_file(path, directory, problems);
    if (!appended) return appended;
  }
  return {};
}

/// Files that a suite takes together as one set may share names, which would then be taken for one
/// problem: these get the name of their own set before them.
void tell_apart(const std::vector<std::string>& own_sets, std::vector<LoadedProblem>& problems) {
  const auto key = [](const LoadedProblem& of) { return std::pair(of.set, of.problem.name); };
  std::map<std::pair<std::string, std::string>, std::set<std::string>> sets_of;
  for (std::size_t i = 0; i < problems.size(); ++i) sets_of[key(problems[i])].insert(own_sets[i]);
  for (std::size_t i = 0; i < problems.size(); ++i) {
    if (sets_of[key(problems[i])].size() == 1) continue;
    problems[i].problem.name = fmt::format("{}#{}", own_sets[i], problems[i].problem.name);
  }
}

}  // namespace

Result<std::vector<BenchProblem>> find_bench_problems(const std::vector<std::string>& arguments) {
  std::vector<BenchProblem> problems;
  for (const std::string& argument : arguments) {
    std::error_code ignored;
    Result<void> appended;
    const std::size_t before = problems.size();
    const std::size_t hash = argument.find(".json#");
    if (fs::is_directory(argument, ignored)) {
      appended = append_directory(argument, problems);
    } else if (hash != std::string::npos) {
      problems.push_back({set_name(argument.substr(0, hash + 5), {}), argument});
    } else {
      appended = append_file(argument, {}, problems);
    }
    if (!appended) return tl::unexpected(appended.error());
    if (problems.size() == before) {
      return fail(ErrorCode::invalid, fmt::format("there are no problems in '{}'", argument));
    }
  }
  return problems;
}

std::optional<Part> parse_part(std::string_view text) {
  Part part;
  const char* end = text.data() + text.size();
  const auto [slash, index_error] = std::from_chars(text.data(), end, part.index);
  if (index_error != std::errc{} || slash == end || *slash != '/') return std::nullopt;
  const auto [rest, count_error] = std::from_chars(slash + 1, end, part.count);
  const bool is_whole = count_error == std::errc{} && rest == end;
  return is_whole && part.count >= 1 && part.index <= part.count ? std::optional(part)
                                                                 : std::nullopt;
}

Result<std::vector<BenchProblem>> take_part(std::vector<BenchProblem> problems,
                                            const std::string& part) {
  if (part.empty()) return problems;
  const std::optional<Part> parsed = parse_part(part);
  if (!parsed || parsed->index == 0) {
    return fail(ErrorCode::invalid,
                fmt::format("'{}' is no part; expected I/N with 1 <= I <= N, such as 1/2", part));
  }
  std::vector<BenchProblem> taken;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    if (parsed->holds(i)) taken.push_back(std::move(problems[i]));
  }
  return taken;
}

Result<std::vector<LoadedProblem>> load_bench_problems(const std::vector<SuiteProblems>& found,
                                                       const ProblemOptions& overrides,
                                                       const OnNote& on_note) {
  std::vector<LoadedProblem> problems;
  std::vector<std::string> own_sets;
  std::set<std::string> warnings;
  const auto cache = make_problem_cache();
  for (const SuiteProblems& entry : found) {
    auto all = find_bench_problems({entry.where}).and_then([&](auto list) {
      return take_part(std::move(list), entry.part);
    });
    if (!all) return tl::unexpected(all.error());
    ProblemOptions options = overrides;
    if (!entry.robot.empty()) options.robot_path = entry.robot;
    if (!entry.srdf.empty()) options.robot.srdf_path = entry.srdf;
    options.cache = cache;
    for (const BenchProblem& bench : *all) {
      Result<Problem> problem = load_problem(bench.where, options);
      if (!problem) return tl::unexpected(problem.error());
      for (const std::string& warning : problem->warnings) {
        if (warnings.insert(warning).second) on_note("warning: " + warning);
      }
      problems.push_back({entry.set.empty() ? bench.set : entry.set, std::move(*problem)});
      own_sets.push_back(bench.set);
    }
  }
  tell_apart(own_sets, problems);
  return problems;
}

}  // namespace mneme
