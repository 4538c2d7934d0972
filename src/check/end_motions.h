// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Motions that leave contact at the ends of a path.
#pragma once

#include "mneme/check.h"

#include "check/link_distances.h"

#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace mneme::internal {

/// A joint of the group beyond its limits.
struct LimitExcess {
  int joint = 0;      ///< index into the group
  double excess = 0;  ///< radians or metres
};
/// Returns the joints beyond their limits by more than rounding. `q` is finite and has
/// joint_count() values.
[[nodiscard]] std::vector<LimitExcess> find_excess(const Robot& robot, std::span<const double> q);
/// True if a start may be at `q`: finite, of joint_count() values, and near enough to the limits.
[[nodiscard]] bool is_near_limits(const Robot& robot, std::span<const double> q,
                                  const EndTolerances& tolerances);

/// A link in contact with an obstacle or with another link.
struct Touch {
  int link = 0;          ///< index into the robot's links
  int other = 0;         ///< index of an obstacle of the scene, or of a link
  bool is_self = false;  ///< True if `other` is a link.
  double distance = 0;   ///< metres beyond the margin; negative in contact

  [[nodiscard]] auto pair() const { return std::tuple(is_self, link, other); }
};
/// Returns the contact of this pair among `touches`, as EndMotions::touching() returns them;
/// nullptr if there is none.
[[nodiscard]] const Touch* find_same_pair(std::span<const Touch> touches, const Touch& touch);

/// Decides which contacts at the ends of a path its first and last motion may leave. Double
/// precision. Const and parallel-safe.
class EndMotions {
 public:
  /// `scene` must outlive this. Obstacles are inflated by `margin` metres.
  EndMotions(const Robot& robot, const Scene& scene, double margin,
             const EndTolerances& tolerances);

  /// Returns all pairs closer than `extra` metres, beyond the margin, at `q`, in the order of
  /// Touch::pair(). Throws Interrupted.
  [[nodiscard]] std::vector<Touch> touching(std::span<const double> q, double extra = 0) const;
  /// Checks these pairs, as touching() returns them, by exact geometry from now on, where a link
  /// is approximated by spheres.
  void check_exactly(std::span<const Touch> touches);
  /// True if a path may begin (`is_start`) or end in this contact.
  [[nodiscard]] bool may_leave(const Touch& touch, bool is_start) const;
  /// True if the straight motion from `end`, the start or goal of a path, to `inside` only leaves
  /// contact that may be left. The pairs in contact come no closer. Attached objects and the pairs
  /// of Scene::end_contacts touch only within their stretch of motion. All other pairs keep `extra`
  /// metres, and at `inside` nothing touches. Checks at least `steps` states.
  [[nodiscard]] bool is_left_by(const Configuration& end, const Configuration& inside,
                                bool is_start, int steps, double extra) const;
  /// Largest stretch of any pair, metres.
  [[nodiscard]] double longest_stretch() const;
  /// The unit vector along which the link of the contact leaves the contact at `q`; 0 if there is
  /// no such direction.
  [[nodiscard]] Vec3 direction_out(std::span<const double> q, const Touch& touch) const;

 private:
  /// A pair of Scene::end_contacts.
  struct NamedPair {
    int link = 0, other = 0;  ///< as in Touch
    bool is_self = false;
    double stretch = 0;
  };
  void add_named(const EndContact& contact, const Scene& scene);
  [[nodiscard]] bool is_held(const Touch& touch) const;
  /// Largest motion in contact, metres: that of a named pair or of attached objects. Nothing for
  /// other pairs, which have no limit.
  [[nodiscard]] std::optional<double> stretch_of(const Touch& touch) const;
  /// Largest depth of the contact at the start, metres. The measured depth of a thin link never
  /// exceeds its radius, so the limit is at most half of that radius.
  [[nodiscard]] double deepest(const Touch& touch) const;
  [[nodiscard]] double distance(const PosedLinks& posed, const Touch& touch) const;
  /// Upper bound, metres, of the distance that shapes of the pair's links moved between two poses.
  [[nodiscard]] double travel(const PosedLinks& from, const PosedLinks& to,
                              const Touch& touch) const;

  Robot robot_;
  double margin_;
  EndTolerances tolerances_;
  LinkDistances links_;
  std::vector<ObstacleShape> shapes_;
  std::vector<LinkPair> pairs_;
  std::vector<NamedPair> named_;
};

}  // namespace mneme::internal
