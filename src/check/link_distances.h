// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Distances between links and obstacles, and between links, in double precision. The kernels share
/// none of this code.
#pragma once

#include "mneme/check.h"
#include "mneme/robot.h"
#include "mneme/scene.h"

#include "base/as_index.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// One shape of an obstacle.
struct ObstacleShape {
  int obstacle = 0;  ///< index into the scene
  const Shape* shape = nullptr;
  Sphere bound;
  std::vector<int> may_touch = {};    ///< links that may touch it
  std::vector<int> exact_links = {};  ///< links that are checked by exact geometry
};
/// Returns all shapes of the scene, in its order; the scene must outlive them. Ignores names of
/// links that the robot lacks.
[[nodiscard]] std::vector<ObstacleShape> obstacle_shapes(const Robot& robot, const Scene& scene);

/// Two links that are checked against each other.
struct LinkPair {
  int first = 0, second = 0;
  bool is_exact = false;  ///< checked by exact geometry (Scene::exact_pairs, Robot::exact_pairs)
};
/// Returns the checked pairs of the robot, in its order. Ignores names of links that the robot
/// lacks.
[[nodiscard]] std::vector<LinkPair> link_pairs(const Robot& robot, const Scene& scene);

/// Indices of the links that an obstacle names. `exact_links` have a sphere approximation.
struct NamedLinks {
  std::vector<int> may_touch, exact_links;
};
/// Ignores names of links that the robot lacks.
[[nodiscard]] NamedLinks find_named_links(const Robot& robot, const Obstacle& obstacle);
/// Error: an obstacle or Scene::exact_pairs names a link that the robot lacks.
[[nodiscard]] Result<void> check_named_links(const Robot& robot, const Scene& scene);

class FreeCells;
class FreeCellsOfPairs;

/// The poses of links at one configuration.
struct PosedLinks {
  std::vector<Transform> poses;
  std::vector<Vec3> centers;  ///< of the links' bounds
};

/// The exact geometry of a link in its frame: its own shapes, and the surface that its sphere
/// approximation encloses.
class ExactLink {
 public:
  explicit ExactLink(const Link& link);

  /// Distance, metres, from a shape in the link's frame, by distance_to_solid(); 0 if link and
  /// shape touch.
  [[nodiscard]] double distance_to(const Shape& shape) const;
  /// Distance, metres, from another link at the pose X_LO. Exact up to `enough`, otherwise any
  /// larger value.
  [[nodiscard]] double distance_to(const ExactLink& other, const Transform& X_LO,
                                   double enough) const;
  /// True unless it is proven that no piece of `shape`, in the link's frame, is inside the surface.
  /// Precondition: `shape` does not touch the surface.
  [[nodiscard]] bool may_enclose(const Shape& shape) const;
  [[nodiscard]] bool may_enclose(const ExactLink& other, const Transform& X_LO) const;

  [[nodiscard]] std::span<const Capsule> shapes() const { return shapes_; }
  [[nodiscard]] std::span<const Mesh> surfaces() const { return surfaces_; }

 private:
  std::vector<Capsule> shapes_;
  std::vector<Mesh> surfaces_;  ///< one, or none without an approximation
};

/// Distances of a robot's links: bounding spheres first, then exact distances. Poses are arguments.
/// Const and parallel-safe.
class LinkDistances {
 public:
  explicit LinkDistances(const Robot& robot);
  /// Makes the distances of a robot with attached objects from those of the bare robot.
  LinkDistances(const Robot& robot, const LinkDistances& bare);

  /// `poses`: one per link.
  [[nodiscard]] PosedLinks posed(std::vector<Transform> poses) const;

  [[nodiscard]] int link_count() const { return static_cast<int>(links_.size()); }
  /// Shapes of the link, in its frame; a sphere is a capsule of length 0.
  [[nodiscard]] std::span<const Capsule> shapes(int link) const { return at(link).shapes; }
  /// True if a joint of the group moves the link.
  [[nodiscard]] bool is_moving(int link) const { return at(link).is_moving; }

  [[nodiscard]] const ExactLink& exact(int link) const { return at(link).exact; }
  /// Proofs that two links stay apart, which copies share, and robots with other attached objects,
  /// too. `robot` is that of the constructor.
  [[nodiscard]] const std::vector<std::shared_ptr<const FreeCells>>& free_cells(const Robot& robot,
                                                                                int first,
                                                                                int second) const;
  /// Proves the cells of all pairs that the robot checks by exact geometry, or finds them in a
  /// directory; without one they are proven at their first use. Cost: 0.4 s per pair, milliseconds
  /// if found. Throws Interrupted.
  void prove_cells(const Robot& robot, const std::string& cache_directory) const;
  /// Metres between the surfaces of a link and an obstacle. Exact up to `enough`, otherwise any
  /// larger value. Negative in contact, by at most the radius of the link's shape. Infinite for a
  /// link that may touch the obstacle. Uses exact geometry for the pairs that are checked by it.
  [[nodiscard]] double between(const PosedLinks& posed, int link, const ObstacleShape& other,
                               double enough) const;
  /// Metres between two links, as above; negative in contact, by at most the sum of the radii.
  [[nodiscard]] double between(const PosedLinks& posed, const LinkPair& pair, double enough) const;

