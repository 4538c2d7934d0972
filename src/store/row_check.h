// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Checks of rows and robot signatures, before storing and after reading.
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

/// Largest magnitude of a key's numbers, metres. Far larger ones would overflow the index's squared
/// distances.
inline constexpr double kMaxKeyMagnitude = 1e6;

/// Most bytes in the name of a kind.
inline constexpr std::size_t kMostKindBytes = 64;

/// Reason why `kind` and `key` are invalid, or nothing.
[[nodiscard]] std::optional<std::string> describe_key_flaw(const std::string& kind,
                                                           const std::vector<double>& key);

/// True if rows of `kind` hold paths; other kinds hold samplers.
[[nodiscard]] bool holds_paths(std::string_view kind);

/// Key length of each kind.
class KeySizes {
 public:
  /// Reason why a key of `size` numbers is invalid for `kind`, or nothing. The first call for a
  /// kind sets its size.
  [[nodiscard]] std::optional<std::string> check(std::string_view kind, std::size_t size);
  [[nodiscard]] bool knows(std::string_view kind) const { return sizes_.contains(kind); }

 private:
  std::map<std::string, std::size_t, std::less<>> sizes_;
};

/// Reason why `experience` is invalid for the robot of `signature`, or nothing. Checks the type of
/// content, array sizes, finite values, factor indices and UTF-8; does not check the key's length.
/// An empty sampler may have a joint count of 0.
[[nodiscard]] std::optional<std::string> describe_flaw(const Experience& experience,
                                                       const RobotSignature& signature);

/// True if a path stored with constraint hash `stored` applies to a query with hash `wanted`. Rows
/// migrated from schema 3 hold only a number from 1 to 900 that derives from the hash.
[[nodiscard]] bool is_same_constraints(std::uint64_t stored, std::uint64_t wanted);

/// The signature as text for messages.
[[nodiscard]] std::string describe(const RobotSignature& signature);

/// True if both have the same joint frames; limits are not compared.
[[nodiscard]] bool has_same_frames(const RobotSignature& a, const RobotSignature& b);
/// True if experience of `a` applies to `b`: equal kinematics or, where an older database has none,
/// equal models. Names are not compared.
[[nodiscard]] bool is_same_robot(const RobotSignature& a, const RobotSignature& b);
/// Error: wrong_robot, because `url` holds experience of `found`.
[[nodiscard]] tl::unexpected<Error> refuse_robot(const std::string& url,
                                                 const RobotSignature& found,
                                                 const RobotSignature& wanted);

}  // namespace mneme::internal
