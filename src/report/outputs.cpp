// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>

namespace mneme {
namespace {

namespace fs = std::filesystem;

// The header of SQLite's files: its name, and at 68 the PRAGMA application_id of docs/database.md.
constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);
constexpr std::size_t kApplicationIdOffset = 68;
constexpr std::string_view kMemoryId = "mnem";

/// Pipes and devices lose nothing, and reading them could wait for ever.
bool is_special(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status);
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  if (a.empty() || b.empty() || is_special(a)) return false;
  // Files that are still to be made have nothing but their names.
  return fs::equivalent(a, b, ignored) ||
         fs::weakly_canonical(a, ignored) == fs::weakly_canonical(b, ignored);
}

/// Such files are read, and never written: whoever names one as an output has mistaken it.
Result<void> refuse_geometry(const std::string& path) {
  constexpr std::array kRead = {".stl", ".obj", ".dae", ".ply", ".pcd", ".bt", ".ot"};
  const std::string extension = fs::path(path).extension().string();
  std::string suffix = extension;
  std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return std::tolower(c); });
  if (std::find(kRead.begin(), kRead.end(), suffix) == kRead.end()) return {};
  return fail(
      ErrorCode::invalid,
      fmt::format("'{}' is a {} file, which mneme reads and does not write; expected another", path,
                  extension));
}

}  // namespace

std::vector<ReadFile> robot_files(const std::string& urdf, const std::string& srdf) {
  const fs::path beside = fs::path(urdf).replace_extension(".srdf");
  return {{"the robot", urdf}, {"the robot", srdf}, {"the robot", beside.string()}};
}

void add_files(std::string_view what, std::span<const std::string> files,
               std::vector<ReadFile>& all) {
  for (const std::string& file : files) all.push_back({std::string(what), file});
}

void add_problem_files(std::string_view what, const Problem& problem, const std::string& srdf,
                       std::vector<ReadFile>& all) {
  for (ReadFile& file : robot_files(problem.robot_path, srdf)) all.push_back(std::move(file));
  add_files(what, problem.files, all);
}

Result<void> refuse_memory(const std::string& path) {
  std::array<char, kApplicationIdOffset + kMemoryId.size()> header{};
  if (!is_special(path)) std::ifstream(path, std::ios::binary).read(header.data(), header.size());
  const std::string_view bytes(header.data(), header.size());
  if (!bytes.starts_with(kSqliteMagic) || !bytes.ends_with(kMemoryId)) return {};
  return fail(ErrorCode::invalid, fmt::format("'{}' is a memory; expected another file", path));
}

Result<void> check_outputs(std::span<const std::string> outputs, std::span<const ReadFile> inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::string& output = outputs[i];
    std::set<std::string_view> seen;  // many problems come from one file
    for (const ReadFile& input : inputs) {
      if (!seen.insert(input.path).second || !is_same_file(output, input.path)) continue;
      return fail(ErrorCode::invalid, fmt::format("'{}' is {} that is read; expected another file",
                                                  output, input.what));
    }
    for (const std::string& other : outputs.first(i)) {
      if (!is_same_file(output, other)) continue;
      return fail(ErrorCode::invalid,
                  fmt::format("'{}' is to be written twice; expected different files", output));
    }
    if (auto checked = refuse_geometry(output); !checked) return checked;
    if (auto checked = refuse_memory(output); !checked) return checked;
  }
  return {};
}

}  // namespace mneme
