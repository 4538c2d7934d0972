// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shared by tests of several rooms: files, the planar arm, problems from MNEME_DATA.
#pragma once

#include "mneme/mneme.h"

#include "support/require.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

namespace mneme::test {

inline constexpr double kPi = std::numbers::pi;

/// How many times slower code is that is instrumented or emulated.
#ifdef MNEME_SLOWDOWN
inline constexpr double kSlowdown = MNEME_SLOWDOWN;
#else
inline constexpr double kSlowdown = 1;
#endif

/// A fresh directory that is removed with its contents.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory();
  [[nodiscard]] std::string operator/(const std::string& name) const;

 private:
  std::filesystem::path path_;
};

void write_file(const std::string& path, const std::string& text);
std::string read_file(const std::string& path);

/// True if `part` stands in `text`.
inline bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

/// A file of the repository, such as "robots/planar8.urdf".
std::string source_file(const std::string& name);

/// A file below MNEME_DATA, or nothing (with a message) if that is not set.
std::optional<std::string> data_file(const std::string& name);

/// How often a test repeats something: `usual`, or as often as MNEME_SOAK says, if that is more.
int rounds(int usual);

/// The planar arm that the paper's scenarios use.
Robot planar8();

/// Plans a problem, which must have a path. `file` and `line`: the caller's.
SolveResult require_solved(const Problem& problem, Database* database,
                           const SolveSettings& settings, const char* file = __builtin_FILE(),
                           int line = __builtin_LINE());

/// A uniform random configuration.
Configuration random_configuration(const Robot& robot, Rng& rng);

}  // namespace mneme::test
