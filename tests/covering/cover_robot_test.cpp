// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_robot.h"
#include "covering/small_parts.h"
#include "covering/solids.h"

#include <filesystem>

namespace mneme::test {
namespace {

using internal::CoverCache;

/// l0 has a box and shapes of its own, l1 only shapes, l2 a cylinder.
Robot::Parts make_parts() {
  Robot::Parts parts = make_bare_chain(2);
  parts.links[0].solids = {make_box({0.2, 0.1, 0.1})};
  parts.links[0].spheres = {{{0.5, 0, 0}, 0.1}};
  parts.links[0].capsules = {{{0, 0, 0}, {1, 0, 0}, 0.02}};
  parts.links[1].spheres = {{{0.25, 0, 0}, 0.2}};
  parts.links[2].solids = {Cylinder{{}, 0.05, 0.2}};
  return parts;
}

TEST_SUITE("unit") {
  TEST_CASE("solids become spheres; what was sphere or capsule stays") {
    const auto covering = cover_robot(make_parts());
    REQUIRE_MESSAGE(covering.has_value(), (covering ? "" : covering.error().message));
    REQUIRE(covering->links.size() == 2);
    CHECK(covering->links[0].link == "l0");
    CHECK(covering->links[1].link == "l2");
    const auto& links = covering->parts.links;
    for (const Link& link : links) CHECK(link.solids.empty());
    CHECK(links[0].spheres[0].center == Vec3(0.5, 0, 0));
    CHECK(links[0].spheres.size() == 1 + covering->links[0].spheres.size());
    CHECK(links[0].capsules.size() == 1);
    CHECK(links[1].spheres.size() == 1);
    CHECK(links[2].spheres.size() == covering->links[1].spheres.size());
  }

  TEST_CASE("covers are made once, and made again if they were damaged") {
    const TemporaryDirectory files;
    const CoverCache cache(files / "cache");
    const auto first = internal::cover_robot(make_parts(), {}, cache);
    REQUIRE(first.has_value());
    CHECK(first->found == 0);
    CHECK(first->stored == 2);
    const auto second = internal::cover_robot(make_parts(), {}, cache);
    REQUIRE(second.has_value());
    CHECK(second->found == 2);
    CHECK(second->stored == 0);
    REQUIRE(second->covering.links[0].spheres.size() == first->covering.links[0].spheres.size());
    CHECK(second->covering.links[1].link == "l2");
    CHECK(second->covering.links[0].spheres[0].radius ==
          first->covering.links[0].spheres[0].radius);
    const auto entry = std::filesystem::directory_iterator(files / "cache")->path();
    write_file(entry.string(), "rubbish");
    const auto third = internal::cover_robot(make_parts(), {}, cache);
    REQUIRE(third.has_value());
    CHECK(third->found == 1);
    CHECK(third->stored == 1);
    CHECK(internal::cover_robot(make_parts(), {0.03, 16}, cache)->found == 0);
  }

  TEST_CASE("the first link whose solids are wrong is named") {
    Robot::Parts parts = make_parts();
    parts.links[1].solids = {MeshFile{"/no/first.stl", Vec3::Ones(), {}}};
    parts.links[2].solids = {MeshFile{"/no/second.stl", Vec3::Ones(), {}}};
    const auto covering = cover_robot(parts);
    REQUIRE_FALSE(covering.has_value());
    CHECK(contains(covering.error().message, "link 'l1': mesh /no/first.stl"));
  }

  TEST_CASE("a robot without solids stays as it is") {
    const auto covering = cover_robot(make_bare_chain(1));
    REQUIRE(covering.has_value());
    CHECK(covering->links.empty());
  }
}

}  // namespace
}  // namespace mneme::test
