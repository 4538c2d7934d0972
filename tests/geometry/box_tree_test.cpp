// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/box_tree.h"
#include "support/support.h"

#include <algorithm>
#include <cmath>

namespace mneme::test {
namespace {

using internal::AxisBox;
using internal::BoxTree;

/// Small boxes on the plane z = 0.
std::vector<AxisBox> scattered_boxes(int count, Rng& rng) {
  std::vector<AxisBox> boxes;
  for (int i = 0; i < count; ++i) {
    const Vec3 corner{rng.uniform(-3, 3), rng.uniform(-1, 1), 0};
    boxes.push_back({corner, corner + Vec3(0.1, 0.05, 0)});
  }
  return boxes;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("the nearest part is found") {
    Rng rng(41);
    for (const int count : {1, 3, 100, 1000}) {
      const std::vector<AxisBox> boxes = scattered_boxes(count, rng);
      const BoxTree tree(boxes, 4);
      for (int i = 0; i < 200; ++i) {
        const Vec3 point{rng.uniform(-4, 4), rng.uniform(-2, 2), rng.uniform(-1, 1)};
        const auto distance_to = [&](int part) {
          return std::sqrt(distance2(boxes[static_cast<std::size_t>(part)], {point, point}));
        };
        double least = distance_to(0);
        for (int part = 1; part < count; ++part) least = std::min(least, distance_to(part));
        CHECK(tree.nearest({point, point}, distance_to).distance == least);
        CHECK(tree.nearest({point, point}, distance_to, least).part == -1);
      }
    }
  }

  TEST_CASE("all parts are in leaves, within the boxes above them") {
    Rng rng(42);
    const std::vector<AxisBox> boxes = scattered_boxes(777, rng);
    const BoxTree tree(boxes, 4);
    std::vector<int> order = tree.order();
    std::ranges::sort(order);
    for (int i = 0; i < 777; ++i) REQUIRE(order[static_cast<std::size_t>(i)] == i);
    int parts = 0;
    for (const BoxTree::Node& node : tree.nodes()) {
      parts += node.count;
      CHECK(node.count <= 4);
      for (int i = node.first; i < node.first + node.count; ++i) {
        const int part = tree.order()[static_cast<std::size_t>(i)];
        CHECK(node.box.contains(boxes[static_cast<std::size_t>(part)]));
      }
    }
    CHECK(parts == 777);
  }
}

}  // namespace mneme::test
