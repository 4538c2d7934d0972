// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/benchmark.h"
#include "mneme/instances.h"

#include "fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = mneme::fuzz::as_file(data, size, "suite.yaml");
  const auto suite = mneme::load_suite(path);
  mneme::fuzz::expect_message(suite);
  if (suite) {
    for (const auto& setting : suite->settings) (void)mneme::describe_settings(setting.solve);
  }
  mneme::fuzz::expect_message(mneme::load_variations(path));
  mneme::fuzz::expect_message(mneme::load_grid(path));
  return 0;
}
