// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "base/check_ranges.h"
#include "base/fail.h"
#include "base/files.h"
#include "base/threads.h"
#include "spheres/approximate_robot.h"
#include "spheres/triangle_mesh.h"
#include "geometry/solids.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>

namespace mneme {
namespace {

/// Factor on the excess while a lattice has too many spheres.
constexpr double kCoarser = 1.2;

/// Adds spheres that contain the box around the origin: one around each cell of a grid. If all axes
/// have at least three cells, the inner ones are replaced by coarser ones. Ends with more than
/// `most` spheres.
void add_cell_spheres(const Vec3& half_extents, double excess, std::ptrdiff_t most,
                      std::vector<Sphere>& spheres) {
  std::array<int, 3> counts = {1, 1, 1};
  Vec3 cell = half_extents;
  // The outer layer alone has more cells than its longest row.
  while (cell.norm() - cell.minCoeff() > excess && std::ranges::max(counts) <= most) {
    Eigen::Index widest = 0;
    cell.maxCoeff(&widest);
    const int count = ++counts[static_cast<std::size_t>(widest)];
    cell[widest] = half_extents[widest] / count;
  }
  const auto is_inside = [&](int i, int axis) {
    return i > 0 && i + 1 < counts[static_cast<std::size_t>(axis)];
  };
  bool is_hollow = false;
  for (int x = 0; x < counts[0]; ++x) {
    for (int y = 0; y < counts[1]; ++y) {
      for (int z = 0; z < counts[2]; ++z) {
        if (is_inside(x, 0) && is_inside(y, 1) && is_inside(z, 2)) {
          is_hollow = true;
          z = counts[2] - 2;  // the last inner one
          continue;
        }
        if (std::ssize(spheres) > most) return;
        const Vec3 steps(2 * x + 1, 2 * y + 1, 2 * z + 1);
        spheres.push_back({steps.cwiseProduct(cell) - half_extents, cell.norm()});
      }
    }
  }
  if (!is_hollow) return;
  add_cell_spheres(half_extents - 2 * cell, excess + 2 * cell.minCoeff(), most, spheres);
}

/// Adds spheres that contain the upright cylinder around the origin: rings of cells in layers.
void add_ring_spheres(double radius, double half_length, double cell,
                      std::vector<Sphere>& spheres) {
  const auto count = [&](double length) {
    return std::max(1, static_cast<int>(std::ceil(length / cell)));
  };
  const int layers = count(half_length), rings = count(radius);
  const double half_height = half_length / layers, width = radius / rings;
  for (int ring = 0; ring < rings; ++ring) {
    const double inner = ring * width, outer = inner + width;
    // A disc in the middle needs no sectors.
    const int sectors = ring == 0 ? 1 : std::max(3, count(std::numbers::pi * outer));
    const double half_angle = std::numbers::pi / sectors;
    const double middle = ring == 0 ? 0 : (inner + outer) / 2;
    const auto to_corner = [&](double r) {
      return std::hypot(r * std::cos(half_angle) - middle, r * std::sin(half_angle));
    };
    const double across = ring == 0 ? outer : std::max(to_corner(inner), to_corner(outer));
    for (int layer = 0; layer < layers; ++layer) {
      const double z = (2 * layer + 1) * half_height - half_length;
      for (int sector = 0; sector < sectors; ++sector) {
        const double angle = 2 * half_angle * sector;
        spheres.push_back({{middle * std::cos(angle), middle * std::sin(angle), z},
                           std::hypot(across, half_height)});
      }
    }
  }
}

/// Metres by which spheres stick out of an upright cylinder around the origin.
double excess_of(std::span<const Sphere> spheres, double radius, double half_length) {
  double excess = 0;
  for (const Sphere& s : spheres) {
    excess = std::max({excess, s.center.head<2>().norm() + s.radius - radius,
                       std::abs(s.center.z()) + s.radius - half_length});
  }
  return excess;
}

/// Collects the spheres of an object and the exact geometry that they contain.
class ObjectSpheres {
 public:
  explicit ObjectSpheres(const SphereSettings& settings) : settings_(settings) {}

