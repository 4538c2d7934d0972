// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "input_file.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include <fmt/format.h>

namespace mneme::app {

Result<std::string> read_file(const std::string& path, std::size_t most_bytes) {
  const auto unreadable = [&] {
    return fail(ErrorCode::io, fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  };
  std::ifstream file(path, std::ios::binary);
  if (!file) return unreadable();
  std::string text;
  std::array<char, 65536> block{};
  while (file.read(block.data(), block.size()) || file.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(file.gcount()));
    if (text.size() > most_bytes) {
      return fail(ErrorCode::unsupported,
                  fmt::format("{}: expected a file of at most {} bytes", path, most_bytes));
    }
  }
  if (file.bad()) return unreadable();
  return text;
}

}  // namespace mneme::app
