// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Zip archives without compression: what numpy.savez() writes and numpy.load() reads.
#pragma once

#include "mneme/base.h"
#include "experience/new_file.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// The polynomial of zip and Ethernet.
[[nodiscard]] std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

/// Writes members one after the other, in the form for large archives (zip64). The bytes depend on
/// the members alone.
class ZipWriter {
 public:
  explicit ZipWriter(NewFile& file) : file_(file) {}
  /// `head` and `body` are one member.
  [[nodiscard]] Result<void> add(const std::string& name, std::string_view head,
                                 std::string_view body);
  /// Writes the directory; nothing can be added afterwards.
  [[nodiscard]] Result<void> finish();

 private:
  NewFile& file_;
  std::string directory_;
  std::uint64_t offset_ = 0;
  std::uint64_t count_ = 0;
};

/// The members of an archive by name; views into `archive`. Errors: parse if it is no zip file or
/// damaged; unsupported if a member is compressed. Messages begin with `path`.
[[nodiscard]] Result<std::map<std::string, std::string_view>> read_zip(const std::string& path,
                                                                       std::string_view archive);

}  // namespace mneme::internal
