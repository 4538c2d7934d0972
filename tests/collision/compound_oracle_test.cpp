// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels in front of points, meshes and octrees against a look at every part.
#include "collision/random_worlds.h"
#include "collision/sweeps.h"
#include "geometry/random_compounds.h"

#include <array>
#include <functional>
#include <memory>

namespace mneme::test {
namespace {

/// Rounding of a distance in single precision.
constexpr double kTolerance = 1e-4;

constexpr std::array kMakers = {random_cloud, random_mesh, random_octree};

/// Clearances of a robot's shapes to the parts of a scene. The ball around parts that is too
/// far away to matter stands for all of them.
class GapByParts {
 public:
  GapByParts(const Robot& robot, const Scene& scene)
      : robot_(robot), is_moving_(internal::find_moving_links(robot)) {
    for (const Obstacle& obstacle : scene.obstacles) {
      for (const Shape& shape : obstacle.shapes) {
        std::visit([&](const auto& compound) { add(compound); }, shape);
      }
    }
  }

  /// The least clearance of a shape that a joint moves to a part: exact below `enough`, otherwise
  /// no less.
  [[nodiscard]] double at(std::span<const double> q, double enough) const {
    const std::vector<Transform> poses = robot_.link_poses(q);
    double least = enough;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (!is_moving_[i]) continue;
      for (const Capsule& own : capsules_of(robot_.links()[i], poses[i])) {
        for (const auto& include : compounds_) include(own, least);
      }
    }
    return least;
  }

 private:
  template <class Solid>
  void add(const Solid&) {}
  template <class Part>
  void add(const CompoundShape<Part>& compound) {
    const auto ball =
        std::make_shared<const BallOfParts<Part>>(ball_of_parts(compound.parts->list()));
    const Transform to_parts = compound.pose.inverse();
    compounds_.push_back([=, radius = compound.radius](const Capsule& own, double& least) {
      include(Capsule{to_parts * own.a, to_parts * own.b, own.radius}, *ball, radius, least);
    });
  }

  /// Independent of the distances that are tested.
  static double distance_from_axis(const Capsule& c, const Vec3& p) {
    const Vec3 along = c.b - c.a;
    const double length2 = along.squaredNorm();
    const double t = length2 > 0 ? std::clamp(along.dot(p - c.a) / length2, 0.0, 1.0) : 0.0;
    return (c.a + t * along - p).norm();
  }

  template <class Part>
  static void include(const Capsule& own, const BallOfParts<Part>& ball, double radius,
                      double& least) {
    const double around = own.radius + radius + ball.radius;
    if (distance_from_axis(own, ball.center) - around > least) return;
    for (const BallOfParts<Part>& half : ball.halves) include(own, half, radius, least);
    for (const Part& part : ball.parts) {
      const double distance = internal::distance_between(own.a, own.b, part);
      least = std::min(least, std::max(0.0, distance - radius) - own.radius);
    }
  }

  const Robot& robot_;
  std::vector<bool> is_moving_;
  std::vector<std::function<void(const Capsule&, double&)>> compounds_;
};

/// Moves the parts in their frame, and the frame back.
struct SetAside {
  Vec3 away;

  [[nodiscard]] CloudPoint moved(CloudPoint p) const {
    for (int axis = 0; axis < 3; ++axis) {
      p[static_cast<std::size_t>(axis)] += static_cast<float>(away[axis]);
    }
    return p;
  }
  [[nodiscard]] Triangle moved(const Triangle& t) const {
    return {t.a + away, t.b + away, t.c + away};
  }
  [[nodiscard]] Cube moved(const Cube& c) const { return {c.center + away, c.half_extent}; }

