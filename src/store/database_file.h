// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A database's file: opening it, with reasons that a person can act on, and copying it.
#pragma once

#include "store/sqlite_connection.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace mneme::internal {

/// Opens an existing file to read it, also where nothing beside it can be created. Errors: io if
/// there is no such file, or it may not be read; corrupt if it is no SQLite file.
[[nodiscard]] Result<Connection> open_for_reading(const std::string& path);

/// Opens a file so that what is committed survives a loss of power. Errors: those of
/// open_for_reading, and io if it may not be written.
[[nodiscard]] Result<Connection> open_for_writing(const std::string& path, bool can_create);

/// The write-ahead log of a file, which stands beside what a link leads to.
[[nodiscard]] std::string log_path(const std::string& path);

/// Bytes of the file and of its write-ahead log.
[[nodiscard]] std::int64_t bytes_on_disk(const std::string& path);

/// Sizes and times of the file and of its write-ahead log: every commit changes them, if it comes
/// at least kStampStep after the one before.
struct FileStamp {
  std::array<std::int64_t, 2> bytes{};
  std::array<std::filesystem::file_time_type, 2> times{};
  bool operator==(const FileStamp&) const = default;
};
[[nodiscard]] FileStamp stamp_of(const std::string& path);
/// Longer than the steps of the clock by which a kernel notes the times of files.
inline constexpr std::chrono::milliseconds kStampStep{20};

/// Copies what `source` holds to `PATH.suffix`, or `PATH.suffix.2` and so on if that is taken, and
/// returns the name. The copy is on the disk, whole, before it has that name.
[[nodiscard]] Result<std::string> copy_beside(Connection& source, const std::string& path,
                                              const std::string& suffix);

/// Removes a file and what SQLite keeps beside it.
void remove_with_logs(const std::string& path);

}  // namespace mneme::internal
