// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reads YAML text as a file "f" with any of the scene room's readers.
#pragma once

#include "input/input.h"

#include <string>

namespace mneme::test {

/// The value that `read` makes of `yaml`, or the error that it threw.
template <class Read>
auto read_yaml(const std::string& yaml, Read&& read) {
  static const std::string source = "f";
  return internal::without_throwing([&] {
    const internal::InputValue value = internal::parse_yaml(yaml, source);
    return read(internal::Input(value, source));
  });
}

/// The message of the error, or nothing.
template <class Read>
std::string failure_of(const std::string& yaml, Read&& read) {
  const auto result = read_yaml(yaml, read);
  return result ? "" : result.error().message;
}

}  // namespace mneme::test