  void operator()(const Sphere& sphere) { result_.spheres.push_back(sphere); }
  void operator()(const Capsule& capsule) { result_.capsules.push_back(capsule); }
  /// Points and cubes are refused before, and meshes are added at the end.
  template <class Part>
  void operator()(const CompoundShape<Part>& /*compound*/) {}
  void operator()(const Box& box) {
    add(box, box.half_extents.maxCoeff(), [&](double excess) {
      std::vector<Sphere> spheres;
      add_cell_spheres(box.half_extents, excess, settings_.max_spheres, spheres);
      return spheres;
    });
  }
  void operator()(const Cylinder& cylinder) {
    const double half_length = cylinder.length / 2;
    const double size = std::max(cylinder.radius, half_length);
    add(cylinder, size, [&](double excess) {
      std::vector<Sphere> spheres;
      for (double cell = size;; cell /= kCoarser) {
        spheres.clear();
        add_ring_spheres(cylinder.radius, half_length, cell, spheres);
        const bool is_close = excess_of(spheres, cylinder.radius, half_length) <= excess;
        if (is_close || std::ssize(spheres) > settings_.max_spheres) return spheres;
      }
    });
  }
  void add(std::span<const Sphere> spheres, std::span<const Triangle> exact, double excess) {
    spheres_.insert(spheres_.end(), spheres.begin(), spheres.end());
    surface_.insert(surface_.end(), exact.begin(), exact.end());
    excess_ = std::max(excess_, excess);
  }
  void add_capsules(std::span<const Capsule> capsules) {
    capsules_.insert(capsules_.end(), capsules.begin(), capsules.end());
  }

  /// The spheres and capsules of the approximation come last.
  [[nodiscard]] ApproximatedObject finish(AttachedObject object) {
    result_.object = std::move(object);
    if (surface_.empty()) return std::move(result_);
    result_.spheres.insert(result_.spheres.end(), spheres_.begin(), spheres_.end());
    result_.capsules.insert(result_.capsules.end(), capsules_.begin(), capsules_.end());
    auto surface = std::make_shared<const Parts<Triangle>>(std::move(surface_));
    result_.approximation = {{{}, std::move(surface), 0},
                             static_cast<int>(spheres_.size()),
                             static_cast<int>(capsules_.size()),
                             excess_};
    return std::move(result_);
  }

 private:
  /// Coarsens until the number of spheres is allowed. `size` is half the longest extent.
  template <class Convex, class SpheresWithin>
  void add(const Convex& solid, double size, const SpheresWithin& spheres_within) {
    // Even a single row of the allowed number of spheres has at least this excess.
    double excess = std::max(settings_.excess, 0.25 * size / settings_.max_spheres);
    std::vector<Sphere> spheres = spheres_within(excess);
    while (std::ssize(spheres) > settings_.max_spheres) {
      excess *= kCoarser;
      spheres = spheres_within(excess);
    }
    for (Sphere& sphere : spheres) sphere.center = solid.pose * sphere.center;
    add(spheres, internal::triangulate(solid), excess);
  }

  const SphereSettings& settings_;
  ApproximatedObject result_;
  std::vector<Sphere> spheres_;
  std::vector<Capsule> capsules_;
  internal::TriangleMesh surface_;
  double excess_ = 0;  ///< metres that the spheres stick out at most
};

tl::unexpected<Error> refuse(const AttachedObject& object, std::string_view what,
                             ErrorCode code = ErrorCode::invalid) {
  return fail(code, "attached object '{}': {}", object.name, what);
}

}  // namespace

Result<ApproximatedObject> approximate_object(AttachedObject object,
                                              const SphereSettings& settings) {
  MNEME_TRY(internal::check_ranges(settings));
  if (object.shapes.empty() && object.meshes.empty()) return refuse(object, "it has no shapes");
  ObjectSpheres spheres(settings);
  bool has_mesh = !object.meshes.empty();
  for (const Shape& shape : object.shapes) {
    const Mesh* mesh = std::get_if<Mesh>(&shape);
    has_mesh = has_mesh || mesh != nullptr;
    if (internal::is_compound(shape) && (mesh == nullptr || mesh->radius > 0)) {
      return refuse(object, fmt::format("it has the shape {}; expected a sphere, box, cylinder, "
                                        "capsule, or mesh without a radius",
                                        shape_name(shape)));
    }
    if (const std::string_view flaw = internal::find_flaw(shape); !flaw.empty()) {
      return refuse(object, internal::said_of(shape, flaw));
    }
    std::visit(spheres, shape);
  }
  if (has_mesh) {
    const auto surface = internal::mesh_surface(object);
    if (!surface) return refuse(object, surface.error().message, surface.error().code);
    const internal::SphereCache cache(internal::cache_directory());
    const LinkSpheres made = internal::approximate_surface(*surface, settings, cache).spheres;
    spheres.add(made.spheres, *surface, made.max_excess);
    spheres.add_capsules(made.capsules);
  }
  return spheres.finish(std::move(object));
}

Result<Robot> attach(const Robot& robot, std::vector<AttachedObject> objects) {
  std::vector<ApproximatedObject> approximated;
  for (AttachedObject& object : objects) {
    internal::poll_interrupt();
    ApproximatedObject made = MNEME_TRY(approximate_object(std::move(object)));
    approximated.push_back(std::move(made));
  }
  return robot.with_attached(std::move(approximated));
}

}  // namespace mneme
