// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A file that appears whole or not at all.
#pragma once

#include "mneme/base.h"

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace mneme::internal {

/// Writes `path.unfinished` and gives it its name at the end; a link, and whatever is no regular
/// file, such as /dev/stdout, is written directly. Errors name `path`.
class NewFile {
 public:
  /// Errors: io, also while another process, or another NewFile, writes `path`.
  [[nodiscard]] static Result<NewFile> create(const std::string& path);
  NewFile(NewFile&&) noexcept = default;
  NewFile& operator=(NewFile&&) = delete;
  /// Removes what was not finished.
  ~NewFile();

  [[nodiscard]] Result<void> write(std::string_view bytes);
  /// Puts it on the disk and gives it its name, which survives a loss of power.
  [[nodiscard]] Result<void> finish();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  NewFile() = default;
  [[nodiscard]] tl::unexpected<Error> error() const;
  std::string path_;
  std::string written_path_;  // empty once it is finished
  std::unique_ptr<std::FILE, Close> file_;
};

/// Makes a new name in a directory survive a loss of power. A file system that cannot do so has its
/// own rules.
void sync_directory_of(const std::string& path);

}  // namespace mneme::internal
