// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/memory.h"

#include "memory/near_pairs.h"
#include "geometry/box_surface.h"
#include "geometry/random_compounds.h"
#include "geometry/random_shapes.h"
#include "support/support.h"

#include <algorithm>

namespace mneme::test {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

Scene row_of_balls(int count, double spacing, double radius) {
  Scene scene{"row", {}};
  for (int i = 0; i < count; ++i) {
    scene.obstacles.push_back({"ball" + std::to_string(i), {Sphere{{i * spacing, 0, 0}, radius}}});
  }
  return scene;
}

TEST_SUITE("unit") {
  TEST_CASE("neighbours are near and others are not") {
    CHECK(require(internal::find_near_pairs(row_of_balls(4, 1, 0.4), 0.3)) ==
          Pairs{{0, 1}, {1, 2}, {2, 3}});
    CHECK(require(internal::find_near_pairs(row_of_balls(4, 1, 0.4), 0.1)).empty());
    CHECK(require(internal::find_near_pairs(row_of_balls(1, 1, 0.4), 1)).empty());
    CHECK(require(internal::find_near_pairs({}, 1)).empty());
  }

  TEST_CASE("all shapes of an obstacle count") {
    Scene scene = row_of_balls(2, 10, 0.4);
    scene.obstacles[0].shapes.push_back(Sphere{{9, 0, 0}, 0.4});
    CHECK(require(internal::find_near_pairs(scene, 0.3)) == Pairs{{0, 1}});
  }

  TEST_CASE("boxes stand for compound shapes where there is another obstacle to pair with") {
    Scene scene = row_of_balls(1, 1, 0.4);
    CHECK(!internal::with_boxed_compounds(row_of_balls(3, 1, 0.4)));
    const Box board{{rotation_from_rpy({0.3, 0.2, 0.7}), {2, 0, 0}}, {0.5, 0.2, 0.01}};
    const Scene alone{"mesh", {{"board", {compound_of(surface_of(board))}}}};
    CHECK(!internal::with_boxed_compounds(alone));
    scene.obstacles.push_back(alone.obstacles[0]);
    const auto boxed = require(internal::with_boxed_compounds(scene));
    CHECK(boxed.obstacles[0] == scene.obstacles[0]);
    const auto* box = std::get_if<Box>(&boxed.obstacles[1].shapes[0]);
    REQUIRE(box != nullptr);
    CHECK((box->pose.translation - board.pose.translation).norm() < 1e-9);
    CHECK(box->half_extents.prod() == doctest::Approx(board.half_extents.prod()).epsilon(0.05));
  }

  TEST_CASE("too many pairs are refused with the scene's name and a way out") {
    const Error refused =
        require_error(internal::find_near_pairs(row_of_balls(100, 0.01, 1), 0.1, 1000));
    CHECK(refused.code == ErrorCode::unsupported);
    for (const char* word : {"'row'", "100 obstacles", "1000 pairs", "max-gap"}) {
      CHECK_MESSAGE(contains(refused.message, word), refused.message);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("no pair within the gap is missed, and the order is that of the scene") {
    Rng rng(5);
    int found = 0;
    for (int round = 0; round < 30; ++round) {
      CAPTURE(round);
      Scene scene{"random", {}};
      for (int i = 0; i < 30; ++i) {
        const Shape shape = random_shape(static_cast<int>(rng.index(kShapeKinds)), rng);
        const Transform away{Eigen::Matrix3d::Identity(), random_vector(rng, 5)};
        scene.obstacles.push_back({std::to_string(i), {transformed(away, shape)}});
      }
      const double gap = rng.uniform(0.0, 1.0);
      const Pairs pairs = require(internal::find_near_pairs(scene, gap));
      CHECK(std::ranges::is_sorted(pairs));
      for (int i = 0; i < 30; ++i) {
        for (int j = i + 1; j < 30; ++j) {
          const auto& a = scene.obstacles[static_cast<std::size_t>(i)];
          const auto& b = scene.obstacles[static_cast<std::size_t>(j)];
          if (internal::obstacle_distance(a, b, gap) > gap) continue;
          ++found;
          CHECK(std::ranges::count(pairs, std::pair(i, j)) == 1);
        }
      }
    }
    CHECK(found > 100);
  }
}

TEST_SUITE("law") {
  TEST_CASE("a hundred thousand obstacles far apart have few pairs, found without all looks") {
    CHECK(require(internal::find_near_pairs(row_of_balls(100000, 1, 0.4), 0.3)).size() == 99999);
  }
}

}  // namespace
}  // namespace mneme::test
