// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Values and errors that a test needs: without one, it fails there and says why.
#pragma once

#include "mneme/base.h"

#include <doctest/doctest.h>

#include <optional>
#include <type_traits>
#include <utility>

namespace mneme::test {

/// Returns the value of a result; without one, ends the test with the error's message. `file` and
/// `line`: the caller's.
template <class T, class Fault>
T require(tl::expected<T, Fault> result, const char* file = __builtin_FILE(),
          int line = __builtin_LINE()) {
  if (!result) ADD_FAIL_AT(file, line, result.error().message);
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}
/// Returns the error of a result; a value ends the test.
template <class T, class Fault>
Fault require_error(const tl::expected<T, Fault>& result, const char* file = __builtin_FILE(),
                    int line = __builtin_LINE()) {
  if (result) ADD_FAIL_AT(file, line, "expected an error, got a value");
  return result.error();
}
/// Returns the value; without one, ends the test.
template <class T>
T require(std::optional<T> value, const char* file = __builtin_FILE(),
          int line = __builtin_LINE()) {
  if (!value) ADD_FAIL_AT(file, line, "there is no value");
  return *std::move(value);
}

}  // namespace mneme::test
