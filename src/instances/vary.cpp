// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace mneme {
namespace {

std::vector<double> draw(const Spread& spread, Rng& rng) {
  std::vector<double> numbers;
  for (const double value : spread.values) {
    numbers.push_back(value * (spread.is_gaussian ? rng.normal() : rng.uniform(-1, 1)));
  }
  return numbers;
}

Vec3 draw_vector(const Spread& spread, Rng& rng) {
  const std::vector<double> numbers = draw(spread, rng);
  return numbers.size() == 3 ? Vec3(numbers[0], numbers[1], numbers[2]) : Vec3(Vec3::Zero());
}

/// How many numbers describe the size of a shape, and references to them.
std::vector<double*> sizes(Shape& shape) {
  if (auto* box = std::get_if<Box>(&shape)) {
    double* half = box->half_extents.data();
    return {half, half + 1, half + 2};
  }
  if (auto* cylinder = std::get_if<Cylinder>(&shape)) return {&cylinder->radius, &cylinder->length};
  if (auto* sphere = std::get_if<Sphere>(&shape)) return {&sphere->radius};
  return {&std::get<Capsule>(shape).radius};
}

/// A capsule's length is the distance of its ends: it grows at both.
void lengthen(Capsule& capsule, double length) {
  const Vec3 middle = 0.5 * (capsule.a + capsule.b);
  const Vec3 along = capsule.b - capsule.a;
  const Vec3 direction = along.norm() > 0 ? Vec3(along.normalized()) : Vec3(Vec3::UnitZ());
  capsule.a = middle - 0.5 * length * direction;
  capsule.b = middle + 0.5 * length * direction;
}

/// Adds `numbers` to the sizes of `shape`; false if one is not positive then.
bool resize(Shape& shape, const std::vector<double>& numbers) {
  const std::vector<double*> own = sizes(shape);
  const double share = std::holds_alternative<Box>(shape) ? 0.5 : 1.0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    *own[i] += share * numbers[i];
    if (*own[i] <= 0) return false;
  }
  if (auto* capsule = std::get_if<Capsule>(&shape)) {
    const double length = (capsule->b - capsule->a).norm() + numbers[1];
    if (length <= 0) return false;
    lengthen(*capsule, length);
  }
  return true;
}

std::size_t size_count(const Shape& shape) {
  Shape copy = shape;
  return std::holds_alternative<Capsule>(shape) ? 2 : sizes(copy).size();
}

Shape scaled(const Shape& shape, const Vec3& about, double factor) {
  Shape result = shape;
  for (double* size : sizes(result)) *size *= factor;
  const auto move = [&](Vec3& point) { point = about + factor * (point - about); };
  if (auto* box = std::get_if<Box>(&result)) move(box->pose.translation);
  if (auto* cylinder = std::get_if<Cylinder>(&result)) move(cylinder->pose.translation);
  if (auto* sphere = std::get_if<Sphere>(&result)) move(sphere->center);
  if (auto* capsule = std::get_if<Capsule>(&result)) {
    move(capsule->a);
    move(capsule->b);
  }
  return result;
}

constexpr int kMostTries = 1000;

Result<void> check_counts(const Variation& variation) {
  struct Wanted {
    std::string_view what;
    const Spread& spread;
    std::size_t count;
  };
  for (const auto& [what, spread, count] :
       {Wanted{"position", variation.position, 3}, Wanted{"rpy", variation.rpy, 3},
        Wanted{"scale", variation.scale, 1}}) {
    if (spread.values.empty() || spread.values.size() == count) continue;
    return fail(ErrorCode::invalid, fmt::format("its {} has {} numbers; expected {}", what,
                                                spread.values.size(), count));
  }
  return {};
}

Result<double> draw_factor(const Variation& variation, Rng& rng) {
  if (variation.scale.values.empty()) return 1.0;
  for (int i = 0; i < kMostTries; ++i) {
    const double factor = 1 + draw(variation.scale, rng).front();
    if (factor > 0) return factor;
  }
  return fail(ErrorCode::invalid, "its scale leaves no positive factor");
}

/// Turns, scales and shifts everything about one point.
class Motion {
 public:
  static Result<Motion> draw(const Variation& variation, const Vec3& center, Rng& rng) {
    if (auto checked = check_counts(variation); !checked) return tl::unexpected(checked.error());
    const Result<double> factor = draw_factor(variation, rng);
    if (!factor) return tl::unexpected(factor.error());
    Motion motion;
    motion.center_ = center;
    motion.factor_ = *factor;
    const Eigen::Matrix3d rotation = rotation_from_rpy(draw_vector(variation.rpy, rng));
    const Vec3 shift = draw_vector(variation.position, rng);
    motion.X_ = {rotation, center - rotation * center + shift};
    return motion;
  }

