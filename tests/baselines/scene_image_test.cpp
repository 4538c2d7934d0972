// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "baselines/scene_image.h"
#include "support/support.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("the spheres of all obstacles are circles, in order") {
    const Scene scene = make_circle_scene("", {{1, 2, 0.5}, {-3, 4, 0.25}});
    CHECK(internal::circles_of(scene) == PrimitiveKey{1, 2, 0.5, -3, 4, 0.25});
    CHECK(internal::circles_of({}).empty());
  }

  TEST_CASE("the direction of a scene is that of its mean centre") {
    CHECK(internal::mean_direction({1, 1, 9, 3, 3, 1}) == doctest::Approx(std::atan2(1, 1)));
    CHECK(internal::mean_direction({}) == 0);
  }

  TEST_CASE("an image is 1 inside of circles, 0 outside, and sums to their area") {
    const std::vector<float> image = internal::draw_image({1.1, -2.3, 1.4}, 40, 5);
    REQUIRE(image.size() == 1600);
    const auto at = [&](double x, double y) {
      const int column = static_cast<int>((x + 5) / 0.25), row = static_cast<int>((y + 5) / 0.25);
      return image[static_cast<std::size_t>(row * 40 + column)];
    };
    CHECK(at(1.1, -2.3) == 1);
    CHECK(at(-2.3, 1.1) == 0);
    const double area = std::accumulate(image.begin(), image.end(), 0.0) * 0.25 * 0.25;
    CHECK(area == doctest::Approx(3.14159 * 1.4 * 1.4).epsilon(0.02));
  }

  TEST_CASE("a boundary that moves within a cell changes the image") {
    CHECK(internal::draw_image({0, 0, 1.0}, 10, 5) != internal::draw_image({0, 0, 1.2}, 10, 5));
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("every cell follows from its distance to the nearest circle, also beyond the edges") {
    const PrimitiveKey circles = {1.1, -2.3, 1.4, 4.9, 4.9, 0.7,  -5.2, 0, 0.3,
                                  0,   9,    2,   1.5, -2,  0.01, 1,    1, 0.9};
    const std::vector<float> image = internal::draw_image(circles, 50, 5);
    for (std::size_t i = 0; i < image.size(); ++i) {
      const double x = (static_cast<double>(i % 50) + 0.5) * 0.2 - 5;
      const double y = (static_cast<double>(i / 50) + 0.5) * 0.2 - 5;
      double nearest = 100;
      for (std::size_t j = 0; j < circles.size(); j += 3) {
        const double distance = std::hypot(x - circles[j], y - circles[j + 1]) - circles[j + 2];
        nearest = std::min(nearest, distance);
      }
      CHECK(std::abs(image[i] - std::clamp(0.5 - nearest / 0.2, 0.0, 1.0)) < 1e-6);
    }
  }
}

}  // namespace mneme::test
