// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/path.h"

#include <algorithm>
#include <utility>

namespace mneme {
namespace {

constexpr int kShortcutAttempts = 100;
/// Shortening gives up after one attempt in vain per so many motions that planning checked, within
/// the bounds below: it should take no longer than the planning.
constexpr std::uint64_t kMotionsPerAttempt = 16;
constexpr std::uint64_t kLeastPatience = 12, kMostPatience = 60;
constexpr float kLeastShortcutGain = 0.01f;

}  // namespace

PathFinisher::PathFinisher(const CollisionChecker& checker, const FinishSettings& settings)
    : checker_(checker), settings_(settings) {}

/// What shortcuts at the planner's resolution leave of a path nearly always passes and has less to
/// verify: so it is looked at first, and the path as it was planned only if that fails.
int PathFinisher::operator()(Path& path, CheckCounters& counters) {
  if (settings_.simplify) {
    Path shorter = shorten(path, nullptr, counters);
    if (verify(shorter, counters) < 0) {
      path = std::move(shorter);
      return -1;
    }
  }
  if (const int invalid = verify(path, counters); invalid >= 0) {
    ++refused_count_;
    return invalid;
  }
  if (settings_.simplify) {
    // Cutting a motion moves the states that are looked at, so even verified ones are verified.
    Path verified = shorten(path, &verifier(), counters);
    if (verify(verified, counters) < 0) path = std::move(verified);
  }
  return -1;
}

const MotionVerifier& PathFinisher::verifier() {
  if (!verifier_) {
    verifier_.emplace(checker_, settings_.verification,
                      [this] { return is_over(settings_.timeout_s); });
  }
  return *verifier_;
}

std::string PathFinisher::describe_refused() const {
  if (refused_count_ == 0) return {};
  return "; verification refused " + std::to_string(refused_count_) +
         (refused_count_ == 1 ? " path" : " paths");
}

Path PathFinisher::shorten(Path path, const MotionVerifier* verifier, CheckCounters& counters) {
  const auto patience = static_cast<int>(
      std::clamp(counters.motions / kMotionsPerAttempt, kLeastPatience, kMostPatience));
  // The other half of what is left of the time is for verification.
  const double begin_s = stopwatch_.elapsed_s();
  const double end_s = 0.5 * (begin_s + settings_.timeout_s);
  shortcut(checker_, path, derive_seed(settings_.seed, 1),
           {kShortcutAttempts, patience, kLeastShortcutGain}, verifier, counters,
           [&] { return is_over(end_s); });
  simplification_time_s_ += stopwatch_.elapsed_s() - begin_s;
  return path;
}

int PathFinisher::verify(const Path& path, CheckCounters& counters) {
  if (settings_.verification == Verification::none) return -1;
  const double begin_s = stopwatch_.elapsed_s();
  const int invalid = verifier().find_invalid_motion(path, counters);
  verification_time_s_ += stopwatch_.elapsed_s() - begin_s;
  return invalid;
}

bool PathFinisher::is_over(double end_s) const {
  return (settings_.cancel != nullptr && settings_.cancel->load(std::memory_order_relaxed)) ||
         stopwatch_.elapsed_s() >= end_s;
}

}  // namespace mneme
