// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = mneme::fuzz::as_file(data, size, "problem.yaml");
  static const auto robots = mneme::make_problem_cache();
  mneme::ProblemOptions options;
  options.robot_path = "planar8";
  options.cache = robots;
  const auto problem = mneme::load_problem(path, options);
  mneme::fuzz::expect_message(problem);
  mneme::fuzz::expect_message(mneme::extract_scene(path));
  if (problem && problem->goals.empty()) std::abort();
  return 0;
}
