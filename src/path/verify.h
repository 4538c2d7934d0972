// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mneme/path.h"

#include "path/sweep.h"

#include <functional>
#include <optional>
#include <span>
#include <string>

namespace mneme::internal {

/// The check of motions of a final path. Const and parallel-safe, if `must_stop` is.
class MotionVerifier {
 public:
  /// Refers to the checker. `verification` is not `none`. `must_stop`, which may be empty, ends the
  /// check of what lies between states, which can take long where a link grazes an obstacle.
  explicit MotionVerifier(const CollisionChecker& checker,
                          Verification verification = Verification::states,
                          std::function<bool()> must_stop = {});

  /// True if the motion passes the verification. `is_at_end`: it touches the start or the goal of
  /// its path, which may lie closer to contact than kVerificationMargin: then it needs no margin.
  /// A motion that turns a continuous joint by half a turn does not pass: rounding would decide
  /// which way round whoever follows the path goes.
  [[nodiscard]] bool is_free(std::span<const float> from, std::span<const float> to, bool is_at_end,
                             CheckCounters& counters) const;

  /// The first motion of `path` that does not pass, or -1.
  [[nodiscard]] int find_invalid_motion(const Path& path, CheckCounters& counters) const;

 private:
  [[nodiscard]] bool is_free(std::span<const double> from, std::span<const double> to,
                             bool is_at_end, CheckCounters& counters) const;
  [[nodiscard]] bool has_one_way(std::span<const double> from, std::span<const double> to) const;
  [[nodiscard]] bool are_states_free(std::span<const double> from, std::span<const double> to,
                                     bool is_at_end, CheckCounters& counters) const;

  const CollisionChecker& checker_;
  std::optional<Sweep> sweep_;
  std::function<bool()> must_stop_;
};

/// How the message of a plan without path ends: how many paths were found and not verified, if any.
std::string describe_refused(int path_count);

}  // namespace mneme::internal
