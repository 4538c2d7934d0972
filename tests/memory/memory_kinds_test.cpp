// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/random_pairs.h"
#include "support/kinds.h"
#include "support/lifting_arm.h"

#include <cmath>
#include <limits>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("a canonical pair has its midpoint on the positive x axis and knows its gap") {
    const LocalPrimitive primitive = make_primitive({0, 2, 0.5, 0, 6, 1.5});
    CHECK(largest_difference(primitive.key, PrimitiveKey{2, 0, 0.5, 6, 0, 1.5}) < 1e-15);
    CHECK(primitive.to_scene.rotation == doctest::Approx(std::numbers::pi / 2));
    CHECK(!primitive.to_scene.is_mirrored);
    CHECK(primitive.gap == doctest::Approx(2));
  }

  TEST_CASE("the scene of a key holds its two circles") {
    const Scene scene = make_scene({1, 2, 0.5, 3, -4, 0.25});
    REQUIRE(scene.obstacles.size() == 2);
    CHECK(scene.obstacles[0].name == "circle_a");
    CHECK(scene.obstacles[1].name == "circle_b");
    const auto& b = std::get<Sphere>(scene.obstacles[1].shapes.at(0));
    CHECK(b.center == Vec3(3, -4, 0));
    CHECK(b.radius == 0.25);
  }

  TEST_CASE("a key has four images, itself first") {
    const PrimitiveKey key = {3, 1, 0.5, 4, -1, 0.75};
    const auto all = kind_named("pairs").images(key);
    REQUIRE(all.size() == 4);
    CHECK(all[0].key == key);
    CHECK(!all[0].is_mirrored);
    CHECK(all[1].key == PrimitiveKey{4, -1, 0.75, 3, 1, 0.5});
    CHECK(!all[1].is_mirrored);
    CHECK(all[2].key == PrimitiveKey{3, -1, 0.5, 4, 1, 0.75});
    CHECK(all[2].is_mirrored);
    CHECK(all[3].key == PrimitiveKey{4, 1, 0.75, 3, -1, 0.5});
    CHECK(all[3].is_mirrored);
  }

  TEST_CASE("the similarity error is a squared distance") {
    CHECK(pair_error({5, 1, 1, 5, -1, 1}, {5, 1, 1, 5, -1, 3}) == doctest::Approx(4));
    CHECK(pair_error({5, 1, 1, 5, -1, 1}, {8, 1, 1, 8, -1, 1}) == doctest::Approx(18));
  }
}

