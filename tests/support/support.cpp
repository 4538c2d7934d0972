// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/support.h"

#include "robot/kinematics.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace mneme::test {

TemporaryDirectory::TemporaryDirectory() {
  std::string name = (std::filesystem::temp_directory_path() / "mneme-test-XXXXXX").string();
  path_ = ::mkdtemp(name.data());
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryDirectory::operator/(const std::string& name) const {
  return (path_ / name).string();
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string read_file(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::string source_file(const std::string& name) {
  return std::string(MNEME_SOURCE_DIRECTORY) + "/" + name;
}

int rounds(int usual) {
  const char* soak = std::getenv("MNEME_SOAK");
  return soak == nullptr ? usual : std::max(usual, std::atoi(soak));
}

std::optional<std::string> data_file(const std::string& name) {
  const char* root = std::getenv("MNEME_DATA");
  if (root == nullptr || *root == '\0') {
    MESSAGE("skipped: MNEME_DATA is not set, so there is no " << name);
    return std::nullopt;
  }
  const std::string path = std::string(root) + "/" + name;
  if (!std::filesystem::exists(path)) {
    MESSAGE("skipped: there is no " << path);
    return std::nullopt;
  }
  return path;
}

Robot planar8() { return require(load_robot(source_file("robots/planar8.urdf"))); }

SolveResult require_solved(const Problem& problem, Database* database,
                           const SolveSettings& settings, const char* file, int line) {
  SolveResult result = require(solve(problem, database, settings), file, line);
  if (!result.plan.is_solved()) ADD_FAIL_AT(file, line, result.plan.message);
  return result;
}

Configuration random_configuration(const Robot& robot, Rng& rng) {
  return internal::random_configuration(robot, rng);
}

}  // namespace mneme::test
