// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Dense states of a motion, and its contacts there.
#pragma once

#include "mneme/collision.h"

#include "collision/random_worlds.h"

#include <doctest/doctest.h>

namespace mneme::test {

/// Metres by which what passes may overlap between two states.
inline constexpr double kSweepTolerance = 2e-5;

inline bool is_swept_free(const CollisionChecker& checker, const Configuration& from,
                          const Configuration& to, const SweepDetail& detail = {}) {
  const std::vector<float> a(from.begin(), from.end()), b(to.begin(), to.end());
  CheckCounters counters;
  return checker.is_sweep_valid(a, b, counters, detail);
}

inline bool is_swept_free(const Robot& robot, const Scene& scene, const Configuration& from,
                          const Configuration& to, const SweepDetail& detail = {}) {
  return is_swept_free(require_checker(robot, scene), from, to, detail);
}

/// Metres by which anything overlaps, or comes closer than the checker's margin, at the worst of
/// `states` states of a motion, exactly.
inline double deepest_contact(const CollisionChecker& checker, const Configuration& from,
                              const Configuration& to, int states) {
  const Configuration delta = checker.robot().difference(from, to);
  double deepest = 0;
  for (int i = 0; i <= states; ++i) {
    Configuration q = from;
    for (std::size_t j = 0; j < q.size(); ++j) q[j] += delta[j] * i / states;
    for (const Contact& contact : checker.contacts(q)) {
      const double margin = contact.is_self ? 0 : checker.margin();
      deepest = std::max(deepest, margin - contact.distance);
    }
  }
  return deepest;
}

/// Outcomes of sweeps that were compared with dense states.
struct SweepTally {
  int free = 0, blocked = 0;
  int refused = 0;  ///< of those blocked, without any contact found

  void compare(const CollisionChecker& checker, const Configuration& from, const Configuration& to,
               int states) {
    judge(checker, from, to, deepest_contact(checker, from, to, states));
  }

  void judge(const CollisionChecker& checker, const Configuration& from, const Configuration& to,
             double deepest) {
    const bool is_free = is_swept_free(checker, from, to);
    ++(is_free ? free : blocked);
    if (is_free) CHECK(deepest <= kSweepTolerance);
    refused += deepest == 0 && !is_free ? 1 : 0;
  }
};

}  // namespace mneme::test
