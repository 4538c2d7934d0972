// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/file_copy.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

namespace mneme::internal {
namespace {

std::string free_name(const std::string& path, const std::string& suffix) {
  std::error_code ignored;
  std::string name = fmt::format("{}.{}", path, suffix);
  for (int i = 2; std::filesystem::exists(name, ignored); ++i) {
    name = fmt::format("{}.{}.{}", path, suffix, i);
  }
  return name;
}

/// Makes a new name in a directory survive a loss of power. A file system that cannot do so has its
/// own rules.
void sync_directory_of(const std::string& path) {
  const auto directory = std::filesystem::path(path).parent_path();
  const int file = ::open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY);
  if (file < 0) return;
  (void)::fsync(file);
  (void)::close(file);
}

}  // namespace

Result<std::string> copy_beside(Connection& source, const std::string& path,
                                const std::string& suffix) {
  const std::string unfinished = fmt::format("{}.{}.unfinished", path, suffix);
  remove_with_logs(unfinished);
  {
    auto copy = Connection::open(unfinished, Connection::Access::create);
    if (!copy) return tl::unexpected(copy.error());
    const auto copied = copy->copy_from(source);
    if (!copied) {
      remove_with_logs(unfinished);
      return tl::unexpected(copied.error());
    }
  }
  const std::string name = free_name(path, suffix);
  std::error_code error;
  std::filesystem::rename(unfinished, name, error);
  if (error) {
    return fail(ErrorCode::io,
                fmt::format("{}: cannot be renamed to {}: {}", unfinished, name, error.message()));
  }
  sync_directory_of(name);
  return name;
}

void remove_with_logs(const std::string& path) {
  std::error_code ignored;
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) {
    std::filesystem::remove(path + suffix, ignored);
  }
}

}  // namespace mneme::internal
