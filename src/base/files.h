// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reads text files, writes files that readers see whole or not at all, and finds the directories
/// of an installation.
#pragma once

#include "mneme/base.h"

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

inline constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;

/// Returns the bytes of a regular file, or of a stream named /dev/stdin, /dev/fd/N or /dev/null.
/// Other devices and pipes are refused without waiting. Errors: io; unsupported for more than
/// `max_bytes`.
[[nodiscard]] Result<std::string> read_text_file(const std::string& path,
                                                 std::size_t max_bytes = kMaxFileBytes);

/// As read_text_file(), for regular files only.
[[nodiscard]] Result<std::string> read_regular_file(const std::string& path,
                                                    std::size_t max_bytes = kMaxFileBytes);

/// Returns PREFIX/share/mneme for a file in PREFIX/bin/.. or PREFIX/lib/..; the innermost bin or
/// lib counts. Empty without one, and for a relative path.
[[nodiscard]] std::filesystem::path shared_data_of(const std::filesystem::path& file);

/// Returns $XDG_CACHE_HOME/mneme or ~/.cache/mneme, which need not exist. Empty if neither variable
/// holds an absolute path.
[[nodiscard]] std::string cache_directory();

/// Returns the directories that an environment variable lists, separated by colons.
[[nodiscard]] std::vector<std::string> directories_of_variable(const char* variable);

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using UniqueFile = std::unique_ptr<std::FILE, CloseFile>;

/// Writes `path.unfinished` and renames it to `path` at the end. Links and special files, such as
/// /dev/stdout, are written directly. Errors name `path`.
class NewFile {
 public:
  /// Error: io, also while another process or another NewFile writes `path`.
  [[nodiscard]] static Result<NewFile> create(const std::string& path);
  NewFile(NewFile&&) noexcept = default;
  NewFile& operator=(NewFile&&) = delete;
  /// Removes an unfinished file.
  ~NewFile();

  [[nodiscard]] Result<void> write(std::string_view bytes);
  /// Syncs the file to disk and renames it, so that it survives a loss of power.
  [[nodiscard]] Result<void> finish();

 private:
  NewFile() = default;
  [[nodiscard]] tl::unexpected<Error> error() const;
  std::string path_;
  std::string written_path_;
  UniqueFile file_;
};

}  // namespace mneme::internal