  void apply(Obstacle& obstacle) const {
    for (Shape& shape : obstacle.shapes) {
      if (factor_ != 1) shape = scaled(shape, center_, factor_);
      shape = transformed(X_, shape);
    }
  }

 private:
  Vec3 center_ = Vec3::Zero();
  double factor_ = 1;
  Transform X_;
};

/// The middle of a box around the bounding spheres: that of the shape itself if there is one.
Vec3 middle(const Obstacle& obstacle) {
  Vec3 least = Vec3::Constant(1e300), most = -least;
  for (const Shape& shape : obstacle.shapes) {
    const Sphere around = bounding_sphere(shape);
    least = least.cwiseMin(around.center - Vec3::Constant(around.radius));
    most = most.cwiseMax(around.center + Vec3::Constant(around.radius));
  }
  return 0.5 * (least + most);
}

Result<void> vary_size(const Variation& variation, Rng& rng, Obstacle& obstacle) {
  if (variation.size.values.empty()) return {};
  if (obstacle.shapes.size() != 1) {
    return fail(ErrorCode::invalid,
                fmt::format("it has {} shapes; expected one, or 'scale' instead of 'size'",
                            obstacle.shapes.size()));
  }
  const Shape nominal = obstacle.shapes.front();
  if (variation.size.values.size() != size_count(nominal)) {
    return fail(ErrorCode::invalid, fmt::format("its size has {} numbers; expected {} for a {}",
                                                variation.size.values.size(), size_count(nominal),
                                                shape_name(nominal)));
  }
  for (int i = 0; i < kMostTries; ++i) {
    obstacle.shapes.front() = nominal;
    if (resize(obstacle.shapes.front(), draw(variation.size, rng))) return {};
  }
  return fail(ErrorCode::invalid, "its size leaves no positive one");
}

Result<void> vary_obstacle(const Variation& variation, Rng& rng, Obstacle& obstacle) {
  if (auto sized = vary_size(variation, rng, obstacle); !sized) return sized;
  const Result<Motion> motion = Motion::draw(variation, middle(obstacle), rng);
  if (!motion) return tl::unexpected(motion.error());
  motion->apply(obstacle);
  return {};
}

/// True if `name` is `pattern`, whose stars stand for any characters.
bool is_like(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return name == pattern;
  if (!name.starts_with(pattern.substr(0, star))) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t from = star; from <= name.size(); ++from) {
    if (is_like(name.substr(from), rest)) return true;
  }
  return false;
}

/// Per obstacle the index of its variation, or -1.
Result<std::vector<int>> assign(const Scene& scene, const Variations& variations) {
  std::vector<int> assigned(scene.obstacles.size(), -1);
  for (std::size_t i = 0; i < variations.obstacles.size(); ++i) {
    const Variation& variation = variations.obstacles[i];
    bool is_used = false;
    for (std::size_t j = 0; j < assigned.size(); ++j) {
      if (!is_like(scene.obstacles[j].name, variation.name)) continue;
      is_used = true;
      if (assigned[j] >= 0) {
        return fail(ErrorCode::invalid,
                    fmt::format("obstacle '{}' is meant by the variations '{}' and '{}'",
                                scene.obstacles[j].name,
                                variations.obstacles[static_cast<std::size_t>(assigned[j])].name,
                                variation.name));
      }
      assigned[j] = static_cast<int>(i);
    }
    if (!is_used) {
      return fail(ErrorCode::invalid,
                  fmt::format("the scene '{}' has no obstacle '{}', which varies", scene.name,
                              variation.name));
    }
  }
  return assigned;
}

}  // namespace

Result<Scene> vary(const Scene& scene, const Variations& variations, Rng& rng) {
  const auto assigned = assign(scene, variations);
  if (!assigned) return tl::unexpected(assigned.error());
  Scene varied = scene;
  for (std::size_t i = 0; i < varied.obstacles.size(); ++i) {
    if ((*assigned)[i] < 0) continue;
    Obstacle& obstacle = varied.obstacles[i];
    const auto done = vary_obstacle(variations.obstacles[static_cast<std::size_t>((*assigned)[i])],
                                    rng, obstacle);
    if (!done) {
      return fail(done.error().code,
                  fmt::format("obstacle '{}': {}", obstacle.name, done.error().message));
    }
  }
  if (!variations.scene.size.values.empty()) {
    return fail(ErrorCode::invalid, "the whole scene has a size, which only obstacles have");
  }
  const Result<Motion> motion = Motion::draw(variations.scene, variations.scene.center, rng);
  if (!motion) return fail(motion.error().code, "the whole scene: " + motion.error().message);
  for (Obstacle& obstacle : varied.obstacles) motion->apply(obstacle);
  return varied;
}

}  // namespace mneme
