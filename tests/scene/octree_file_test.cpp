// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/compound_files.h"
#include "support/support.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstring>
#include <limits>

namespace mneme::test {
namespace {

using internal::parse_octree;

std::string octree_header(bool is_binary, const std::string& id = "OcTree",
                          const char* res = "0.1") {
  return fmt::format("# Octomap OcTree {}file\n# a comment\nid {}\nsize 3\nres {}\ndata\n",
                     is_binary ? "binary " : "", id, res);
}

/// Two bits per child, the first child in the lowest ones.
std::string child_bits(std::initializer_list<unsigned> kinds) {
  unsigned bits = 0, i = 0;
  for (const unsigned kind : kinds) bits |= kind << (2 * i++);
  return {static_cast<char>(bits), static_cast<char>(bits >> 8)};
}

constexpr unsigned kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3;

std::string full_node(float log_odds, unsigned children, const std::string& colour = "") {
  std::string bytes(sizeof log_odds, '\0');
  std::memcpy(bytes.data(), &log_odds, sizeof log_odds);
  return bytes + colour + static_cast<char>(children);
}

std::vector<Cube> cubes_of(const std::string& bytes, bool is_unknown_occupied = false) {
  return require(parse_octree(bytes, {is_unknown_occupied}, "m.bt"));
}

std::string octree_message(const std::string& bytes) {
  const auto cubes = parse_octree(bytes, {}, "m.bt");
  return cubes ? "" : cubes.error().message;
}

double volume_of(const std::vector<Cube>& cubes) {
  double sum = 0;
  for (const Cube& c : cubes) sum += 8 * c.half_extent * c.half_extent * c.half_extent;
  return sum;
}

TEST_SUITE("unit") {
  TEST_CASE("occupied leaves of a binary octree are cubes where OctoMap has them") {
    // The root is 0.1 m * 2^16 wide; its last child holds all positive coordinates.
    const std::string tree =
        child_bits({kOccupied, kFree, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kInner}) +
        child_bits({kUnknown, kOccupied});
    const std::vector<Cube> cubes = cubes_of(octree_header(true) + tree);
    REQUIRE(cubes.size() == 2);
    CHECK(cubes[0].center.isApprox(Vec3::Constant(-1638.4)));
    CHECK(cubes[0].half_extent == doctest::Approx(1638.4));
    CHECK(cubes[1].center.isApprox(Vec3(2457.6, 819.2, 819.2)));
    CHECK(cubes[1].half_extent == doctest::Approx(819.2));
  }

  TEST_CASE("leaves with log odds are occupied from one half on, with colours or without") {
    const std::string plain = full_node(1, 0b10000001) + full_node(0, 0) + full_node(-0.1f, 0);
    CHECK(cubes_of(octree_header(false) + plain).size() == 1);
    const float unreadable = std::numeric_limits<float>::quiet_NaN();
    CHECK(cubes_of(octree_header(false) + full_node(unreadable, 0)).size() == 1);
    const std::string colored =
        full_node(1, 0b11, "rgb") + full_node(2, 0, "rgb") + full_node(3, 0, "rgb");
    CHECK(cubes_of(octree_header(false, "ColorOcTree") + colored).size() == 2);
  }

  TEST_CASE("unknown space is occupied by choice, within the box of what is known") {
    // Known are two of the eight children of a cube; the box around them holds all eight.
    const std::string inner =
        child_bits({kFree, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kOccupied});
    const std::string tree =
        child_bits({kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kInner}) +
        inner;
    const double cell = std::pow(2 * 819.2, 3);
    CHECK(volume_of(cubes_of(octree_header(true) + tree)) == doctest::Approx(cell));
    CHECK(volume_of(cubes_of(octree_header(true) + tree, true)) == doctest::Approx(7 * cell));
  }

  TEST_CASE("leaves are limited, unknown space only where it counts") {
    const std::string tree =
        octree_header(true) + child_bits({kInner, kOccupied, kOccupied}) + child_bits({kOccupied});
    const auto is_read = [&](bool is_unknown_occupied, std::size_t most_cubes) {
      return parse_octree(tree, {is_unknown_occupied, most_cubes}, "m.bt").has_value();
    };
    CHECK(is_read(false, 3));
    CHECK(!is_read(false, 2));
    CHECK(!is_read(true, 11));
    CHECK(is_read(true, 3 + 12));
  }

  TEST_CASE("a tree without an occupied leaf has no cubes") {
    CHECK(require(parse_octree(octree_header(true), {}, "m.bt")).empty());
  }

  TEST_CASE("octrees of other versions and types, and malformed ones are refused") {
    CHECK(octree_message("# Octomap 2 file\n").starts_with("m.bt: expected a file of OctoMap 1"));
    CHECK(octree_message("").starts_with("m.bt: expected a file of OctoMap 1"));
    CHECK(octree_message(octree_header(true, "CountingOcTree")) ==
          "m.bt: expected the id OcTree or ColorOcTree, got \"CountingOcTree\"");
    CHECK(octree_message("# Octomap OcTree file\nid OcTree\nres 0.1\n") ==
          "m.bt: expected a header of OctoMap, which ends with data");
    CHECK(octree_message("# Octomap OcTree file\nid OcTree\n# mine\n\nres 0\ndata\n") ==
          "m.bt: expected a resolution of 0.0001 to 100 m, got 0");
    CHECK(octree_message(octree_header(true, "OcTree", "0")) ==
          "m.bt: expected a resolution of 0.0001 to 100 m, got 0");
    CHECK(octree_message(octree_header(true) + "x") == "m.bt: ends within its tree");
    CHECK(octree_message(octree_header(true) + child_bits({kOccupied}) + "x") ==
          "m.bt: expected the end of the file after the tree, got 1 more bytes");
    std::string deep;
    for (int i = 0; i < 17; ++i) deep += child_bits({kInner});
    CHECK(octree_message(octree_header(true) + deep) ==
          "m.bt: expected a tree of at most 16 levels");
  }
}

}  // namespace
}  // namespace mneme::test
