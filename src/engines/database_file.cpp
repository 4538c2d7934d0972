// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/database_file.h"

#include "base/fail.h"
#include "engines/open_store.h"
#include "store/lost_rows.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <unistd.h>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace mneme::internal {
namespace {

std::int64_t size_or_zero(const std::string& path) {
  std::error_code missing;
  const auto size = std::filesystem::file_size(path, missing);
  return missing ? 0 : static_cast<std::int64_t>(size);
}

/// Checks access without opening: opening and closing would drop this process's locks on the file.
Result<void> check_access(const std::string& path, int access, const char* verb) {
  if (::access(path.c_str(), access) != 0) {
    return fail(ErrorCode::io, "{}: cannot be {}: {}", path, verb,
                std::generic_category().message(errno));
  }
  return {};
}

Result<void> check_regular(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return {};
  if (std::filesystem::is_directory(status)) {
    return fail(ErrorCode::io, "{}: is a directory; expected a regular file", path);
  }
  return fail(ErrorCode::io, "{}: expected a regular file", path);
}

/// A new database has a header before its log begins.
Result<void> refuse_orphaned_log(const std::string& path) {
  const std::int64_t log_bytes = size_or_zero(log_path(path));
  if (size_or_zero(path) > 0 || log_bytes == 0) return {};
  std::error_code ignored;
  const bool is_empty = std::filesystem::exists(path, ignored);
  return fail(
      ErrorCode::corrupt,
      "{0}: the file is {3}, but its log {1} has {2} bytes; restore the file from a copy, "
      "rename the log with a file that was renamed, or remove {1} to begin an empty database",
      path, log_path(path), log_bytes, is_empty ? "damaged: it is empty" : "missing");
}

/// Makes SQLite read the file, so that errors surface here.
Result<Connection> probed(Result<Connection> connection, const char* settings) {
  if (!connection) return connection;
  MNEME_TRY(connection->integer("PRAGMA schema_version"));
  MNEME_TRY(connection->execute(settings));
  return connection;
}

/// A cache of 16 MB holds the inner pages of a million rows, so that a row costs two reads.
constexpr const char* kReading =
    "PRAGMA cell_size_check = ON; PRAGMA query_only = ON; PRAGMA cache_size = -16384";
constexpr const char* kWriting = "PRAGMA cell_size_check = ON; PRAGMA synchronous = FULL";

}  // namespace

Result<void> check_files(const std::string& path) {
  MNEME_TRY(check_regular(path));
  for (const char* ending : {"-wal", "-shm", "-journal", ".tally"}) {
    MNEME_TRY(check_regular(real_path(path) + ending));
  }
  return refuse_orphaned_log(path);
}

Result<Connection> open_for_reading(const std::string& path) {
  MNEME_TRY(check_files(path));
  MNEME_TRY(check_access(path, R_OK, "read"));
  // A writing handle, if permitted, so that SQLite recovers the log of a killed process.
  auto connection = probed(Connection::open(path, Connection::Access::read_write), kReading);
  if (connection || connection.error().code != ErrorCode::io) return connection;
  if (size_or_zero(log_path(path)) > 0) {
    return fail(ErrorCode::io,
                "{}; its log {} must be recovered first: open the database once where its "
                "directory is writable",
                connection.error().message, log_path(path));
  }
  return probed(Connection::open(path, Connection::Access::immutable), kReading);
}

Result<Connection> open_for_writing(const std::string& path, bool can_create) {
  MNEME_TRY(check_files(path));
  std::error_code ignored;
  const bool is_new = can_create && !std::filesystem::exists(path, ignored);
  if (!is_new) MNEME_TRY(check_access(path, R_OK | W_OK, "written"));
  const auto access = is_new ? Connection::Access::create : Connection::Access::read_write;
  auto connection = probed(Connection::open(path, access), kWriting);
  if (connection && !connection->is_read_only()) return connection;
  if (!connection && connection.error().code != ErrorCode::io) return connection;
  return fail(ErrorCode::io, "{}; expected a writable file in a writable directory",
              connection ? path + ": is read-only" : connection.error().message);
}

std::int64_t bytes_on_disk(const std::string& path) {
  return size_or_zero(path) + size_or_zero(log_path(path));
}

namespace {

std::string shell_quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string saving_command(const std::string& path) {
  std::error_code ignored;
  std::string saved = path + ".saved";
  for (int i = 2; std::filesystem::exists(saved, ignored); ++i) {
    saved = fmt::format("{}.saved{}", path, i);
  }
  const bool can_recover = sqlite3_compileoption_used("ENABLE_DBPAGE_VTAB") == 1;
  return fmt::format(
      "sqlite3 {0} {1} | sed 's/^ROLLBACK/COMMIT/' | sqlite3 {2}; mneme db verify {2}",
      shell_quoted(path), can_recover ? ".recover" : ".dump", shell_quoted(saved));
}

}  // namespace mneme::internal
