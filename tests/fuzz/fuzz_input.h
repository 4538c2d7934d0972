// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shared by the fuzz targets: the entry point, and input as a file for readers that want one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace mneme::fuzz {

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A directory of this process, in memory where there is such a place; it goes with the process.
class Scratch {
 public:
  Scratch() {
    if (::mkdtemp(path_.data()) != nullptr) return;
    path_ = "/tmp/mneme-fuzz-XXXXXX";
    if (::mkdtemp(path_.data()) == nullptr) std::abort();
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_ = "/dev/shm/mneme-fuzz-XXXXXX";
};

/// The input as a file; the same file for every input.
inline std::string as_file(const std::uint8_t* data, std::size_t size, const std::string& name) {
  static const Scratch directory;
  const std::string path = directory / name;
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return path;
}

/// An error must say something.
template <class Result>
void expect_message(const Result& result) {
  if (!result && result.error().message.empty()) std::abort();
}

}  // namespace mneme::fuzz
