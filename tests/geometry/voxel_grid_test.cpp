// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/parts.h"
#include "geometry/random_compounds.h"
#include "support/support.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mneme::test {
namespace {

using internal::VoxelGrid;
using Point3 = std::array<float, 3>;

/// By a look at every occupied octant.
int gap2_at(const std::vector<VoxelGrid::Index>& occupied, const VoxelGrid::Index& voxel) {
  int least = internal::kWideClearance;
  for (const VoxelGrid::Index& octant : occupied) {
    int sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int center = 2 * voxel[axis] + 1;
      const int along = std::max({octant[axis] - center, center - octant[axis] - 1, 0});
      sum += along * along;
    }
    least = std::min(least, sum);
  }
  return least;
}

void require_gaps(const VoxelGrid& grid, const std::vector<VoxelGrid::Index>& occupied) {
  for (int z = 0; z < grid.count[2]; ++z) {
    for (int y = 0; y < grid.count[1]; ++y) {
      for (int x = 0; x < grid.count[0]; ++x) {
        INFO("voxel " << x << ' ' << y << ' ' << z);
        REQUIRE(int{grid.clearances[grid.slot({x, y, z})]} == gap2_at(occupied, {x, y, z}));
      }
    }
  }
}

Point3 random_point(Rng& rng) {
  return {static_cast<float>(rng.uniform(-0.4, 0.4)), static_cast<float>(rng.uniform(-0.3, 0.3)),
          static_cast<float>(rng.uniform(-0.2, 0.2))};
}

std::vector<Point3> random_points(int count, Rng& rng) {
  std::vector<Point3> points;
  for (int i = 0; i < count; ++i) points.push_back(random_point(rng));
  return points;
}

constexpr internal::Region kAll = {{-1, -1, -1}, {1, 1, 1}};

/// All points that the blocks hold, sorted, each in its voxel.
std::vector<Point3> stored(const internal::PointGrid& grid) {
  std::vector<Point3> points;
  for (std::size_t voxel = 0; voxel < grid.first_block.size(); ++voxel) {
    for (int b = grid.first_block[voxel]; b >= 0;) {
      const internal::PointBlock& block = grid.blocks[static_cast<std::size_t>(b)];
      for (int i = 0; i < internal::kPointsPerBlock; ++i) {
        if (!std::isfinite(block.x[i])) continue;
        points.push_back({block.x[i], block.y[i], block.z[i]});
        CHECK(grid.voxels.slot_of(grid.voxels.octant_of(points.back())) == voxel);
      }
      b = block.next;
    }
  }
  std::ranges::sort(points);
  return points;
}

bool is_occupied(const VoxelGrid& grid, const VoxelGrid::Index& octant) {
  return (grid.octants[grid.slot_of(octant)] & VoxelGrid::bit_of(octant)) != 0;
}

VoxelGrid::Index octant_at(const VoxelGrid& grid, const Vec3& p) {
  const Vec3 local = p - internal::middle_of(grid);
  return grid.octant_of({static_cast<float>(local.x()), static_cast<float>(local.y()),
                         static_cast<float>(local.z())});
}

/// Calls `visit(octant, centre)`.
template <class Visit>
void for_each_octant(const VoxelGrid& grid, const Visit& visit) {
  const Vec3 origin =
      internal::middle_of(grid) + Vec3(grid.origin[0], grid.origin[1], grid.origin[2]);
  for (int z = 0; z < 2 * grid.count[2]; ++z) {
    for (int y = 0; y < 2 * grid.count[1]; ++y) {
      for (int x = 0; x < 2 * grid.count[0]; ++x) {
        visit(VoxelGrid::Index{x, y, z},
              origin + 0.5 * grid.edge * Vec3(x + 0.5, y + 0.5, z + 0.5));
      }
    }
  }
}

