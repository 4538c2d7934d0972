// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Errors, configurations, random numbers, instruction sets and data directories: what every other
/// header needs.
#pragma once

#include <tl/expected.hpp>

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace mneme {

/// The type of a setting's value: `T` for a field of the type T or std::optional<T>.
template <class T>
struct SettingTraits {
  using Value = T;
  static constexpr bool kIsOptional = false;
};
template <class T>
struct SettingTraits<std::optional<T>> {
  using Value = T;
  static constexpr bool kIsOptional = true;
};
template <class T>
using SettingValue = typename SettingTraits<std::remove_const_t<T>>::Value;

/// One value per joint of the planning group, in group order: radians, or metres for a prismatic
/// joint.
using Configuration = std::vector<double>;

/// The kind of an error. The programs map each kind to an exit code.
enum class ErrorCode {
  io,           ///< A file cannot be read, written or created.
  parse,        ///< Text is malformed, or a value in it has the wrong type or range.
  unsupported,  ///< Well-formed input that this version of mneme does not handle.
  invalid,      ///< An argument is out of range, or two inputs do not fit together.
  wrong_robot,  ///< A database holds the experience of another robot.
  corrupt,      ///< A database or one of its rows is damaged.
};

/// Returns the name of the enumerator, as the service and Python report it.
[[nodiscard]] std::string_view to_string(ErrorCode code);

/// An error: `message` names the file, line or object and says what was expected.
struct Error {
  Error() = default;
  /// Escapes bytes of `text` that are not UTF-8, such as those of a damaged file: "\\xff".
  Error(ErrorCode kind, std::string text);

  ErrorCode code = ErrorCode::invalid;
  std::string message;
};

/// A value or an error. The only exceptions that the library lets out are std::bad_alloc, also when
/// memory runs out in one of the library's threads, and Interrupted within an InterruptScope.
template <class T>
using Result = tl::expected<T, Error>;

/// Returns an error that converts to any `Result`.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

namespace internal {
template <class T>
T take_value(Result<T>&& result) {
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}
}  // namespace internal

/// Evaluates to the value of a Result, or returns its error from the enclosing function:
/// `const Scene scene = MNEME_TRY(load_scene(path));`. Use it as a whole initializer, statement or
/// condition, not beside other values in an expression.
#define MNEME_TRY(...)                                                       \
  __extension__({                                                            \
    auto try_result = (__VA_ARGS__);                                         \
    if (!try_result) return ::tl::unexpected(std::move(try_result).error()); \
    ::mneme::internal::take_value(std::move(try_result));                    \
  })

/// Returns "; did you mean 'x'?" if one of `names` is close to `word`, otherwise "". Case and
/// underscores do not count.
[[nodiscard]] std::string did_you_mean(std::string_view word, std::span<const std::string> names);

/// Thrown by long work within an InterruptScope whose `is_over` returns true.
struct Interrupted {};

/// Stops long work that has no cancel flag, such as reading files, attaching objects and preparing
/// obstacles. While this object lives, such work of the thread that made it throws Interrupted
/// within about 50 ms after `is_over` returns true. Threads of the library call `is_over`, too.
/// Scopes may be nested.
class InterruptScope {
 public:
  explicit InterruptScope(std::function<bool()> is_over);
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;
  ~InterruptScope();

  [[nodiscard]] bool is_over() const {
    return is_over_() || (outer_ != nullptr && outer_->is_over());
  }

 private:
  std::function<bool()> is_over_;
  const InterruptScope* outer_;
};

/// Measures wall-clock time since its construction.
class Stopwatch {
 public:
  [[nodiscard]] double elapsed_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Pseudo-random stream: xoshiro256++ (Blackman and Vigna, DOI 10.1145/3460772), seeded by
/// splitmix64. The sequence depends only on the seed. Not thread-safe: use one stream per thread.
class Rng {
 public:
  explicit Rng(std::uint64_t seed);

  /// 64 uniform random bits.
  std::uint64_t next() {
    const std::uint64_t result = rotate_left(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = rotate_left(state_[3], 45);
    return result;
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// Uniform in [lower, upper).
  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }
  /// Uniform integer in [0, count); `count` > 0.
  std::uint32_t index(std::uint32_t count) {
    return static_cast<std::uint32_t>(((next() >> 32) * count) >> 32);
  }
  /// Standard normal, by the ziggurat method (Marsaglia and Tsang, DOI 10.18637/jss.v005.i08).
  double normal();
  /// Approximately normal with mean 0 and deviation 1: a sum of eight uniform bytes (Irwin and
  /// Hall), within +-4.9. 8x faster than normal().
  float bell();

 private:
  static std::uint64_t rotate_left(std::uint64_t x, int bits) {
    return (x << bits) | (x >> (64 - bits));
  }
  std::array<std::uint64_t, 4> state_;
};

/// Returns the seed of sub-task `task` of a job with the seed `seed`, so that results do not depend
/// on threads and order.
[[nodiscard]] std::uint64_t derive_seed(std::uint64_t seed, std::uint64_t task);

/// The instruction sets that the kernels are compiled for: x86-64 has sse, avx2 and avx512, ARM has
/// neon, WebAssembly has wasm. A build for WebAssembly has no scalar kernels.
enum class Isa { automatic, scalar, sse, avx2, avx512, neon, wasm };

/// Returns the instruction set that MNEME_ISA names if this machine has it, otherwise the best one
/// of this machine.
[[nodiscard]] Isa default_isa();
/// Returns `isa`, or default_isa() for `automatic`.
[[nodiscard]] Isa resolve_isa(Isa isa);
/// Returns the instruction sets that this machine can run, from the slowest to the fastest.
[[nodiscard]] std::vector<Isa> available_isas();
/// Returns true if this machine can run `isa`.
[[nodiscard]] bool is_available(Isa isa);
[[nodiscard]] std::string_view to_string(Isa isa);
/// The inverse of to_string; "portable" is sse, neon or wasm. Errors: invalid for an unknown name;
/// unsupported if this machine lacks the instruction set.
[[nodiscard]] Result<Isa> parse_isa(std::string_view name);

/// Returns the existing directories with robots/ and scenes/ in search order: share/mneme beside
/// this library, share/mneme beside the running program, the source tree, share/mneme of the
/// configured prefix, then mneme in each directory of XDG_DATA_DIRS.
[[nodiscard]] std::vector<std::string> data_directories();

/// Returns the path of a bundled scene or problem, such as "planar/threaded_b2.yaml". Error: io.
[[nodiscard]] Result<std::string> find_scene(const std::string& name);

/// Returns the version of mneme, such as "0.2.0".
[[nodiscard]] std::string_view version();

}  // namespace mneme
