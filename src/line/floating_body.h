// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contact of a rigid body, such as a hand, at many poses: 16 poses cost about as much as one.
#pragma once

#include "mneme/collision.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

struct BodySettings {
  Isa isa = Isa::automatic;
  /// Also free: poses at which spheres touch that approximate a surface, and the surface does not.
  bool is_exact = false;
};

/// Metres by which spheres of an object may overlap what it stands on.
inline constexpr double kObjectDepth = 0.02;

/// A robot whose six joints carry links to any pose.
struct FloatingRobot {
  Robot robot;
  std::optional<Robot> core = {};  ///< as FloatingBody::core_
  bool has_surfaces = false;
};

/// Links that stay together, without the arm that carries them. Poses are those that the robot may
/// reach: farther ones may count as free.
class FloatingBody {
 public:
  /// The links rigid with `link`, whose contacts the scene may allow. Nothing if they have no
  /// shapes or cannot be checked.
  [[nodiscard]] static std::optional<FloatingBody> of_link(const Robot& robot, const Scene& scene,
                                                           const std::string& link,
                                                           const BodySettings& settings);
  /// The object that the robot holds at `X_LO` in the frame of its link. It may be as deep as
  /// kObjectDepth in an obstacle.
  [[nodiscard]] static std::optional<FloatingBody> of_object(const Robot& robot, const Scene& scene,
                                                             const std::string& object,
                                                             const Transform& X_LO,
                                                             const BodySettings& settings);
  /// The same for an obstacle of the scene at `X_WO`, which it does not collide with itself.
  [[nodiscard]] static std::optional<FloatingBody> of_obstacle(const Robot& robot,
                                                               const Scene& scene,
                                                               const std::string& name,
                                                               const Transform& X_WO,
                                                               const BodySettings& settings);

  /// Returns 1 per pose of the link or the object at which it is free.
  [[nodiscard]] std::vector<std::uint8_t> find_free(const std::vector<Transform>& poses) const;
  /// True if spheres approximate surfaces, so that exact geometry may find more poses free.
  [[nodiscard]] bool has_surfaces() const { return has_surfaces_; }
  /// Returns what the body touches at the pose: "'panda_hand' with 'shelf'"; empty if nothing.
  [[nodiscard]] std::string describe_contact(const Transform& pose) const;

 private:
  FloatingBody(CollisionChecker checker, bool has_surfaces)
      : checker_(std::move(checker)), has_surfaces_(has_surfaces) {}
  [[nodiscard]] static std::optional<FloatingBody> make(std::optional<FloatingRobot> floating,
                                                        const Scene& scene,
                                                        const BodySettings& settings);

  CollisionChecker checker_;
  /// With spheres that do not stick out of surfaces: where these touch, exact geometry does, too.
  /// Nothing unless BodySettings::is_exact.
  std::optional<CollisionChecker> core_;
  bool has_surfaces_;
};

/// Makes the trees and grids of compound shapes that a robot and bodies of its links share, out to
/// `reach` metres, and the trees for exact distances if `may_touch`. Takes seconds for a million
/// triangles. Throws Interrupted.
void prepare_shapes(const Robot& robot, const Scene& scene, double reach, bool may_touch);

/// Returns the deepest contact: "'panda_hand' with 'shelf'"; empty if there is none.
[[nodiscard]] std::string describe_deepest(std::span<const Contact> contacts);

}  // namespace mneme::internal
