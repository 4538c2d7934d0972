// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// fail() with the format of a message, and how readers of files leave at the first fault: they
/// throw inside, and return a Result.
#pragma once

#include "mneme/base.h"

#include <fmt/format.h>

#include <type_traits>
#include <utility>

namespace mneme {

/// `fail(ErrorCode::io, "{}: cannot be read", path)`: the failed side of any `Result`.
template <class First, class... Rest>
[[nodiscard]] tl::unexpected<Error> fail(ErrorCode code, fmt::format_string<First, Rest...> what,
                                         First&& first, Rest&&... rest) {
  return fail(code, fmt::format(what, std::forward<First>(first), std::forward<Rest>(rest)...));
}

}  // namespace mneme

namespace mneme::internal {

/// Thrown by everything that reads input, and turned into an Error by without_throwing().
struct InputFailure {
  Error error;
};

template <class... Args>
[[noreturn]] void throw_failure(ErrorCode code, fmt::format_string<Args...> what, Args&&... args) {
  throw InputFailure{{code, fmt::format(what, std::forward<Args>(args)...)}};
}

/// The result of `read`, or the error that it threw.
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

/// The value, or InputFailure with the error.
template <class T>
T value_or_throw(Result<T> result) {
  if (!result) throw InputFailure{std::move(result.error())};
  return *std::move(result);
}

}  // namespace mneme::internal
