// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/problem.h"

#include "fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = mneme::fuzz::as_file(data, size, "problems.json");
  const auto names = mneme::list_problems(path);
  mneme::fuzz::expect_message(names);
  mneme::ProblemOptions options;
  options.robot_path = "planar8";
  if (!names || names->empty()) return 0;
  const std::string address = path + "#" + names->front();
  mneme::fuzz::expect_message(mneme::load_problem(address, options));
  mneme::fuzz::expect_message(mneme::extract_scene(address));
  return 0;
}
