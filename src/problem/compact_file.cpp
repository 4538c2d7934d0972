// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "base/text.h"
#include "input/elided.h"
#include "problem/problem_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace mneme::internal {
namespace {

constexpr std::string_view kExtension = ".json";
constexpr std::size_t kShownNames = 5;

std::string name_of(const Input& problem, std::size_t position) {
  if (const auto name = problem.find("name")) return name->text();
  if (const auto index = problem.find("index")) return fmt::format("{}", index->finite_number());
  return std::to_string(position);
}

std::vector<std::string> names_of(const std::vector<Input>& problems) {
  std::vector<std::string> names;
  for (const Input& problem : problems) names.push_back(name_of(problem, names.size() + 1));
  return names;
}

std::vector<std::string> first_names(std::vector<std::string> names) {
  names.resize(std::min(names.size(), kShownNames));
  return names;
}

std::size_t find_problem(const std::vector<std::string>& names, const CompactAddress& address) {
  const auto refuse = [&](ErrorCode code, const std::string& what) {
    throw InputFailure{{code, fmt::format("{}: {}", address.path, elided(what))}};
  };
  if (names.empty()) refuse(ErrorCode::invalid, "expected at least one problem, got an empty list");
  if (address.name.empty()) {
    refuse(ErrorCode::invalid,
           fmt::format("expected the name of one of its {} problems, as in {}#{}; the first are {}",
                       names.size(), address.path, names.front(),
                       fmt::join(first_names(names), ", ")));
  }
  const auto found = std::find(names.begin(), names.end(), address.name);
  if (found == names.end()) {
    refuse(
        ErrorCode::invalid,
        fmt::format("expected the name of one of its {} problems, got \"{}\"; the closest are {}",
                    names.size(), address.name,
                    fmt::join(close_names(address.name, names, kShownNames), ", ")));
  }
  if (std::find(found + 1, names.end(), address.name) != names.end()) {
    refuse(ErrorCode::parse, fmt::format("expected one problem \"{}\", got several", address.name));
  }
  return static_cast<std::size_t>(found - names.begin());
}

Scene read_compact_scene(const Input& problem, const std::string& name) {
  if (!problem.find("circles") && !problem.find("obstacles")) {
    problem.fail(ErrorCode::parse, "expected the key circles or obstacles, both are missing");
  }
  return read_bodies(problem, kCompactSpelling, name).scene;
}

/// One problem of a file, which must outlive it.
struct CompactProblem {
  Input header;
  Input problem;
  std::string name;
};

CompactProblem find_in_file(const InputValue& value, const CompactAddress& address) {
  const Input header(value, address.path);
  const std::vector<Input> problems = header.at("problems").items();
  const std::vector<std::string> names = names_of(problems);
  const std::size_t position = find_problem(names, address);
  return {header, problems[position], names[position]};
}

InputValue read_file(const std::string& path) {
  return parse_json(value_or_throw(read_text_file(path)), path);
}

}  // namespace

std::optional<CompactAddress> split_address(const std::string& where) {
  if (where.ends_with(kExtension)) {
    return CompactAddress{where, ""};
  }
  const std::size_t dot = where.find(std::string(kExtension) + "#");
  if (dot == std::string::npos) return std::nullopt;
  const std::size_t hash = dot + kExtension.size();
  return CompactAddress{where.substr(0, hash), where.substr(hash + 1)};
}

FramedScene extract_compact_scene(const CompactAddress& address) {
  const InputValue value = read_file(address.path);
  const CompactProblem found = find_in_file(value, address);
  Scene scene = read_compact_scene(found.problem, found.name);
  read_allowed(found.problem, scene);
  return {std::move(scene), found.header.text_or("frame", ""), {address.path}};
}

Problem read_compact_problem(const CompactAddress& address, const ProblemOptions& options) {
  const auto cache = options.cache ? options.cache : make_problem_cache();
  if (cache->file_path != address.path) {
    cache->file = read_file(address.path);
    cache->file_path = address.path;
  }
  const CompactProblem found = find_in_file(cache->file, address);
  return read_problem({found.header,
                       found.problem,
                       found.name,
                       directory_of(address.path),
                       {read_compact_scene(found.problem, found.name), {}, {address.path}},
                       kCompactSpelling},
                      options);
}

}  // namespace mneme::internal

namespace mneme {

Result<std::vector<std::string>> list_problems(const std::string& path) {
  return internal::without_throwing([&] {
    const auto text = internal::value_or_throw(internal::read_text_file(path));
    const internal::InputValue value = internal::parse_json(text, path);
    return internal::names_of(internal::Input(value, path).at("problems").items());
  });
}

}  // namespace mneme
