// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "files.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace mneme::app {
namespace {

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

Result<std::string> read_file(const std::string& path, std::size_t most_bytes) {
  const auto unreadable = [&] {
    return fail(ErrorCode::io, fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  };
  std::ifstream file(path, std::ios::binary);
  if (!file) return unreadable();
  std::string text;
  std::array<char, 65536> block{};
  while (file.read(block.data(), block.size()) || file.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (text.size() > most_bytes) {
      return fail(ErrorCode::unsupported,
                  fmt::format("{}: expected a file of at most {} bytes", path, most_bytes));
    }
  }
  if (file.bad()) return unreadable();
  return text;
}

Result<void> write_file(const std::string& path, std::string_view text) {
  if (auto checked = refuse_memory(path); !checked) return checked;
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  const bool is_special = std::filesystem::exists(status) &&
                          !std::filesystem::is_regular_file(status) &&
                          !std::filesystem::is_directory(status);
  if (is_special) return write_in_place(path, text);

  // A symbolic link stays one: what it points to is replaced.
  const std::filesystem::path real = std::filesystem::weakly_canonical(path, ignored);
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
  if (auto checked = check_outputs(outputs, inputs); !checked) return checked;
  for (const std::string& output : outputs) {
    if (output.empty() || output == "-") continue;
    std::error_code ignored;
    const std::filesystem::path real =
        std::filesystem::weakly_canonical(std::filesystem::absolute(output, ignored), ignored);
    const std::filesystem::file_status status = std::filesystem::status(real, ignored);
    if (std::filesystem::is_directory(status)) {
      errno = EISDIR;
      return cannot_write(output);
    }
    // What is renamed to it needs a place in its directory; pipes and devices are written to.
    const bool is_special =
        std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
    const std::filesystem::path written = is_special ? real : real.parent_path();
    if (::access(written.c_str(), is_special ? W_OK : W_OK | X_OK) != 0) {
      return cannot_write(output);
    }
  }
  return {};
}

Result<void> make_directory(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) {
    return fail(ErrorCode::io, "cannot make the directory '" + path + "': " + error.message());
  }
  return {};
}

}  // namespace mneme::app
