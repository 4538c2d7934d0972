// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/solid_model.h"

#include "base/as_index.h"
#include "geometry/part_distance.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// Number of voxels in the bounding box: a few across thin parts, at a cost of tenths of a second.
constexpr double kVoxelCount = 60000;
constexpr int kPadding = 2;

constexpr std::array<std::array<int, 3>, 6> kNeighbours = {
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

/// A ball is dropped if the neighbour's radius is larger by this fraction of the step between them;
/// with 1 it lies within that ball. Less than 1, because the depth grows fastest in a direction up
/// to 27 degrees from that of a step.
constexpr double kGrowth = 0.85;

std::vector<std::array<int, 3>> all_neighbours() {
  std::vector<std::array<int, 3>> steps;
  for (int i = 0; i < 27; ++i) {
    if (i != 13) steps.push_back({i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1});
  }
  return steps;
}

double choose_voxel_size(const AxisBox& bounds) {
  const Vec3 extents = bounds.high - bounds.low;
  const double longest = extents.maxCoeff();
  const Vec3 stout = extents.cwiseMax(0.02 * longest);
  return std::cbrt(stout.prod() / kVoxelCount);
}

Mesh mesh_of(TriangleMesh triangles) {
  return {{}, std::make_shared<const Parts<Triangle>>(std::move(triangles)), 0};
}

}  // namespace

SolidModel::SolidModel(const TriangleMesh& mesh) : surface_(mesh_of(mesh)) {
  const AxisBox bounds = box_around(mesh);
  voxel_size_ = choose_voxel_size(bounds);
  origin_ = bounds.low - Vec3::Constant(kPadding * voxel_size_);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double extent = bounds.high[axis] - bounds.low[axis];
    counts_[i] = static_cast<int>(std::ceil(extent / voxel_size_)) + 2 * kPadding;
  }
  kinds_.assign(slot({counts_[0] - 1, counts_[1] - 1, counts_[2] - 1}) + 1, Kind::unknown);
  mark_surface();
  flood();
  fill_open(!is_closed(mesh));
  collect_inner_voxels();

  TriangleMesh outer;
  for (const Triangle& piece : subdivide(mesh, 2 * voxel_size_)) {
    if (is_near_outside(piece.centroid())) outer.push_back(piece);
  }
  outer_ = outer.empty() ? surface_ : mesh_of(std::move(outer));
}

std::size_t SolidModel::slot(const Index& i) const {
  const auto at = [&](std::size_t axis) { return as_index(i[axis]); };
  const auto count = [&](std::size_t axis) { return as_index(counts_[axis]); };
  return (at(2) * count(1) + at(1)) * count(0) + at(0);
}

SolidModel::Index SolidModel::index_at(std::size_t slot) const {
  const auto x = as_index(counts_[0]);
  const auto y = as_index(counts_[1]);
  return {static_cast<int>(slot % x), static_cast<int>(slot / x % y),
          static_cast<int>(slot / x / y)};
}

SolidModel::Index SolidModel::index_of(const Vec3& point) const {
  Index index;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double voxel = std::floor((point[axis] - origin_[axis]) / voxel_size_);
    index[i] = static_cast<int>(std::clamp(voxel, -1.0, static_cast<double>(counts_[i])));
  }
  return index;
}

bool SolidModel::is_in_grid(const Index& index) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (index[i] < 0 || index[i] >= counts_[i]) return false;
  }
  return true;
}

Vec3 SolidModel::center_of(const Index& i) const {
  return origin_ + voxel_size_ * Vec3(i[0] + 0.5, i[1] + 0.5, i[2] + 0.5);
}

void SolidModel::mark_surface() {
  const double reach = 0.5 * std::sqrt(3.0) * voxel_size_;
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    const Vec3 center = center_of(index_at(i));
    if (nearest_part(surface_, center, center, reach).part >= 0) kinds_[i] = Kind::surface;
  }
}

void SolidModel::flood() {
  std::vector<Index> open = {Index{0, 0, 0}};
  kinds_[0] = Kind::outside;
  while (!open.empty()) {
    const Index from = open.back();
    open.pop_back();
    for (const auto& step : kNeighbours) {
      const Index to = {from[0] + step[0], from[1] + step[1], from[2] + step[2]};
      if (!is_in_grid(to) || kinds_[slot(to)] != Kind::unknown) continue;
      kinds_[slot(to)] = Kind::outside;
      open.push_back(to);
    }
  }
  std::ranges::replace(kinds_, Kind::unknown, Kind::inside);
}

void SolidModel::fill_open(bool has_rim) {
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    const Vec3 center = center_of(index_at(i));
    if (kinds_[i] == Kind::outside && has_rim && is_enclosed(center, *surface_.parts)) {
      kinds_[i] = Kind::inside;
    }
  }
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    if (kinds_[i] == Kind::surface && !is_near_outside(center_of(index_at(i)))) {
      kinds_[i] = Kind::inside;
    }
  }
}

bool SolidModel::is_near_outside(const Vec3& point) const {
  const Index at = index_of(point);
  for (int x = -kPadding; x <= kPadding; ++x) {
    for (int y = -kPadding; y <= kPadding; ++y) {
      for (int z = -kPadding; z <= kPadding; ++z) {
        const Index near = {at[0] + x, at[1] + y, at[2] + z};
        if (!is_in_grid(near) || kinds_[slot(near)] == Kind::outside) return true;
      }
    }
  }
  return false;
}

bool SolidModel::contains(const Vec3& point) const {
  const Index index = index_of(point);
  if (!is_in_grid(index)) return false;
  const Kind kind = kinds_[slot(index)];
  return kind == Kind::inside || (kind == Kind::surface && is_enclosed(point, *surface_.parts));
}

double SolidModel::depth(const Vec3& point) const {
  const double distance = nearest_part(outer_, point, point).distance;
  return contains(point) ? distance : -distance;
}

void SolidModel::collect_inner_voxels() {
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    const Vec3 center = center_of(index_at(i));
    if (contains(center)) inner_voxels_.push_back({center, kinds_[i] == Kind::inside});
  }
}

std::vector<Sphere> SolidModel::medial_balls() const {
  std::vector<double> depths(kinds_.size(), -1);
  for (const Voxel& voxel : inner_voxels_) {
    depths[slot(index_of(voxel.center))] =
        nearest_part(outer_, voxel.center, voxel.center).distance;
  }
  const auto steps = all_neighbours();
  const auto is_medial = [&](const Vec3& center, double depth) {
    const Index at = index_of(center);
    for (const auto& [x, y, z] : steps) {
      const Index near = {at[0] + x, at[1] + y, at[2] + z};
      const double step = voxel_size_ * std::sqrt(x * x + y * y + z * z);
      if (is_in_grid(near) && depths[slot(near)] >= depth + kGrowth * step) return false;
    }
    return true;
  };
  std::vector<Sphere> balls;
  for (const Voxel& voxel : inner_voxels_) {
    const double depth = depths[slot(index_of(voxel.center))];
    if (is_medial(voxel.center, depth)) balls.push_back({voxel.center, depth});
  }
  return balls;
}

}  // namespace mneme::internal
