// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What an experience must look like to be stored, and to be used once read.
#pragma once

#include "mneme/store.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

/// Numbers of a key beyond this cannot be metres; far larger ones would overflow the index's
/// distances.
inline constexpr double kMaxKeyMagnitude = 1e6;

/// Bytes in the name of a kind.
inline constexpr std::size_t kMostKindBytes = 64;

/// Why there cannot be rows of `kind` with `key`, or nothing if there can.
[[nodiscard]] std::optional<std::string> describe_key_flaw(const std::string& kind,
                                                           const std::vector<double>& key);

/// True if rows of `kind` hold whole paths; those of other kinds hold samplers.
[[nodiscard]] bool holds_paths(std::string_view kind);

/// How long the keys of each kind are.
class KeySizes {
 public:
  /// Why a key of `size` numbers cannot be of `kind`, or nothing if it can. The first one decides.
  [[nodiscard]] std::optional<std::string> check(std::string_view kind, std::size_t size);
  [[nodiscard]] bool knows(std::string_view kind) const { return sizes_.contains(kind); }

 private:
  std::map<std::string, std::size_t, std::less<>> sizes_;
};

/// Why `experience` cannot be of that robot (content of another kind, sizes, values that are not
/// finite, rows that do not exist, texts that are not UTF-8), or nothing if it can; how long the
/// key should be is not checked. An empty sampler may have a joint count of 0.
[[nodiscard]] std::optional<std::string> describe_flaw(const Experience& experience,
                                                       const RobotSignature& signature);

/// True if a path that was stored under constraints of the hash `stored` serves a query under those
/// of the hash `wanted`. Rows of schema 3 have only one of 900 numbers that derive from it.
[[nodiscard]] bool is_same_constraints(std::uint64_t stored, std::uint64_t wanted);

/// A signature for messages.
[[nodiscard]] std::string describe(const RobotSignature& signature);

/// True if both say that the joints stand in the same frames; limits do not count.
[[nodiscard]] bool has_same_frames(const RobotSignature& a, const RobotSignature& b);
/// True if experience of `a` is experience of `b`: of the same kinematics, or, where an older
/// database does not say, of the very same model. Names do not count.
[[nodiscard]] bool is_same_robot(const RobotSignature& a, const RobotSignature& b);
/// Error: wrong_robot, because `url` holds experience of `found`.
[[nodiscard]] tl::unexpected<Error> refuse_robot(const std::string& url,
                                                 const RobotSignature& found,
                                                 const RobotSignature& wanted);

}  // namespace mneme::internal
