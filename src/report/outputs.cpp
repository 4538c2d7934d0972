// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/report.h"

#include "base/files.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>

namespace mneme {
namespace {

namespace fs = std::filesystem;

// The header of SQLite's files: its name, and at 68 the PRAGMA application_id of
// docs/design/database.md.
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

tl::unexpected<Error> cannot_write(const std::string& path) {
  return fail(ErrorCode::io, "cannot write '" + path + "': " + std::strerror(errno));
}

bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// Pipes and devices have no name to replace.
Result<void> write_in_place(const std::string& path, std::string_view text) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return cannot_write(path);
  const bool is_written = write_all(file, text);
  if (::close(file) != 0 || !is_written) return cannot_write(path);
  return {};
}

mode_t default_mode() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return static_cast<mode_t>(0666) & ~mask;
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
  if (is_special(path) && !fs::is_directory(path, ignored)) return write_in_place(path, text);
  // A symbolic link stays one: what it points to is replaced.
  const fs::path real = fs::weakly_canonical(path, ignored);
  const std::string target = real.empty() ? path : real.string();
  std::string temporary = target + ".XXXXXX";
  const int file = ::mkstemp(temporary.data());
  if (file < 0) return cannot_write(path);
  const bool is_written = write_all(file, text) && ::fchmod(file, default_mode()) == 0;
  const bool is_closed = ::close(file) == 0;
  if (!is_written || !is_closed || std::rename(temporary.c_str(), target.c_str()) != 0) {
    const auto error = cannot_write(path);
    ::unlink(temporary.c_str());
    return error;
  }
  return {};
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
    // What is renamed to it needs a place in its directory; pipes and devices are written to.
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
  if (error) {
    return fail(ErrorCode::io, "cannot make the directory '" + path + "': " + error.message());
  }
  return {};
}

}  // namespace mneme
