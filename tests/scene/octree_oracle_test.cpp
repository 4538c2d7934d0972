// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The reader of octrees against OctoMap's own.
#include "scene/compound_files.h"
#include "support/support.h"

#include <doctest/doctest.h>

#ifdef MNEME_HAS_OCTOMAP
#include <octomap/octomap.h>
#endif

#include <algorithm>
#include <array>
#include <sstream>

namespace mneme::test {

#ifdef MNEME_HAS_OCTOMAP

namespace {

using Leaf = std::array<float, 4>;  // centre and half the edge

std::vector<Leaf> sorted(std::vector<Leaf> leaves) {
  std::ranges::sort(leaves);
  return leaves;
}

/// A few hundred rays, hits and misses; whatever can be one leaf becomes one.
octomap::OcTree random_octree(Rng& rng) {
  octomap::OcTree tree(rng.uniform(0.01, 0.1));
  const auto point = [&] {
    const auto axis = [&] { return static_cast<float>(rng.uniform(-1.0, 1.0)); };
    const float x = axis(), y = axis(), z = axis();
    return octomap::point3d(x, y, z);
  };
  for (int i = 0; i < 300; ++i) tree.insertRay(point(), point());
  for (int i = 0; i < 2000; ++i) tree.updateNode(point() * 0.3f, true);
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

std::vector<Leaf> occupied_leaves(const octomap::OcTree& tree) {
  std::vector<Leaf> leaves;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    leaves.push_back({static_cast<float>(leaf.getX()), static_cast<float>(leaf.getY()),
                      static_cast<float>(leaf.getZ()), static_cast<float>(leaf.getSize() / 2)});
  }
  return sorted(std::move(leaves));
}

std::vector<Leaf> read_leaves(const std::string& bytes) {
  const auto cubes = require(internal::parse_octree(bytes, {}, "m"));
  std::vector<Leaf> leaves;
  for (const Cube& cube : cubes) {
    const Eigen::Vector3f center = cube.center.cast<float>();
    leaves.push_back({center.x(), center.y(), center.z(), static_cast<float>(cube.half_extent)});
  }
  return sorted(std::move(leaves));
}

void check_same(const std::vector<Leaf>& read, const std::vector<Leaf>& expected) {
  REQUIRE(read.size() == expected.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      CHECK(read[i][k] == doctest::Approx(expected[i][k]).epsilon(1e-5));
    }
  }
}

}  // namespace

TEST_SUITE("oracle") {
  TEST_CASE("octrees that OctoMap wrote are read as OctoMap has them") {
    Rng rng(41);
    for (int i = 0; i < rounds(8); ++i) {
      octomap::OcTree tree = random_octree(rng);
      INFO("seed 41, tree " << i);
      std::ostringstream full, binary;
      REQUIRE(tree.write(full));
      check_same(read_leaves(full.str()), occupied_leaves(tree));
      // The binary form takes what is likelier than not for occupied, and merges it anew.
      REQUIRE(tree.writeBinary(binary));
      check_same(read_leaves(binary.str()), occupied_leaves(tree));
    }
  }
}

#else

TEST_SUITE("oracle") {
  TEST_CASE("octrees that OctoMap wrote are read as OctoMap has them") {
    MESSAGE("skipped: built without OctoMap");
  }
}

#endif

}  // namespace mneme::test
