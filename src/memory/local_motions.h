// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Local motions, the rows of the kind "motions": what the tight stretches of a path teach, and
/// where a remembered one fits into another scene.
#pragma once

#include "mneme/collision.h"
#include "mneme/memory.h"

#include "store/store.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

namespace mneme::internal {

/// Clearance below which a state is tight, metres.
inline constexpr float kTightClearance = 0.01f;
[[nodiscard]] inline bool is_tight(float clearance) { return clearance < kTightClearance; }

/// Returns the tight stretches of `path`, which is free, after widening it, each with a little of
/// the path before and after. `empty`: checker of the same robot in a scene without obstacles.
[[nodiscard]] std::vector<RememberedPath> cut_tight_stretches(const CollisionChecker& checker,
                                                              const CollisionChecker& empty,
                                                              const Path& path);

/// Places of motions in one scene, by the content of their rows; none for a motion that fits
/// nowhere.
using MotionPlaces = std::map<ContentHash, std::vector<float>>;

/// The places that are known in one scene. Thread-safe.
class KnownPlaces {
 public:
  [[nodiscard]] MotionPlaces copy() const;
  [[nodiscard]] bool empty() const;
  /// Drops all places first if there would be more than kMost motions.
  void add(const MotionPlaces& found);

 private:
  static constexpr std::size_t kMost = 10'000;
  mutable std::mutex mutex_;
  MotionPlaces places_;
};

/// Finds places of remembered motions in one scene by checking alone. A motion fits where it is
/// free, near obstacles for much of its length, and most of its near misses are blocked. The kind
/// of obstacle does not matter. Places are displacements of the joint that turns the rest of the
/// robot, or else lifts it; a robot without such a joint has the place 0 alone. Not thread-safe.
class MotionFinder {
 public:
  /// The checker must outlive the finder.
  explicit MotionFinder(const CollisionChecker& checker);

  /// Returns the places where `motion` fits, ascending. Adds to states and work of
  /// `counters`. Cost: 20 to 50 vectors of states.
  [[nodiscard]] std::vector<float> find(const RememberedPath& motion, CheckCounters& counters);
  /// Returns the waypoints of `motion` at `place`, row by row, brought into the joint limits: the
  /// motion may have been learned within wider ones.
  [[nodiscard]] std::vector<float> placed(const RememberedPath& motion, float place) const;

 private:
  void read(const RememberedPath& motion);
  [[nodiscard]] std::vector<float> coarse_places(const RememberedPath& motion) const;
  [[nodiscard]] std::vector<float> fine_places(std::span<const float> coarse) const;
  void keep(std::vector<float>& places, std::size_t state, double extra_margin, bool is_free);
  [[nodiscard]] double free_share(std::span<const float> rows, float place, double extra_margin);
  [[nodiscard]] bool fits(const RememberedPath& motion, float place);
  [[nodiscard]] float refined(const RememberedPath& motion, float place);
  [[nodiscard]] std::span<const float> core(std::size_t first, std::size_t count) const;
  [[nodiscard]] std::size_t core_size() const { return core_.size() / joints_; }

  const CollisionChecker& checker_;
  std::size_t joints_;
  int carrier_ = -1;         ///< index of the joint, or -1
  float step_ = 0;           ///< step of the coarse search
  std::vector<float> core_;  ///< states from the first tight one to the last; those that decide
                             ///< most come first
  std::vector<float> rows_;
  std::vector<std::uint8_t> is_free_;
  CheckCounters counters_;
};

}  // namespace mneme::internal
