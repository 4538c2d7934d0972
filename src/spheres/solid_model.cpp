// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "spheres/solid_model.h"

#include "base/as_index.h"
#include "geometry/part_distance.h"
#include "geometry/parts.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// Number of voxels in the bounding box: a few across thin parts, at a cost of tenths of a second.
constexpr double kVoxelCount = 60000;
constexpr int kPadding = 2;

/// A ball is dropped if the neighbour's radius is larger by this fraction of the step between them;
/// with 1 it lies within that ball. Less than 1, because the depth grows fastest in a direction up
/// to 27 degrees from that of a step.
constexpr double kGrowth = 0.85;

std::vector<Eigen::Array3i> steps_to_neighbours() {
  std::vector<Eigen::Array3i> steps;
  for (int i = 0; i < 27; ++i) {
    if (i != 13) steps.emplace_back(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
  }
  return steps;
}

double choose_voxel_size(const AxisBox& bounds) {
  const Vec3 extents = bounds.high - bounds.low;
  const double longest = extents.maxCoeff();
  const Vec3 stout = extents.cwiseMax(0.02 * longest);
  return std::cbrt(stout.prod() / kVoxelCount);
}

}  // namespace

SolidModel::SolidModel(const TriangleMesh& mesh) : SolidModel(mesh, is_closed(mesh)) {}

SolidModel::SolidModel(const TriangleMesh& mesh, bool is_closed) : is_enclosed_(mesh, is_closed) {
  const AxisBox bounds = box_around(mesh);
  voxel_size_ = choose_voxel_size(bounds);
  origin_ = bounds.low - Vec3::Constant(kPadding * voxel_size_);
  const Vec3 voxels = (bounds.high - bounds.low) / voxel_size_;
  counts_ = voxels.array().ceil().cast<int>() + 2 * kPadding;
  kinds_.assign(slot(counts_ - 1) + 1, Kind::unknown);
  mark_surface(mesh);
  flood();
  fill_open(!is_closed);
  collect_inner_voxels();

  TriangleMesh outer;
  for (const Triangle& triangle : mesh) {
    TriangleMesh pieces = subdivide({triangle}, 2 * voxel_size_);
    const std::size_t count = pieces.size();
    std::erase_if(pieces, [&](const Triangle& t) { return !is_near_outside(t.centroid()); });
    if (pieces.size() == count) pieces = {triangle};
    outer.insert(outer.end(), pieces.begin(), pieces.end());
  }
  outer_ = SurfaceDistance(outer.empty() ? mesh : std::move(outer));
}

std::size_t SolidModel::slot(const Index& i) const {
  return (as_index(i[2]) * as_index(counts_[1]) + as_index(i[1])) * as_index(counts_[0]) +
         as_index(i[0]);
}

SolidModel::Index SolidModel::index_at(std::size_t slot) const {
  const auto x = as_index(counts_[0]), y = as_index(counts_[1]);
  return {static_cast<int>(slot % x), static_cast<int>(slot / x % y),
          static_cast<int>(slot / x / y)};
}

SolidModel::Index SolidModel::index_of(const Vec3& point) const {
  const Eigen::Array3d voxel = ((point - origin_) / voxel_size_).array().floor();
  return voxel.max(-1.0).min(counts_.cast<double>()).cast<int>();
}

bool SolidModel::is_in_grid(const Index& index) const {
  return (index >= 0).all() && (index < counts_).all();
}

Vec3 SolidModel::center_of(const Index& index) const {
  return origin_ + voxel_size_ * (index.cast<double>() + 0.5).matrix();
}

void SolidModel::mark_surface(const TriangleMesh& mesh) {
  constexpr int kMostSkipped = 8;
  const SurfaceDistance surface(mesh);
  const double reach = 0.5 * std::sqrt(3.0) * voxel_size_;
  for (std::size_t i = 0; i < kinds_.size();) {
    const double gap =
        surface.from(center_of(index_at(i)), reach + kMostSkipped * voxel_size_) - reach;
    if (gap < 0) kinds_[i] = Kind::surface;
    // Voxels of this row that are nearer than the gap have no surface.
    const int rest = counts_[0] - index_at(i)[0];
    i += as_index(std::min(1 + static_cast<int>(std::max(0.0, gap) / voxel_size_), rest));
  }
}

void SolidModel::flood() {
  std::vector<Index> open = {Index::Zero()};
  kinds_[0] = Kind::outside;
  while (!open.empty()) {
    const Index from = open.back();
    open.pop_back();
    for (int i = 0; i < 6; ++i) {
      Index to = from;
      to[i / 2] += i % 2 == 0 ? 1 : -1;
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
    if (kinds_[i] == Kind::outside && has_rim && is_enclosed_(center)) {
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
        const Index near = at + Index(x, y, z);
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
  return kind == Kind::inside || (kind == Kind::surface && is_enclosed_(point));
}

double SolidModel::depth(const Vec3& point) const {
  const double distance = outer_.from(point);
  return contains(point) ? distance : -distance;
}

double SolidModel::excess(const Vec3& point) const {
  return contains(point) ? 0 : outer_.from(point);
}

void SolidModel::collect_inner_voxels() {
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    const Vec3 center = center_of(index_at(i));
    if (contains(center)) inner_voxels_.push_back({center, kinds_[i] == Kind::inside});
  }
}

std::vector<Sphere> SolidModel::medial_balls() const {
  constexpr double kRounding = 1e-9;
  std::vector<double> depths(kinds_.size(), -1);
  Vec3 nearest = Vec3::Constant(std::numeric_limits<double>::infinity());
  for (const Voxel& voxel : inner_voxels_) {
    // The next voxel is near: no other point is much nearer to it.
    nearest = outer_.nearest(voxel.center, (voxel.center - nearest).norm() + kRounding);
    depths[slot(index_of(voxel.center))] = (voxel.center - nearest).norm();
  }
  const auto steps = steps_to_neighbours();
  const auto is_medial = [&](const Vec3& center, double depth_there) {
    const Index at = index_of(center);
    return std::ranges::none_of(steps, [&](const Index& step) {
      const Index near = at + step;
      const double length = voxel_size_ * step.matrix().cast<double>().norm();
      return is_in_grid(near) && depths[slot(near)] >= depth_there + kGrowth * length;
    });
  };
  std::vector<Sphere> balls;
  for (const Voxel& voxel : inner_voxels_) {
    const double radius = depths[slot(index_of(voxel.center))];
    if (is_medial(voxel.center, radius)) balls.push_back({voxel.center, radius});
  }
  return balls;
}

}  // namespace mneme::internal
