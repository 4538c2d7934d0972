// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "origins.h"

#include "errors.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <mutex>
#include <utility>

namespace mneme::python {
namespace {

using Files = std::vector<ReadFile>;

struct Origins {
  std::mutex mutex;
  std::map<std::weak_ptr<const void>, Files, std::owner_less<>> files;
};

Origins& origins() {
  static Origins kept;
  return kept;
}

void append(Files files, Files& all) { std::ranges::move(files, std::back_inserter(all)); }

}  // namespace

void set_origin(const std::weak_ptr<const void>& object, std::vector<ReadFile> files) {
  if (files.empty()) return;
  Origins& kept = origins();
  const std::scoped_lock locked(kept.mutex);
  std::erase_if(kept.files, [](const auto& entry) { return entry.first.expired(); });
  kept.files[object] = std::move(files);
}

std::vector<ReadFile> origin_of(const std::weak_ptr<const void>& object) {
  Origins& kept = origins();
  const std::scoped_lock locked(kept.mutex);
  const auto found = kept.files.find(object);
  return found == kept.files.end() ? Files() : found->second;
}

void check_output(const std::string& output, std::span<const SharedProblem> problems,
                  std::vector<ReadFile> memory_files, std::string_view what) {
  Files inputs = std::move(memory_files);
  for (const SharedProblem& problem : problems) {
    add_problem_files(what, problem.rest(), "", inputs);
    append(origin_of(problem.rest().robot.without_attached().identity()), inputs);
    append(origin_of(problem.scene()), inputs);
  }
  unwrap(check_outputs(std::array{output}, inputs));
}

}  // namespace mneme::python
