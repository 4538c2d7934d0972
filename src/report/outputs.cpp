// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/report.h"

#include "base/fail.h"
#include "base/files.h"

#include <unistd.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>

namespace mneme {
namespace {

namespace fs = std::filesystem;

// An SQLite file begins with this name and has its PRAGMA application_id at byte 68.
constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);
constexpr std::size_t kApplicationIdOffset = 68;
constexpr std::string_view kMemoryId = "mnem";

/// True for pipes and devices: writing replaces nothing, and reading could block for ever.
bool is_special(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status);
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  if (a.empty() || b.empty() || is_special(a)) return false;
  // Files that do not exist yet are compared by name.
  return fs::equivalent(a, b, ignored) ||
         fs::weakly_canonical(a, ignored) == fs::weakly_canonical(b, ignored);
}

/// Refuses extensions of input formats, which name an output by mistake only.
Result<void> refuse_geometry(const std::string& path) {
  constexpr std::array kRead = {".stl", ".obj", ".dae", ".ply", ".pcd", ".bt", ".ot"};
  const std::string extension = fs::path(path).extension().string();
  std::string suffix = extension;
  std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return std::tolower(c); });
  if (std::find(kRead.begin(), kRead.end(), suffix) == kRead.end()) return {};
  return fail(ErrorCode::invalid,
              "'{}': mneme reads {} files, but writes none; choose another output", path,
              extension);
}

tl::unexpected<Error> cannot_write(const std::string& path) {
  return fail(ErrorCode::io, "{}: cannot be written: {}", path, std::strerror(errno));
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
  return fail(ErrorCode::invalid, "'{}' is a database of experience; choose another output", path);
}

Result<void> check_outputs(std::span<const std::string> outputs, std::span<const ReadFile> inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const std::string& output = outputs[i];
    std::set<std::string_view> seen;  // many problems may share one file
    for (const ReadFile& input : inputs) {
      if (!seen.insert(input.path).second || !is_same_file(output, input.path)) continue;
      return fail(ErrorCode::invalid, "'{}' is also an input ({}); choose another output", output,
                  input.what);
    }
    for (const std::string& other : outputs.first(i)) {
      if (!is_same_file(output, other)) continue;
      return fail(ErrorCode::invalid, "two outputs are named '{}'; choose different files", output);
    }
    MNEME_TRY(refuse_geometry(output));
    MNEME_TRY(refuse_memory(output));
  }
  return {};
}

Result<std::string> read_file(const std::string& path, std::size_t most_bytes) {
  return internal::read_text_file(path, most_bytes);
}

Result<void> write_file(const std::string& path, std::string_view text) {
  MNEME_TRY(refuse_memory(path));
  std::error_code ignored;
  // A symbolic link is kept and its target replaced, except for links such as /dev/stdout.
  const bool is_link = fs::is_symlink(path, ignored) && !is_special(path);
  auto file = MNEME_TRY(
      internal::NewFile::create(is_link ? fs::weakly_canonical(path, ignored).string() : path));
  MNEME_TRY(file.write(text));
  return file.finish();
}

Result<void> check_files_to_write(std::span<const std::string> outputs,
                                  std::span<const ReadFile> inputs) {
  MNEME_TRY(check_outputs(outputs, inputs));
  for (const std::string& output : outputs) {
    if (output.empty() || output == "-") continue;
    std::error_code ignored;
    const fs::path real = fs::weakly_canonical(fs::absolute(output, ignored), ignored);
    if (fs::is_directory(real, ignored)) {
      errno = EISDIR;
      return cannot_write(output);
    }
    // A file is renamed into its directory; pipes and devices are written directly.
    const bool is_replaced = !is_special(real);
    const fs::path written = is_replaced ? real.parent_path() : real;
    if (::access(written.c_str(), is_replaced ? W_OK | X_OK : W_OK) != 0) {
      return cannot_write(output);
    }
  }
  return {};
}

Result<void> make_directory(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error)
    return fail(ErrorCode::io, "{}: cannot make this directory: {}", path, error.message());
  return {};
}

}  // namespace mneme