TEST_SUITE("law") {
  TEST_CASE("clearances of voxels are the way from their centres to the nearest occupied octant") {
    Rng rng(71);
    // Rows shorter and longer than vectors are.
    for (const float length : {0.1f, 0.5f, 1.3f}) {
      VoxelGrid grid = internal::make_voxel_grid({{0, 0, 0}, {length, 0.4f, 0.3f}});
      std::vector<VoxelGrid::Index> occupied;
      const auto random_octant = [&] {
        VoxelGrid::Index i;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          i[axis] = static_cast<int>(rng.index(static_cast<std::uint32_t>(2 * grid.count[axis])));
        }
        return i;
      };
      for (int k = 0; k < 6; ++k) {
        occupied.push_back(random_octant());
        grid.octants[grid.slot_of(occupied.back())] |= VoxelGrid::bit_of(occupied.back());
      }
      internal::find_clearances(grid);
      require_gaps(grid, occupied);
      // Far from the others, then beside them, as those of a surface are.
      for (int k = 0; k < 16; ++k) {
        VoxelGrid::Index octant = k < 3 ? random_octant() : occupied[rng.index(k + 6)];
        for (int& i : octant) i += k < 3 ? 0 : static_cast<int>(rng.index(3)) - 1;
        if (!grid.contains(octant)) octant = random_octant();
        occupied.push_back(octant);
        internal::occupy(octant, grid);
        require_gaps(grid, occupied);
      }
    }
  }

  TEST_CASE("a large region has larger voxels, not more of them without end") {
    const VoxelGrid grid = internal::make_voxel_grid({{-500, -500, -500}, {500, 500, 500}});
    CHECK(grid.size() <= std::size_t{1} << 18);
    CHECK(grid.contains(grid.octant_of({499, -499, 0})));
    CHECK(!grid.contains(grid.octant_of({1e30f, 0, 0})));
  }

  TEST_CASE("points that are replaced again and again are those of a grid made anew") {
    Rng rng(72);
    std::vector<Point3> points = random_points(2000, rng);
    internal::PointGrid grid = internal::make_point_grid(points, kAll);
    CHECK(stored(grid).size() == 2000);
    for (int round = 0; round < 15; ++round) {
      const std::size_t first = rng.index(1900);
      const std::vector<Point3> fresh = random_points(100, rng);
      const std::span<Point3> place(points.data() + first, fresh.size());
      REQUIRE(internal::replace_points(place, fresh, grid));
      std::ranges::copy(fresh, place.begin());
      std::vector<Point3> sorted = points;
      std::ranges::sort(sorted);
      REQUIRE(stored(grid) == sorted);
      // Voxels that were emptied may still narrow the clearances around them; none is too wide.
      std::vector<VoxelGrid::Index> occupied;
      for (const Point3& p : points) occupied.push_back(grid.voxels.octant_of(p));
      for (const Point3& p : random_points(50, rng)) {
        VoxelGrid::Index voxel = grid.voxels.octant_of(p);
        for (int& i : voxel) i /= 2;
        CHECK(int{grid.voxels.clearances[grid.voxels.slot(voxel)]} <= gap2_at(occupied, voxel));
      }
    }
    const std::vector<Point3> far = {{0.99f, 0, 0}};
    CHECK(!internal::replace_points({points.data(), 1}, far, grid));
  }

  TEST_CASE("points outside of the region are left out") {
    const std::vector<Point3> points = {{0, 0, 0}, {5, 0, 0}, {0.1f, 0.2f, 0.3f}};
    CHECK(stored(internal::make_point_grid(points, kAll)).size() == 2);
  }

  TEST_CASE("octants that a triangle runs through are occupied, and no others but near it") {
    Rng rng(73);
    int far = 0, occupied = 0;
    for (int round = 0; round < 80; ++round) {
      const Vec3 at = random_vector(rng, 0.3);
      const double size = round % 2 == 0 ? 0.6 : 0.05;
      Triangle t{at, at + random_vector(rng, size), at + random_vector(rng, size)};
      if (round % 4 == 2) {  // a sliver
        t.c = t.a + 0.5 * (t.b - t.a) + random_vector(rng, std::pow(10, rng.uniform(-17, -5)));
      }
      const Parts<Triangle> mesh({t});
      const auto tree = internal::share_grid(mesh, {Vec3::Constant(-1), Vec3::Constant(1)});
      const VoxelGrid& grid = tree->voxels;
      for (int i = 0; i < 2000; ++i) {
        const double u = rng.uniform(), v = rng.uniform() * (1 - u);
        const Vec3 p = t.a + u * (t.b - t.a) + v * (t.c - t.a);
        if (p.cwiseAbs().maxCoeff() > 0.99) continue;
        INFO("round " << round << ", point " << p.transpose());
        REQUIRE(is_occupied(grid, octant_at(grid, p)));
      }
      for_each_octant(grid, [&](const VoxelGrid::Index& octant, const Vec3& center) {
        if (!is_occupied(grid, octant)) return;
        ++occupied;
        far += (center - internal::nearest_on(center, t)).norm() > 0.87 * 0.5 * grid.edge;
      });
    }
    CHECK(occupied > 10'000);
    CHECK(far < occupied / 100);  // small triangles fill their boxes
  }
}

}  // namespace
}  // namespace mneme::test
