// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Uses a little of each library that mneme needs: YAML, XML, hashes, kernels, the database.
#include <cstdio>

#include "mneme/mneme.h"

int main(int, char** arguments) {
  const auto file = mneme::find_scene("planar/threaded_b2.yaml");
  if (!file) return std::puts(file.error().message.c_str()), 1;
  const auto problem = mneme::load_problem(*file);
  if (!problem) return std::puts(problem.error().message.c_str()), 1;
  const auto space = mneme::make_signature(problem->robot);
  auto memory = mneme::Database::open(arguments[1], space, mneme::OpenMode::create);
  if (!memory) return std::puts(memory.error().message.c_str()), 1;
  const auto result = mneme::solve(*problem, &*memory, {});
  if (!result || !result->plan.is_solved()) return 3;
  std::printf("%s %s\n", mneme::version().data(), file->c_str());
  return 0;
}
