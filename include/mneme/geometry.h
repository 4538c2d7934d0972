// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Rigid transforms, shapes and exact distances in double precision. Metres; `X_AB` is the pose of
/// B in A.
///
/// To add a shape, add a struct and a `Shape` alternative here; CONTRIBUTING.md lists the other
/// places.
#pragma once

#include <Eigen/Core>

#include <array>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace mneme {

/// A point or a direction. Neither Vec3 nor Matrix3d needs more than the default alignment.
using Vec3 = Eigen::Vector3d;

/// A rigid motion: X_AB takes coordinates in frame B to coordinates in frame A.
struct Transform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Vec3 translation = Vec3::Zero();

  [[nodiscard]] Vec3 operator*(const Vec3& p_B) const { return rotation * p_B + translation; }
  [[nodiscard]] Transform operator*(const Transform& X_BC) const {
    return {rotation * X_BC.rotation, rotation * X_BC.translation + translation};
  }
  [[nodiscard]] Transform inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation)};
  }
  bool operator==(const Transform&) const = default;
};

/// Rotation by `angle` radians about the unit vector `axis`.
[[nodiscard]] Eigen::Matrix3d rotation_about(const Vec3& axis, double angle);
/// Rotation of URDF's `rpy`: roll about x, then pitch about y, then yaw about z, all fixed axes.
[[nodiscard]] Eigen::Matrix3d rotation_from_rpy(const Vec3& rpy);
/// Rotation of a quaternion. The quaternion is normalised first and must not be zero.
[[nodiscard]] Eigen::Matrix3d rotation_from_quaternion(double w, double x, double y, double z);

struct Sphere {
  Vec3 center = Vec3::Zero();
  double radius = 0;

  bool operator==(const Sphere&) const = default;
};

/// All points within `radius` of the segment from `a` to `b`.
struct Capsule {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  double radius = 0;

  bool operator==(const Capsule&) const = default;
};

struct Box {
  Transform pose = {};  ///< of the box's centre
  Vec3 half_extents = Vec3::Zero();

  bool operator==(const Box&) const = default;
};

/// A solid cylinder about the z axis of `pose`, with its centre at the origin of `pose`.
struct Cylinder {
  Transform pose = {};
  double radius = 0;
  double length = 0;  ///< full height, between the flat ends

  bool operator==(const Cylinder&) const = default;
};

/// A point of a cloud: x, y, z, metres.
using CloudPoint = std::array<float, 3>;

/// A flat surface with two sides. Metres.
struct Triangle {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  Vec3 c = Vec3::Zero();

  [[nodiscard]] double area() const;
  [[nodiscard]] Vec3 centroid() const { return (a + b + c) / 3.0; }
};

/// An axis-aligned cube.
struct Cube {
  Vec3 center = Vec3::Zero();
  double half_extent = 0;  ///< at least 0
};

namespace internal {
struct PartsAccess;
}

/// The points, triangles or cubes of one compound shape, in the shape's frame. All scenes and
/// checkers with the shape share this object. Trees and grids for fast distances are built at first
/// use and kept. Const functions are parallel-safe.
template <class Part>
class Parts {
 public:
  /// `list` must not be empty, and all coordinates must be finite.
  explicit Parts(std::vector<Part> list) : list_(std::move(list)) {}

  [[nodiscard]] const std::vector<Part>& list() const { return list_; }

 private:
  friend struct internal::PartsAccess;
  std::vector<Part> list_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<void> bounds_, tree_, grid_, corners_;  ///< built at first use
};

/// A point cloud, mesh or octree: all points within `radius` of its parts.
template <class Part>
struct CompoundShape {
  Transform pose;                            ///< of the parts' frame
  std::shared_ptr<const Parts<Part>> parts;  ///< must not be null
  double radius = 0;                         ///< metres; above 0 for points, otherwise at least 0

  /// Compares `parts` as pointers: two objects with equal parts differ.
  bool operator==(const CompoundShape&) const = default;
};

using PointCloud = CompoundShape<CloudPoint>;
/// A surface without an inside: a body wholly within a closed mesh does not touch the mesh.
using Mesh = CompoundShape<Triangle>;
/// The occupied leaves of an octree.
using Octree = CompoundShape<Cube>;

using Shape = std::variant<Sphere, Box, Cylinder, Capsule, PointCloud, Mesh, Octree>;

/// "sphere", "box", "cylinder", "capsule", "points", "mesh" or "octree".
[[nodiscard]] std::string_view shape_name(const Shape& shape);
/// Converts `shape` from frame B to frame A.
[[nodiscard]] Shape transformed(const Transform& X_AB, const Shape& shape);
/// A sphere that contains `shape`; the smallest one for shapes that are not compound.
[[nodiscard]] Sphere bounding_sphere(const Shape& shape);

/// Distance from a point to a shape; 0 for a point inside the shape. A mesh has no inside.
[[nodiscard]] double distance(const Vec3& point, const Shape& shape);
/// Distance between two convex solids: 0 if they meet. Iterative: the result is too large by at
/// most a few 1e-5 m, or up to 1 mm where nearly parallel faces end close to each other. For
/// compound shapes: only the distance between some of their parts.
[[nodiscard]] double distance(const Shape& a, const Shape& b);
/// Distance between the segment ab, which may be a point, and a shape: 0 if they meet. Exact, for
/// cylinders to within 1e-9 m.
[[nodiscard]] double distance_to_segment(const Vec3& a, const Vec3& b, const Shape& shape);
/// Distance between the segments ab and cd, which may be parallel or points. Ericson, Real-Time
/// Collision Detection, section 5.1.9, with the determinant as a cross product.
[[nodiscard]] double segment_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace mneme