  /// Metres between a link and an obstacle by spheres and capsules, also for pairs that are checked
  /// by exact geometry.
  [[nodiscard]] double between_spheres(const PosedLinks& posed, int link,
                                       const ObstacleShape& other, double enough) const;
  [[nodiscard]] double between_spheres(const PosedLinks& posed, int first, int second,
                                       double enough) const;

 private:
  /// Shapes and their bounding spheres, in the link's frame.
  struct Body {
    std::vector<Capsule> shapes;
    std::vector<Sphere> bounds;
    Sphere bound;
    bool is_moving = false;
    ExactLink exact;
  };
  /// A shape in the robot's frame, with its bounding sphere.
  struct PosedShape {
    Capsule capsule;
    Vec3 middle;
    double reach = 0;
  };
  [[nodiscard]] const Body& at(int link) const { return links_[as_index(link)]; }
  void add_links(const Robot& robot);
  /// Returns the shapes of the link that may be within `enough` of the ball.
  [[nodiscard]] std::vector<PosedShape> near_shapes(const PosedLinks& posed, int link,
                                                    const Sphere& ball, double enough) const;
  std::vector<Body> links_;
  int bare_count_ = 0;                                    ///< links before attached objects
  std::shared_ptr<FreeCellsOfPairs> bare_cells_, cells_;  ///< between these, and of all others
};

/// Returns all pairs in contact at `q`: moving links, inflated by `margin`, with obstacles, then
/// links with links. Throws Interrupted.
[[nodiscard]] std::vector<Contact> find_contacts(const Robot& robot, const LinkDistances& links,
                                                 const Scene& scene, std::span<const double> q,
                                                 double margin);
/// Returns the contacts of obstacles with links that the group does not move.
[[nodiscard]] std::vector<Contact> find_fixed_contacts(const Robot& robot,
                                                       const LinkDistances& links,
                                                       const Scene& scene);

struct Clearance {
  double distance = 0;  ///< metres, as LinkDistances::between
  int link = -1;        ///< index into the robot's links
  int obstacle = -1;    ///< index into the scene
};
/// Finds the nearest pair of an obstacle and a link that the group moves. Returns `within` and no
/// pair if none is closer than `within` metres.
[[nodiscard]] Clearance find_clearance(const LinkDistances& links, const PosedLinks& posed,
                                       std::span<const ObstacleShape> obstacles,
                                       double within = std::numeric_limits<double>::infinity());

/// All pairs that are checked by exact geometry (Obstacle::exact_links, Scene::exact_pairs,
/// Robot::exact_pairs), in double precision. Const and parallel-safe.
class ExactPairs {
 public:
  /// Obstacles are inflated by `margin` metres.
  ExactPairs(const Robot& robot, const LinkDistances& links, const Scene& scene, double margin);

  [[nodiscard]] bool empty() const;
  /// Writes 1 for each state at which two links are known to be apart, 0 for others. Returns false
  /// if nothing is known of these links.
  using KnownStates = std::function<bool(std::pair<int, int> links, std::span<std::uint8_t> apart)>;
  /// Sets are_apart[i] to 0 if a pair touches at the i-th configuration. Skips those that are 0.
  void check_states(std::span<const float> configurations, std::span<std::uint8_t> are_apart,
                    const KnownStates& known) const;
  /// True if no pair comes closer than `extra` metres on the motion from `from` by `delta`. Motions
  /// that come closer than `extra` + 5e-5 m may fail.
  [[nodiscard]] bool stay_apart(std::span<const float> from, std::span<const float> delta,
                                double extra) const;
  /// True if no pair comes closer than `extra` metres at the motion's end and, as `known`, bounds
  /// or exact geometry tell, at about `count` > 0 states on the way. The start is assumed free.
  /// State k of `known` is at share (k + 1) / count of the motion. `known` may be empty; states
  /// that it knows keep no `extra`.
  [[nodiscard]] bool are_apart_at_states(std::span<const float> from, std::span<const float> delta,
                                         double extra, int count, const KnownStates& known) const;

 private:
  struct Pair;
  std::shared_ptr<const std::vector<Pair>> pairs_;
};

}  // namespace mneme::internal
