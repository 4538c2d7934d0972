// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "output_check.h"

#include <array>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

namespace mneme::app {
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

/// The files that FILE.json#NAME and SCENE.yaml,REQUEST.yaml name.
std::vector<std::string> files_of(const std::string& where) {
  if (const std::size_t json = where.find(".json#"); json != std::string::npos) {
    return {where.substr(0, json + 5)};
  }
  for (const std::string_view end : {".yaml,", ".yml,"}) {
    const std::size_t first = where.find(end);
    if (first == std::string::npos) continue;
    const std::size_t comma = first + end.size() - 1;
    return {where, where.substr(0, comma), where.substr(comma + 1)};
  }
  return {where};
}

}  // namespace

std::vector<ReadFile> robot_files(const std::string& urdf, const std::string& srdf) {
  const fs::path beside = fs::path(urdf).replace_extension(".srdf");
  return {{"the robot", urdf}, {"the robot", srdf}, {"the robot", beside.string()}};
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
    for (const ReadFile& input : inputs) {
      for (const std::string& file : files_of(input.path)) {
        if (!is_same_file(output, file)) continue;
        return fail(
            ErrorCode::invalid,
            fmt::format("'{}' is {} that is read; expected another file", output, input.what));
      }
    }
    for (const std::string& other : outputs.first(i)) {
      if (!is_same_file(output, other)) continue;
      return fail(ErrorCode::invalid,
                  fmt::format("'{}' is to be written twice; expected different files", output));
    }
    if (auto checked = refuse_memory(output); !checked) return checked;
  }
  return {};
}

}  // namespace mneme::app
