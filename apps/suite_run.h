// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// `mneme bench run SUITE.yaml`: runs a suite and leaves its results in a directory.
#pragma once

#include "mneme/benchmark.h"

#include "commands.h"

#include <optional>
#include <string>
#include <vector>

namespace mneme::app {

/// True of a YAML file that has a line of its own for the key `problems`.
[[nodiscard]] bool is_suite_file(const std::string& path);

struct SuiteRun {
  std::string suite;     ///< path
  std::string out;       ///< directory; empty for out/bench/NAME
  std::string memories;  ///< directory; empty for OUT/memories
  std::optional<int> seed_count;
  std::optional<double> timeout_s;    ///< of all settings
  std::vector<std::string> settings;  ///< names; empty for all
  int jobs = 1;
  bool is_resumed = false;
  bool is_json = false;
};
[[nodiscard]] Result<ExitCode> run_suite(const SuiteRun& run);

}  // namespace mneme::app
