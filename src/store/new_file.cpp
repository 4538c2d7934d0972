// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/new_file.h"

#include <fmt/format.h>

#include <unistd.h>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace mneme::internal {

Result<NewFile> NewFile::create(const std::string& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  // /dev/stdout is a link, whatever it leads to: a rename would replace the link itself.
  const bool is_link = std::filesystem::is_symlink(std::filesystem::symlink_status(path, ignored));
  const bool is_special =
      is_link || (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status));
  NewFile file;
  file.path_ = path;
  file.written_path_ = is_special ? path : path + ".unfinished";
  file.file_.reset(std::fopen(file.written_path_.c_str(), "wb"));
  if (file.file_ == nullptr) return file.error();
  return file;
}

NewFile::~NewFile() {
  if (file_ == nullptr || written_path_ == path_) return;
  std::error_code ignored;
  std::filesystem::remove(written_path_, ignored);
}

Result<void> NewFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) return error();
  return {};
}

Result<void> NewFile::finish() {
  if (std::fflush(file_.get()) != 0) return error();
  if (written_path_ == path_) return {};
  if (::fsync(::fileno(file_.get())) != 0) return error();
  if (std::rename(written_path_.c_str(), path_.c_str()) != 0) return error();
  file_.reset();
  return {};
}

tl::unexpected<Error> NewFile::error() const {
  return fail(ErrorCode::io, fmt::format("{}: cannot be written: {}", path_,
                                         std::generic_category().message(errno)));
}

}  // namespace mneme::internal
