// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// fail() with a format string, and InputFailure: readers throw this exception inside at the first
/// fault, and return it as the error of a Result.
#pragma once

#include "mneme/base.h"

#include <fmt/format.h>

#include <string>
#include <type_traits>
#include <utility>

namespace mneme {

/// Returns an error that converts to any `Result`: `fail(ErrorCode::io, "{}: cannot be read",
/// path)`.
template <class First, class... Rest>
[[nodiscard]] tl::unexpected<Error> fail(ErrorCode code, fmt::format_string<First, Rest...> what,
                                         First&& first, Rest&&... rest) {
  return fail(code, fmt::format(what, std::forward<First>(first), std::forward<Rest>(rest)...));
}

}  // namespace mneme

namespace mneme::internal {

/// Returns a function for Result::map_error() that puts `where` before the message.
[[nodiscard]] inline auto naming(std::string where) {
  return [where = std::move(where)](const Error& error) {
    return Error{error.code, fmt::format("{}: {}", where, error.message)};
  };
}

/// Thrown by readers of input; without_throwing() turns it into an Error.
struct InputFailure {
  Error error;
};

template <class... Args>
[[noreturn]] void throw_failure(ErrorCode code, fmt::format_string<Args...> what, Args&&... args) {
  throw InputFailure{{code, fmt::format(what, std::forward<Args>(args)...)}};
}

/// Returns the result of `read`, or the error of the InputFailure that it threw.
template <class Read>
auto without_throwing(Read&& read) -> Result<decltype(read())> {
  try {
    if constexpr (std::is_void_v<decltype(read())>) {
      read();
      return {};
    } else {
      return read();
    }
  } catch (const InputFailure& failure) {
    return tl::unexpected<Error>(failure.error);
  }
}

/// Returns the value, or throws InputFailure with the error.
template <class T>
T value_or_throw(Result<T> result) {
  if (!result) throw InputFailure{std::move(result.error())};
  return *std::move(result);
}

}  // namespace mneme::internal
