// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Planning, inserting and refreshing for long in one process, which must neither grow nor slow.
#pragma once

#include "mneme/pipeline.h"

#include <cstdint>
#include <string>
#include <vector>

namespace mneme::soak {

/// One round: the same problems each time, with a database of its own.
struct Round {
  int plans = 0;
  int rows = 0;          ///< inserted, and seen by the reader
  double cpu_s = 0;      ///< of the process
  std::int64_t rss = 0;  ///< bytes that the process holds after the round
  int open_files = 0;    ///< after the round
};

/// Memory of this process without shared pages, after free memory was returned to the system.
[[nodiscard]] std::int64_t resident_bytes();
[[nodiscard]] int open_files();

/// However busy the machine is: fewer would tell drift from noise no more.
inline constexpr std::size_t kLeastRounds = 24;

/// Repeats the round for `seconds`, at least kLeastRounds times. A writer inserts what was learned;
/// a reader, which plans with it, refreshes after each plan. Databases are made in `directory`.
[[nodiscard]] Result<std::vector<Round>> endure(const Robot& robot, const std::string& directory,
                                                double seconds, std::uint64_t seed);

/// The first and the last quarter of the rounds after a tenth, at least four, for warming up,
/// compared.
struct Drift {
  double time_ratio = 0;         ///< of the least times, last to first
  std::int64_t grown_bytes = 0;  ///< of the median sizes
  int grown_files = 0;
};
/// At least kLeastRounds `rounds`.
[[nodiscard]] Drift drift_of(const std::vector<Round>& rounds);

}  // namespace mneme::soak