  template <class Part>
  Shape operator()(CompoundShape<Part> compound) const {
    std::vector<Part> parts;
    for (const Part& part : compound.parts->list()) parts.push_back(moved(part));
    compound = compound_of(std::move(parts), compound.radius);
    compound.pose.translation = -away;
    return compound;
  }
  template <class Solid>
  Shape operator()(const Solid& solid) const {
    return solid;
  }
};

struct Counts {
  int free = 0, touching = 0;
};

/// Compares all instruction sets with the look at every part, leaving contacts of links with links
/// aside. Counts states.
void compare_with_parts(const Robot& robot, const Scene& scene, double margin, int states, Rng& rng,
                        Counts& counts) {
  const std::vector<float> rows = random_states(robot, states, rng);
  const auto alone = check_all(require_checker(robot, {}), rows);
  std::vector<double> clearances(alone.size());
  const GapByParts gap_by_parts(robot, scene);
  for (std::size_t i = 0; i < alone.size(); ++i) {
    if (alone[i] == 0) continue;
    const auto q = row(rows, i, robot);
    clearances[i] =
        gap_by_parts.at(Configuration(q.begin(), q.end()), margin + 2 * kTolerance) - margin;
    ++(clearances[i] < 0 ? counts.touching : counts.free);
  }
  for (const Isa isa : available_isas()) {
    const auto is_valid =
        check_all(require_checker(robot, scene, {.margin = margin, .isa = isa}), rows);
    for (std::size_t i = 0; i < is_valid.size(); ++i) {
      if (alone[i] == 0 || std::abs(clearances[i]) <= kTolerance) continue;
      if ((is_valid[i] != 0) == (clearances[i] > 0)) continue;
      FAIL(to_string(isa) << ", state " << i << ": clearance " << clearances[i]);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("no state is called free that touches a part, and none touching that does not") {
    Rng rng(301);
    for (const auto make : kMakers) {
      Counts counts;
      const int robots = rounds(6), states = std::min(25 * robots, 5000);
      for (int i = 0; i < robots; ++i) {
        const Robot robot = random_robot(rng);
        const Scene scene = random_scene(robot, 4, rng, make);
        INFO("seed 301, robot " << i);
        compare_with_parts(robot, scene, i % 2 == 0 ? 0.0 : 0.02, states, rng, counts);
      }
      MESSAGE(counts.free << " free states and " << counts.touching << " that touch");
      CHECK(counts.free > 50);
      CHECK(counts.touching > 50);
    }
  }

  TEST_CASE("exact contacts with compound shapes are those of a look at every part") {
    Rng rng(302);
    int touching = 0;
    for (int i = 0; i < 9; ++i) {
      const Robot robot = random_robot(rng);
      const Scene scene = random_scene(robot, 2, rng, kMakers[static_cast<std::size_t>(i % 3)]);
      const CollisionChecker checker = require_checker(robot, scene);
      const GapByParts gap_by_parts(robot, scene);
      for (int k = 0; k < 30; ++k) {
        const Configuration q = random_configuration(robot, rng);
        const auto contacts = checker.contacts(q);
        const bool touches =
            std::ranges::any_of(contacts, [](const Contact& c) { return !c.is_self; });
        INFO("seed 302, robot " << i);
        CHECK(touches == (gap_by_parts.at(q, 1) < 0));
        touching += touches ? 1 : 0;
      }
    }
    CHECK(touching > 5);
  }

  TEST_CASE("parts that lie far from their own origin are checked as if they did not") {
    Rng rng(304);
    for (const auto make : kMakers) {
      const bool is_cloud = make == random_cloud;
      const Vec3 away = is_cloud ? Vec3(3000, -4000, 500) : Vec3(5e5, -4.6e6, 100);
      const auto make_far = [&](Rng& r) { return std::visit(SetAside{away}, make(r)); };
      Counts counts;
      for (int i = 0; i < 4; ++i) {
        const Robot robot = random_robot(rng);
        const Scene scene = random_scene(robot, 4, rng, make_far);
        INFO("seed 304, robot " << i);
        compare_with_parts(robot, scene, 0, 150, rng, counts);
      }
      CHECK(counts.free > 50);
      CHECK(counts.touching > 50);
    }
  }

  TEST_CASE(
      "what is swept in front of a compound shape is free only if it touches nothing on the way") {
    Rng rng(303);
    for (const auto make : kMakers) {
      SweepTally tally;
      for (int i = 0; i < 12; ++i) {
        const Robot robot = random_robot(rng);
        const Scene scene = random_scene(robot, 2, rng, make);
        const double margin = i % 2 == 0 ? 0.0 : 0.02;
        const auto rows = random_states(robot, 12, rng, 0.3);
        INFO("seed 303, robot " << i << ", margin " << margin);
        for (std::size_t k = 1; k < 12; ++k) {
          const auto a = row(rows, k - 1, robot), b = row(rows, k, robot);
          const Configuration from(a.begin(), a.end()), to(b.begin(), b.end());
          const double deepest =
              deepest_contact(require_checker(robot, scene, {.margin = margin}), from, to, 50);
          for (const Isa isa : available_isas()) {
            tally.judge(require_checker(robot, scene, {.margin = margin, .isa = isa}), from, to,
                        deepest);
          }
        }
      }
      CHECK(tally.free > 10);
      CHECK(tally.blocked > 10);
      CHECK(tally.refused < tally.blocked);
    }
  }
}

}  // namespace
}  // namespace mneme::test
