// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Contact of a rigid body, such as a hand, at many poses: 16 poses cost about as much as one.
#pragma once

#include "mneme/collision.h"

#include "task/world.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// Links that stay together, without the arm that carries them.
class FloatingBody {
 public:
  /// The links rigid with `link`, whose contacts the scene may allow. Nothing if they have no
  /// shapes or cannot be checked.
  [[nodiscard]] static std::optional<FloatingBody> of_link(const World& world,
                                                           const std::string& link, Isa isa);
  /// The object that the world's robot holds.
  [[nodiscard]] static std::optional<FloatingBody> of_object(const World& world,
                                                             const std::string& object, Isa isa);

  /// An obstacle of the scene, which it does not collide with itself.
  [[nodiscard]] static std::optional<FloatingBody> of_obstacle(const World& world,
                                                               const std::string& name, Isa isa);

  /// Returns 1 per pose of the link or the object at which nothing is deeper than `depth` in an
  /// obstacle.
  [[nodiscard]] std::vector<std::uint8_t> find_free(const std::vector<Transform>& poses,
                                                    double depth) const;
  /// Returns what the body touches at the pose: "'panda_hand' with 'shelf'"; empty if nothing.
  [[nodiscard]] std::string describe_contact(const Transform& pose) const;

 private:
  explicit FloatingBody(CollisionChecker checker) : checker_(std::move(checker)) {}
  [[nodiscard]] static std::optional<FloatingBody> make(std::vector<Link> links, Scene scene,
                                                        Isa isa);

  CollisionChecker checker_;
};

}  // namespace mneme::internal
