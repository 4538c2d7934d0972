// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/database_file.h"

#include "store/new_file.h"

#include <fmt/format.h>

#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace mneme::internal {
namespace {

std::int64_t size_or_zero(const std::string& path) {
  std::error_code missing;
  const auto size = std::filesystem::file_size(path, missing);
  return missing ? 0 : static_cast<std::int64_t>(size);
}

/// Only asks about the file: opening and closing it here would drop the locks that this process may
/// hold on it.
Result<void> check_access(const std::string& path, int access, const char* verb) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) {
    return fail(ErrorCode::io, fmt::format("{}: is a directory; expected a database file", path));
  }
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return fail(ErrorCode::io, fmt::format("{}: is no regular file", path));
  }
  if (::access(path.c_str(), access) != 0) {
    return fail(ErrorCode::io, fmt::format("{}: cannot be {}: {}", path, verb,
                                           std::generic_category().message(errno)));
  }
  return {};
}

/// Makes SQLite look at the file: until then it has read nothing.
Result<Connection> probed(Result<Connection> connection, const char* settings) {
  if (!connection) return connection;
  const auto version = connection->integer("PRAGMA schema_version");
  if (!version) return tl::unexpected(version.error());
  const auto set = connection->execute(settings);
  if (!set) return tl::unexpected(set.error());
  return connection;
}

/// 16 MB of pages: the inner ones of a million rows stay, so that a row costs two reads.
constexpr const char* kReading =
    "PRAGMA cell_size_check = ON; PRAGMA query_only = ON; PRAGMA cache_size = -16384";
constexpr const char* kWriting = "PRAGMA cell_size_check = ON; PRAGMA synchronous = FULL";

}  // namespace

std::string log_path(const std::string& path) {
  std::error_code error;
  const auto file = std::filesystem::canonical(path, error);
  return (error ? path : file.string()) + "-wal";
}

Result<Connection> open_for_reading(const std::string& path) {
  const auto checked = check_access(path, R_OK, "read");
  if (!checked) return tl::unexpected(checked.error());
  // A writing handle, where that is allowed, so that the log of a killed process is put in order.
  auto connection = probed(Connection::open(path, Connection::Access::read_write), kReading);
  if (connection || connection.error().code != ErrorCode::io) return connection;
  if (size_or_zero(log_path(path)) > 0) {
    return fail(ErrorCode::io,
                fmt::format("{}; its log {} holds unfinished work: open it once where its "
                            "directory may be written",
                            connection.error().message, log_path(path)));
  }
  return probed(Connection::open(path, Connection::Access::immutable), kReading);
}

Result<Connection> open_for_writing(const std::string& path, bool can_create) {
  std::error_code ignored;
  const bool is_new = can_create && !std::filesystem::exists(path, ignored);
  if (!is_new) {
    const auto checked = check_access(path, R_OK | W_OK, "written");
    if (!checked) return tl::unexpected(checked.error());
  }
  const auto access = is_new ? Connection::Access::create : Connection::Access::read_write;
  auto connection = probed(Connection::open(path, access), kWriting);
  if (connection && !connection->is_read_only()) return connection;
  if (!connection && connection.error().code != ErrorCode::io) return connection;
  return fail(ErrorCode::io,
              fmt::format("{}; expected a file that may be written in a directory that may be "
                          "written",
                          connection ? path + ": is read-only" : connection.error().message));
}

std::int64_t bytes_on_disk(const std::string& path) {
  return size_or_zero(path) + size_or_zero(log_path(path));
}

FileStamp stamp_of(const std::string& path) {
  FileStamp stamp;
  const std::array files = {path, log_path(path)};
  for (std::size_t i = 0; i < files.size(); ++i) {
    stamp.bytes[i] = size_or_zero(files[i]);
    std::error_code ignored;
    // An empty log says as much as none.
    if (stamp.bytes[i] > 0) stamp.times[i] = std::filesystem::last_write_time(files[i], ignored);
  }
  return stamp;
}

namespace {

std::string free_name(const std::string& path, const std::string& suffix) {
  std::error_code ignored;
  std::string name = fmt::format("{}.{}", path, suffix);
  for (int i = 2; std::filesystem::exists(name, ignored); ++i) {
    name = fmt::format("{}.{}.{}", path, suffix, i);
  }
  return name;
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