TEST_SUITE("law") {
  TEST_CASE("a primitive's motion takes its canonical key back to the scene") {
    Rng rng(21);
    for (int i = 0; i < 1000; ++i) {
      const PrimitiveKey pair = random_pair(rng);
      const LocalPrimitive primitive = make_primitive(pair);
      REQUIRE(largest_difference(moved_key(primitive.to_scene, primitive.key), pair) < 1e-13);
      REQUIRE(std::abs(primitive.key[1] + primitive.key[4]) < 1e-13);
      REQUIRE(primitive.key[0] + primitive.key[3] >= 0);
    }
  }

  TEST_CASE("the canonical key does not depend on where around the base the pair stands") {
    Rng rng(22);
    for (int i = 0; i < 1000; ++i) {
      const PrimitiveKey pair = random_pair(rng);
      const Symmetry turn{rng.uniform(-3, 3), false};
      const LocalPrimitive turned = make_primitive(moved_key(turn, pair));
      REQUIRE(largest_difference(turned.key, make_primitive(pair).key) < 1e-11);
      REQUIRE(turned.gap == doctest::Approx(make_primitive(pair).gap).epsilon(1e-12));
    }
  }

  TEST_CASE("swapping, mirroring or turning either primitive leaves the similarity error alone") {
    Rng rng(23);
    for (int i = 0; i < 1000; ++i) {
      const PrimitiveKey a = random_pair(rng);
      const PrimitiveKey b = random_pair(rng);
      const double error = pair_error(make_primitive(a).key, make_primitive(b).key);
      const PrimitiveKey other_a = make_primitive(moved_key(random_symmetry(rng), swapped(a))).key;
      const PrimitiveKey other_b = make_primitive(moved_key(random_symmetry(rng), b)).key;
      REQUIRE(pair_error(other_a, other_b) == doctest::Approx(error).epsilon(1e-10));
      REQUIRE(pair_error(other_b, other_a) == doctest::Approx(error).epsilon(1e-10));
    }
  }

  TEST_CASE("images are at error zero from each other, and only congruent pairs are") {
    Rng rng(24);
    for (int i = 0; i < 1000; ++i) {
      const PrimitiveKey key = make_primitive(random_pair(rng)).key;
      for (const KeyImage& first : kind_named("pairs").images(key)) {
        for (const KeyImage& second : kind_named("pairs").images(key)) {
          REQUIRE(pair_error(first.key, second.key) == 0);
        }
      }
      PrimitiveKey changed = key;
      changed[rng.index(6)] += 1e-3;
      REQUIRE(pair_error(key, changed) > 1e-9);
      REQUIRE(pair_error(key, changed) <= 1.0001e-6);
    }
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("the similarity error is the least squared distance over the images") {
    const std::uint64_t seed = 25;
    Rng rng(seed);
    for (int i = 0; i < 1000; ++i) {
      const PrimitiveKey a = make_primitive(random_pair(rng)).key;
      const PrimitiveKey b = make_primitive(random_pair(rng)).key;
      double least = 1e300;
      for (const KeyImage& image : kind_named("pairs").images(a)) {
        double sum = 0;
        for (std::size_t k = 0; k < b.size(); ++k) sum += std::pow(image.key[k] - b[k], 2);
        least = std::min(least, sum);
      }
      INFO("seed " << seed << ", pair " << i);
      REQUIRE(pair_error(a, b) == doctest::Approx(least).epsilon(1e-12));
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("kinds of memory are complete, and found by name and version") {
    const Robot planar = planar8();
    for (const MemoryKind* kind : memory_kinds()) {
      INFO(kind->name);
      CHECK(find_memory_kind(kind->name).value() == kind);
      CHECK(memory_kind_of(kind->version) == kind);
      CHECK(kind->version.starts_with(std::string(kind->name) + "/"));
      CHECK(!kind->summary.empty());
      CHECK(kind->key_size(planar) > 0);
      CHECK(bool(kind->decompose != nullptr));
      CHECK(bool(kind->images != nullptr));
      CHECK(bool(kind->synthesize != nullptr));
      CHECK(bool(kind->learn_from_paths != nullptr));
      CHECK(bool(kind->handles != nullptr));
      CHECK(kind->defaults.max_matches > 0);
    }
    CHECK(kind_named("pairs").version == "pairs/1");
    CHECK(kind_named("pairs").key_size(planar) == 6);
    CHECK(memory_kind_of("pairs/0") == nullptr);
  }

  TEST_CASE("every kind has a test of its own") {
    for (const MemoryKind* kind : memory_kinds()) {
      std::string text;
      for (const char* name : {"circle_pairs", "body_pairs", "motions", "whole_paths"}) {
        text += read_file(source_file("tests/memory/" + std::string(name) + "_test.cpp"));
      }
      CHECK_MESSAGE(contains(text, "\"" + std::string(kind->name) + "\""), kind->name);
    }
  }

  TEST_CASE("an unknown kind is refused with the names of those there are") {
    const Error error = require_error(find_memory_kind("triples"));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(contains(error.message, "'triples'"));
    CHECK(contains(error.message, "pairs"));
    const Robot robot = planar8();
    CHECK(!decompose({robot, Scene{}}, of_kind("triples")).has_value());
  }

  TEST_CASE("a maximal gap that is no length is refused") {
    const Robot robot = planar8();
    for (const double gap : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
      const Error error = require_error(decompose({robot, Scene{}}, {{}, gap}));
      CHECK(error.code == ErrorCode::invalid);
      CHECK(contains(error.message, "max-gap"));
    }
  }

  TEST_CASE("solved problems of an arm in space are remembered as paths") {
    CHECK(default_kind_of_paths(planar8()).name == "pairs");
    CHECK(default_kind_of_paths(lifting_arm()).name == "paths");
  }

  TEST_CASE("a default that depends on escape walks lists both values") {
    const std::vector<KindDefault> defaults = kind_defaults();
    CHECK(defaults.front().setting == "lambda");
    CHECK(defaults.front().values.front() == "0.8 (0.5 with walks)");
  }

  TEST_CASE("the kind that is left out is the robot's own") {
    const Robot robot = planar8();
    const Scene scene = make_circle_scene("two", {{3, 1, 0.9}, {3, -1, 0.9}});
    const auto result = require(decompose({robot, scene}));
    REQUIRE(result.size() == 1);
    CHECK(result.front().kind == "pairs/1");
  }
}

}  // namespace mneme::test
