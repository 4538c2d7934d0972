// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/random_pairs.h"

#include <cmath>

namespace mneme::test {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
/// Joints of a planar arm.
constexpr SymmetricJoints kFirst{0, -1, 0, 0};

/// The same configuration up to full turns of joint 1.
double angular_difference(const Configuration& a, const Configuration& b) {
  Configuration turned = b;
  turned[0] += 2 * kHalfTurn * std::round((a[0] - b[0]) / (2 * kHalfTurn));
  return largest_difference(a, turned);
}

Vec3 moved_point(const Symmetry& motion, const Vec3& point) {
  const Vec3 mirrored(point.x(), motion.is_mirrored ? -point.y() : point.y(), point.z());
  return rotation_about(Vec3::UnitZ(), motion.rotation) * mirrored;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a mirror image comes before the rotation") {
    const PrimitiveKey key =
        moved_key(Symmetry{kHalfTurn / 2, true}, PrimitiveKey{1, 2, 0.5, 3, 0, 0.25});
    CHECK(largest_difference(key, PrimitiveKey{2, 1, 0.5, 0, 3, 0.25}) < 1e-15);
    const Configuration q =
        moved_configuration(kFirst, Symmetry{0.5, true}, Configuration{0.25, 1.0, -2.0});
    CHECK(largest_difference(q, Configuration{0.25, -1.0, 2.0}) < 1e-15);
  }

  TEST_CASE("joint 1 is wrapped into the half-open interval from -pi to pi") {
    CHECK(moved_configuration(kFirst, Symmetry{kHalfTurn, false}, Configuration{0.0, 1.0})[0] ==
          -kHalfTurn);
    CHECK(moved_configuration(kFirst, Symmetry{2.0, false}, Configuration{2.0})[0] ==
          doctest::Approx(4 - 2 * kHalfTurn));
    CHECK(moved_configuration(kFirst, Symmetry{-3.0, false}, Configuration{-3.0})[0] ==
          doctest::Approx(2 * kHalfTurn - 6));
    const double just_below = std::nextafter(-kHalfTurn, -4.0);
    CHECK(moved_configuration(kFirst, Symmetry{0, false}, Configuration{just_below})[0] <
          kHalfTurn);
  }
}

TEST_SUITE("law") {
  TEST_CASE("moving by a composition is moving twice") {
    Rng rng(11);
    for (int i = 0; i < 1000; ++i) {
      const Symmetry first = random_symmetry(rng);
      const Symmetry second = random_symmetry(rng);
      const Symmetry both = compose(second, first);
      const PrimitiveKey key = random_pair(rng);
      REQUIRE(largest_difference(moved_key(both, key), moved_key(second, moved_key(first, key))) <
              1e-13);
      const Configuration q = {rng.uniform(-kHalfTurn, kHalfTurn),
                               rng.uniform(-kHalfTurn, kHalfTurn), 0.3};
      REQUIRE(angular_difference(
                  moved_configuration(kFirst, both, q),
                  moved_configuration(kFirst, second, moved_configuration(kFirst, first, q))) <
              1e-13);
    }
  }

  TEST_CASE("the inverse undoes a motion from either side") {
    Rng rng(12);
    for (int i = 0; i < 1000; ++i) {
      const Symmetry motion = random_symmetry(rng);
      const PrimitiveKey key = random_pair(rng);
      REQUIRE(largest_difference(moved_key(inverse(motion), moved_key(motion, key)), key) < 1e-13);
      const Symmetry neither = compose(motion, inverse(motion));
      REQUIRE(!neither.is_mirrored);
      REQUIRE(std::abs(neither.rotation) < 1e-13);
      const Configuration q = {rng.uniform(-kHalfTurn, kHalfTurn),
                               rng.uniform(-kHalfTurn, kHalfTurn)};
      REQUIRE(angular_difference(moved_configuration(kFirst, inverse(motion),
                                                     moved_configuration(kFirst, motion, q)),
                                 q) < 1e-13);
    }
  }

  TEST_CASE("the body of a moved configuration is the moved body") {
    const Robot arm = planar8();
    Rng rng(13);
    for (int i = 0; i < 200; ++i) {
      const Symmetry motion = random_symmetry(rng);
      const Configuration q = random_configuration(arm, rng);
      const auto before = arm.link_poses(q);
      const auto after = arm.link_poses(moved_configuration(kFirst, motion, q));
      for (std::size_t link = 0; link < before.size(); ++link) {
        for (const Capsule& capsule : arm.links()[link].capsules) {
          for (const Vec3& end : {capsule.a, capsule.b}) {
            const Vec3 expected = moved_point(motion, before[link] * end);
            REQUIRE((after[link] * end - expected).norm() < 1e-6);
          }
        }
      }
    }
  }
}

}  // namespace mneme::test
