// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"

#include "base/fail.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace mneme::internal {

namespace {

Result<std::string> read_all(const UniqueFile& file, const std::string& path,
                             std::size_t max_bytes) {
  if (file == nullptr) {
    return fail(ErrorCode::io, "{}: cannot be read: {}", path, std::strerror(errno));
  }
  std::string text;
  std::array<char, 65536> block;
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get())) {
    text.append(block.data(), count);
    if (text.size() > max_bytes) {
      return fail(ErrorCode::unsupported, "{}: expected a file of at most {} bytes", path,
                  max_bytes);
    }
  }
  if (std::ferror(file.get()) != 0) {
    return fail(ErrorCode::io, "{}: cannot be read: {}", path, std::strerror(errno));
  }
  return text;
}

bool is_named(int file, const std::string& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

/// Opens or creates a file and locks it, also one that a killed process left. Returns a negative
/// number and errno on failure: EWOULDBLOCK if another writer holds the lock. File systems without
/// locks are not protected.
int open_alone(const std::string& path) {
  for (;;) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0) return file;
    const bool is_taken = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    // Before the file was locked, another writer may have finished or removed it.
    if (!is_taken && is_named(file, path)) return file;
    (void)::close(file);
    if (!is_taken) continue;
    errno = EWOULDBLOCK;
    return -1;
  }
}

/// A descriptor for writing to what is no regular file of its own; without waiting for the reader
/// of a pipe.
int open_special(const std::string& path) {
  const int file =
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_CLOEXEC, 0666);
  if (file >= 0) (void)::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) & ~O_NONBLOCK);
  return file;
}

/// A stream that this process was given, such as standard input or a shell's <(..), or /dev/null.
bool is_own_stream(std::string_view path) {
  return path == "/dev/stdin" || path == "/dev/null" || path.starts_with("/dev/fd/") ||
         path.starts_with("/proc/self/fd/");
}

/// Syncs the directory of `path`, so that new names survive a loss of power where the file system
/// supports it.
void sync_directory_of(const std::string& path) {
  const auto directory = std::filesystem::path(path).parent_path();
  const int file = ::open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY);
  if (file < 0) return;
  (void)::fsync(file);
  (void)::close(file);
}

}  // namespace

Result<std::string> read_text_file(const std::string& path, std::size_t max_bytes) {
  if (is_own_stream(path)) {
    return read_all(UniqueFile(std::fopen(path.c_str(), "rb")), path, max_bytes);
  }
  return read_regular_file(path, max_bytes);
}

Result<std::string> read_regular_file(const std::string& path, std::size_t max_bytes) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return read_all(nullptr, path, max_bytes);
  const UniqueFile file(::fdopen(descriptor, "rb"));
  if (file == nullptr) {
    const int reason = errno;
    (void)::close(descriptor);
    errno = reason;
    return read_all(nullptr, path, max_bytes);
  }
  struct stat status {};
  const bool is_known = ::fstat(descriptor, &status) == 0;
  // Reading a directory fails with a message of its own.
  if (is_known && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) {
    return fail(ErrorCode::io, "{}: expected a regular file", path);
  }
  return read_all(file, path, max_bytes);
}

Result<NewFile> NewFile::create(const std::string& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  // A rename would replace the link itself: /dev/stdout is one.
  const bool is_link = std::filesystem::is_symlink(std::filesystem::symlink_status(path, ignored));
  const bool is_special =
      is_link || (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status));
  NewFile file;
  file.path_ = path;
  file.written_path_ = is_special ? path : path + ".unfinished";
  if (is_special) {
    const int special = open_special(path);
    if (special < 0 && errno == ENXIO) {
      return fail(ErrorCode::io, "{}: is a pipe that no process reads", path);
    }
    if (special >= 0) file.file_.reset(::fdopen(special, "wb"));
    if (file.file_ == nullptr) return file.error();
    return file;
  }
  const int alone = open_alone(file.written_path_);
  if (alone < 0 && errno == EWOULDBLOCK) {
    return fail(ErrorCode::io, "{}: is being written by another process", path);
  }
  if (alone >= 0) file.file_.reset(::fdopen(alone, "wb"));
  if (file.file_ == nullptr || ::ftruncate(alone, 0) != 0) return file.error();
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
  sync_directory_of(path_);
  return {};
}

tl::unexpected<Error> NewFile::error() const {
  return fail(ErrorCode::io, "{}: cannot be written: {}", path_,
              std::generic_category().message(errno));
}

}  // namespace mneme::internal
