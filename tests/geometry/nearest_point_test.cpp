// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/solids.h"
#include "geometry/random_shapes.h"
#include "support/support.h"

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("the nearest point of a box is on the face that the point is in front of") {
    const Box box{{Eigen::Matrix3d::Identity(), {1, 2, 3}}, {0.1, 0.2, 0.3}};
    const Vec3 nearest = internal::nearest_point({1.05, 2.1, 9}, box);
    CHECK((nearest - Vec3(1.05, 2.1, 3.3)).norm() < 1e-12);
  }
}

TEST_SUITE("law") {
  TEST_CASE("the nearest point is in the solid, as far away as the distance says") {
    Rng rng(71);
    for (int i = 0; i < 4000; ++i) {
      const Shape shape = random_shape(i % kShapeKinds, rng);
      const Vec3 p = random_vector(rng, 3.0);
      const Vec3 nearest = internal::nearest_point(p, shape);
      REQUIRE(distance(nearest, shape) < 1e-9);
      REQUIRE((p - nearest).norm() == doctest::Approx(distance(p, shape)).epsilon(1e-9));
    }
  }
}

}  // namespace mneme::test
