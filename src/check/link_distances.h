// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Distances between links and obstacles, and of links from each other, in double precision. Shares
/// no code with the kernels.
#pragma once

#include "mneme/check.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include "base/as_index.h"

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace mneme::internal {

/// One shape of an obstacle.
struct ObstacleShape {
  int obstacle = 0;  ///< index into the scene
  const Shape* shape = nullptr;
  Sphere bound;
  std::vector<int> may_touch = {};    ///< links that nothing checks against it
  std::vector<int> exact_links = {};  ///< links that are checked by exact geometry
};
/// All shapes of the scene, which must outlive them, in its order. Names of links that the robot
/// lacks are left aside.
[[nodiscard]] std::vector<ObstacleShape> obstacle_shapes(const Robot& robot, const Scene& scene);

/// Two links that are checked against each other.
struct LinkPair {
  int first = 0, second = 0;
  bool is_exact = false;  ///< (Scene::exact_pairs)
};
/// The checked pairs of the robot, in its order. Names of links that it lacks are left aside.
[[nodiscard]] std::vector<LinkPair> link_pairs(const Robot& robot, const Scene& scene);

/// Indices of the links that an obstacle names: that may touch it, and that are approximated and
/// checked by exact geometry. Error: a name that the robot lacks.
struct NamedLinks {
  std::vector<int> may_touch, exact_links;
};
[[nodiscard]] Result<NamedLinks> find_named_links(const Robot& robot, const Obstacle& obstacle);
/// Error: Scene::exact_pairs has a name that the robot lacks.
[[nodiscard]] Result<void> check_named_links(const Robot& robot, const Scene& scene);

/// Where links stand at one configuration.
struct PosedLinks {
  std::vector<Transform> poses;
  std::vector<Vec3> centers;  ///< of the links' bounds
};

/// The shapes of a link that are exact, and the surface that its sphere approximation holds, in the
/// link's frame.
class ExactLink {
 public:
  explicit ExactLink(const Link& link);

  /// Metres from a shape in the link's frame, by distance_to_solid(): 0
  /// if they meet.
  [[nodiscard]] double distance_to(const Shape& shape) const;
  /// The same from a link that stands at X_LO, exact if that is at most `enough`, and otherwise
  /// anything above it.
  [[nodiscard]] double distance_to(const ExactLink& other, const Transform& X_LO,
                                   double enough) const;

 private:
  std::vector<Capsule> shapes_;
  std::vector<Mesh> surfaces_;  ///< one, or none without an approximation
};

/// Bounding spheres first, exact distances then. It knows the shapes of a robot's links, not where
/// they are. Const and parallel-safe.
class LinkDistances {
 public:
  explicit LinkDistances(const Robot& robot);
  /// For a robot that carries objects, from the distances of the bare one.
  LinkDistances(const Robot& robot, const LinkDistances& bare);

  /// `poses` are those of all links.
  [[nodiscard]] PosedLinks posed(std::vector<Transform> poses) const;

  [[nodiscard]] int link_count() const { return static_cast<int>(links_.size()); }
  /// In the link's frame; a sphere is a capsule of length 0.
  [[nodiscard]] std::span<const Capsule> shapes(int link) const { return at(link).shapes; }
  /// True if a joint of the group moves the link.
  [[nodiscard]] bool is_moving(int link) const { return at(link).is_moving; }

  /// Metres from the link's origin that none of its shapes goes beyond.
  [[nodiscard]] double reach(int link) const {
    return at(link).bound.center.norm() + at(link).bound.radius;
  }

  /// Metres between the surfaces of a link and an obstacle, exact if that is at most `enough`, and
  /// otherwise anything above it. In contact negative, by at most the radius of the link's shape.
  /// Infinite for a link that may touch it. What is checked by exact geometry is in contact if the
  /// exact geometry is.
  [[nodiscard]] double between(const PosedLinks& posed, int link, const ObstacleShape& other,
                               double enough) const;
  /// The same of two links; in contact negative by at most the sum of the radii.
  [[nodiscard]] double between(const PosedLinks& posed, const LinkPair& pair, double enough) const;

  /// The same of spheres and capsules, whatever is checked by exact geometry.
  [[nodiscard]] double between_spheres(const PosedLinks& posed, int link,
                                       const ObstacleShape& other, double enough) const;
  [[nodiscard]] double between_spheres(const PosedLinks& posed, int first, int second,
                                       double enough) const;

 private:
  /// Shapes and spheres around them, in the link's frame.
  struct Body {
    std::vector<Capsule> shapes;
    std::vector<Sphere> bounds;
    Sphere bound;
    bool is_moving = false;
    ExactLink exact;
  };
  /// In the robot's frame, with the sphere around it.
  struct PosedShape {
    Capsule capsule;
    Vec3 middle;
    double reach = 0;
  };
  [[nodiscard]] const Body& at(int link) const { return links_[as_index(link)]; }
  void add_links(const Robot& robot);
  /// Shapes of the link that may be within `enough` of the ball.
  [[nodiscard]] std::vector<PosedShape> near_shapes(const PosedLinks& posed, int link,
                                                    const Sphere& ball, double enough) const;
  std::vector<Body> links_;
};

/// True if nothing touches that the group can move.
[[nodiscard]] bool is_free(const LinkDistances& links, const PosedLinks& posed,
                           std::span<const ObstacleShape> obstacles,
                           std::span<const LinkPair> pairs);

/// All pairs in contact at `q`: links that the group moves with obstacles, inflated by `margin`,
/// then links with links.
[[nodiscard]] std::vector<Contact> find_contacts(const Robot& robot, const LinkDistances& links,
                                                 const Scene& scene, std::span<const double> q,
                                                 double margin);
/// Pairs in contact of links that the group does not move with obstacles.
[[nodiscard]] std::vector<Contact> find_fixed_contacts(const Robot& robot,
                                                       const LinkDistances& links,
                                                       const Scene& scene);

struct Clearance {
  double distance = 0;  ///< metres, as LinkDistances::between
  int link = -1;        ///< index into the robot's links
  int obstacle = -1;    ///< index into the scene
};
/// The nearest pair of an obstacle and a link that the group moves, if it is closer than
/// `within` metres: otherwise that distance and no pair.
[[nodiscard]] Clearance find_clearance(const LinkDistances& links, const PosedLinks& posed,
                                       std::span<const ObstacleShape> obstacles,
                                       double within = std::numeric_limits<double>::infinity());

/// All pairs of a scene that are checked by exact geometry (Obstacle::exact_links,
/// Scene::exact_pairs), in double precision. Spheres come first, so that exact distances are found
/// only where these are close. Const and parallel-safe.
class ExactPairs {
 public:
  /// Refers to `links`, which are those of the robot. Obstacles are inflated by `margin` metres.
  ExactPairs(const Robot& robot, const LinkDistances& links, const Scene& scene, double margin);

  [[nodiscard]] bool empty() const { return pairs_.empty(); }
  /// True if at `q` no pair touches.
  [[nodiscard]] bool are_apart(std::span<const float> q) const;
  /// True if no pair comes closer than `extra` metres on the whole motion from `from` by `delta`,
  /// nor than 1e-4 m more at the states that are checked: around each of them the motion is free
  /// where the links have moved by no more than they had room.
  [[nodiscard]] bool stay_apart(std::span<const float> from, std::span<const float> delta,
                                double extra) const;

 private:
  /// A link and a shape of an obstacle, or two links.
  struct Pair {
    int link = 0;
    double margin = 0;
    std::shared_ptr<const Shape> shape = {};
    ObstacleShape obstacle = {};
    LinkPair links = {};
  };
  [[nodiscard]] double between(const PosedLinks& posed, const Pair& pair, double enough) const;
  [[nodiscard]] double room(const PosedLinks& posed, const Pair& pair, double margin,
                            double most) const;
  [[nodiscard]] PosedLinks pose(const Configuration& q) const;
  [[nodiscard]] double displacement_bound(const Pair& pair, const Configuration& from,
                                          const Configuration& to) const;
  [[nodiscard]] double displacement_bound(int link, std::span<const int> joints,
                                          const std::vector<double>& from,
                                          const std::vector<double>& to) const;

  Robot robot_;
  const LinkDistances& links_;
  std::vector<Pair> pairs_;
};

}  // namespace mneme::internal
