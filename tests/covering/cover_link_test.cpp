// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/covering.h"

#include "covering/solids.h"

#include <limits>

namespace mneme::test {
namespace {

Link link_of(std::vector<Solid> solids) {
  Link link;
  link.name = "arm";
  link.solids = std::move(solids);
  return link;
}

TEST_SUITE("unit") {
  TEST_CASE("all solids of a link are covered together, in the link's frame") {
    const TemporaryDirectory files;
    write_file(files / "part.stl", to_binary_stl(internal::triangulate(make_box({0.1, 0.1, 0.1}))));
    const Transform up{Eigen::Matrix3d::Identity(), {0, 0, 0.3}};
    const auto cover = cover_link(link_of(
        {make_box({0.1, 0.1, 0.1}), Cylinder{{Eigen::Matrix3d::Identity(), {0.3, 0, 0}}, 0.05, 0.1},
         MeshFile{files / "part.stl", Vec3::Ones(), up}}));
    REQUIRE_MESSAGE(cover.has_value(), (cover ? "" : cover.error().message));
    CHECK(cover->link == "arm");
    CHECK(cover->uncovered == 0);
    for (const Vec3& p : {Vec3(0.05, 0.05, 0.05), Vec3(0.35, 0, 0.05), Vec3(-0.05, 0.05, 0.35)}) {
      CHECK(is_held(p, cover->spheres));
    }
    CHECK_FALSE(is_held({0.15, 0.1, 0.15}, cover->spheres));
  }

  TEST_CASE("settings that no cover can obey are refused") {
    const Link link = link_of({make_box({0.1, 0.1, 0.1})});
    for (const CoverSettings& settings :
         {CoverSettings{0, 5}, CoverSettings{-1, 5}, CoverSettings{0.02, 0},
          CoverSettings{std::numeric_limits<double>::quiet_NaN(), 5},
          CoverSettings{std::numeric_limits<double>::infinity(), 5}}) {
      const auto cover = cover_link(link, settings);
      REQUIRE_FALSE(cover.has_value());
      CHECK(cover.error().code == ErrorCode::invalid);
    }
  }

  TEST_CASE("errors of solids are passed on") {
    const auto cover = cover_link(link_of({MeshFile{"/no/such.stl", Vec3::Ones(), {}}}));
    REQUIRE_FALSE(cover.has_value());
    CHECK(contains(cover.error().message, "link 'arm': mesh /no/such.stl"));
  }
}

}  // namespace
}  // namespace mneme::test
