// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/solids.h"
#include "covering/triangle_mesh.h"

#include <limits>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("the surface of a link is that of all its solids") {
    Link link;
    link.solids = {make_box({1, 1, 1}), make_box({2, 2, 2}, {5, 0, 0})};
    const auto surface = internal::link_surface(link);
    REQUIRE(surface.has_value());
    CHECK(internal::surface_area(*surface) == doctest::Approx(6 + 24));
  }

  TEST_CASE("a link without a surface, or one that is not finite, is refused by name") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const std::vector<Solid>& solids :
         {std::vector<Solid>{},
          {make_box({0, 0, 0})},
          {Cylinder{{}, 0, 0}},
          {make_box({nan, 1, 1})},
          {make_box({1, 1, 1}), make_box({1, 1, 1}, {nan, 0, 0})}}) {
      Link link;
      link.name = "wrist";
      link.solids = solids;
      const auto surface = internal::link_surface(link);
      REQUIRE_FALSE(surface.has_value());
      CHECK(surface.error().code == ErrorCode::invalid);
      CHECK(contains(surface.error().message, "link 'wrist'"));
    }
  }

  TEST_CASE("a link in millimetres is refused, which would be searched for ever") {
    Link link;
    link.name = "wrist";
    link.solids = {make_box({10, 400, 10})};
    const auto surface = internal::link_surface(link);
    REQUIRE_FALSE(surface.has_value());
    CHECK(surface.error().code == ErrorCode::invalid);
    CHECK(contains(surface.error().message, "link 'wrist': its collision geometry is 400 m long"));
    CHECK(contains(surface.error().message, "scale of 0.001"));
  }
}

}  // namespace
}  // namespace mneme::test
