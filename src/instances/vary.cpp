// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/instances.h"

#include "base/as_index.h"
#include "base/fail.h"
#include "base/files.h"
#include "geometry/solids.h"
#include "input/input.h"
#include "scene/scene_input.h"

#include <algorithm>
#include <optional>

namespace mneme {
namespace {

using internal::Input;

/// Reads `{uniform: NUMBERS}` or `{gaussian: NUMBERS}`, with a list or a single number.
Spread read_spread(const Input& input) {
  input.allow_keys({"uniform", "gaussian"});
  const auto uniform = input.find("uniform");
  const auto gaussian = input.find("gaussian");
  if (uniform.has_value() == gaussian.has_value()) input.fail_expecting("uniform or gaussian");
  const Input& numbers = uniform ? *uniform : *gaussian;
  Spread spread;
  spread.is_gaussian = gaussian.has_value();
  if (!numbers.is_list()) {
    spread.values = {numbers.finite_number()};
  } else {
    for (const Input& item : numbers.items()) spread.values.push_back(item.finite_number());
  }
  for (const double value : spread.values) {
    if (value < 0) numbers.fail_expecting("numbers of at least 0");
  }
  return spread;
}

void read_into(const Input& input, std::string_view key, std::size_t least, std::size_t most,
               Spread& spread) {
  const auto found = input.find(key);
  if (!found) return;
  spread = read_spread(*found);
  if (spread.values.size() >= least && spread.values.size() <= most) return;
  found->fail_expecting(least == most
                            ? std::to_string(least) + (least == 1 ? " number" : " numbers")
                            : std::to_string(least) + " to " + std::to_string(most) + " numbers");
}

void read_motion(const Input& input, Variation& variation) {
  read_into(input, "position", 3, 3, variation.position);
  read_into(input.taking_angles(), "rpy", 3, 3, variation.rpy);
  read_into(input, "scale", 1, 1, variation.scale);
}

Variation read_scene_variation(const Input& input) {
  input.allow_keys({"position", "rpy", "scale", "center"});
  Variation variation;
  read_motion(input, variation);
  if (const auto center = input.find("center")) variation.center = internal::read_point(*center);
  return variation;
}

Variation read_obstacle_variation(const std::string& name, const Input& input) {
  input.allow_keys({"position", "rpy", "scale", "size"});
  Variation variation;
  variation.name = name;
  read_motion(input, variation);
  read_into(input, "size", 1, 3, variation.size);
  return variation;
}

Variations read_variations(const Input& input) {
  input.allow_keys({"scene", "obstacles"});
  Variations variations;
  if (const auto scene = input.find("scene")) variations.scene = read_scene_variation(*scene);
  if (const auto obstacles = input.find("obstacles")) {
    for (const auto& [name, obstacle] : obstacles->entries()) {
      variations.obstacles.push_back(read_obstacle_variation(name, obstacle));
    }
  }
  return variations;
}

}  // namespace

Result<Variations> load_variations(const std::string& path) {
  return internal::without_throwing([&] {
    const std::string text = internal::value_or_throw(internal::read_text_file(path));
    const internal::InputValue value = internal::parse_yaml(text, path);
    return read_variations(Input(value, path));
  });
}

namespace {

std::vector<double> sample(const Spread& spread, Rng& rng) {
  std::vector<double> numbers;
  for (const double value : spread.values) {
    numbers.push_back(value * (spread.is_gaussian ? rng.normal() : rng.uniform(-1, 1)));
  }
  return numbers;
}

Vec3 sample_vector(const Spread& spread, Rng& rng) {
  const std::vector<double> numbers = sample(spread, rng);
  return numbers.size() == 3 ? Vec3(numbers[0], numbers[1], numbers[2]) : Vec3(Vec3::Zero());
}

/// `shape` with `numbers` added to its sizes; nothing if a size is not positive.
std::optional<Shape> grown(const Shape& shape, const std::vector<double>& numbers) {
  std::vector<double> sizes = internal::sizes_of(shape);
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] += numbers[i];
  const bool is_positive = std::ranges::all_of(sizes, [](double size) { return size > 0; });
  return is_positive ? std::optional(internal::resized(shape, sizes)) : std::nullopt;
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
    return fail(ErrorCode::invalid, "its {} has {} numbers; expected {}", what,
                spread.values.size(), count);
  }
  return {};
}

Result<double> sample_factor(const Variation& variation, Rng& rng) {
  if (variation.scale.values.empty()) return 1.0;
  for (int i = 0; i < kMostTries; ++i) {
    const double factor = 1 + sample(variation.scale, rng).front();
    if (factor > 0) return factor;
  }
  return fail(ErrorCode::invalid, "its scale leaves no positive factor; expected a smaller spread");
}

/// A random rotation, scaling and translation about one point.
class Motion {
 public:
  static Result<Motion> sample(const Variation& variation, const Vec3& center, Rng& rng) {
    MNEME_TRY(check_counts(variation));
    const double factor = MNEME_TRY(sample_factor(variation, rng));
    Motion motion;
    motion.center_ = center;
    motion.factor_ = factor;
    const Eigen::Matrix3d rotation = rotation_from_rpy(sample_vector(variation.rpy, rng));
    const Vec3 shift = sample_vector(variation.position, rng);
    motion.X_ = {rotation, center - rotation * center + shift};
    return motion;
  }

  void apply(Obstacle& obstacle) const {
    for (Shape& shape : obstacle.shapes) {
      if (factor_ != 1) shape = internal::scaled(shape, center_, factor_);
      shape = transformed(X_, shape);
    }
  }

 private:
  Vec3 center_ = Vec3::Zero();
  double factor_ = 1;
  Transform X_;
};

/// The middle of a box around the bounding spheres of all shapes.
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
    return fail(ErrorCode::invalid, "it has {} shapes; expected one, or 'scale' instead of 'size'",
                obstacle.shapes.size());
  }
  const Shape nominal = obstacle.shapes.front();
  const std::size_t count = internal::sizes_of(nominal).size();
  if (variation.size.values.size() != count) {
    return fail(ErrorCode::invalid, "its size has {} numbers; expected {} for a {}",
                variation.size.values.size(), count, shape_name(nominal));
  }
  for (int i = 0; i < kMostTries; ++i) {
    if (const auto shape = grown(nominal, sample(variation.size, rng))) {
      obstacle.shapes.front() = *shape;
      return {};
    }
  }
  return fail(ErrorCode::invalid, "its size leaves no positive size; expected a smaller spread");
}

Result<void> vary_obstacle(const Variation& variation, Rng& rng, Obstacle& obstacle) {
  MNEME_TRY(vary_size(variation, rng, obstacle));
  const Motion motion = MNEME_TRY(Motion::sample(variation, middle(obstacle), rng));
  motion.apply(obstacle);
  return {};
}

/// True if `name` matches `pattern`, in which `*` stands for any characters.
bool matches(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return name == pattern;
  if (!name.starts_with(pattern.substr(0, star))) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t from = star; from <= name.size(); ++from) {
    if (matches(name.substr(from), rest)) return true;
  }
  return false;
}

/// The index of each obstacle's variation, or -1.
Result<std::vector<int>> assign(const Scene& scene, const Variations& variations) {
  std::vector<int> assigned(scene.obstacles.size(), -1);
  for (std::size_t i = 0; i < variations.obstacles.size(); ++i) {
    const Variation& variation = variations.obstacles[i];
    bool is_used = false;
    for (std::size_t j = 0; j < assigned.size(); ++j) {
      if (!matches(scene.obstacles[j].name, variation.name)) continue;
      is_used = true;
      if (assigned[j] >= 0) {
        return fail(ErrorCode::invalid,
                    "obstacle '{}' matches two variations, '{}' and '{}'; expected at most one",
                    scene.obstacles[j].name,
                    variations.obstacles[internal::as_index(assigned[j])].name, variation.name);
      }
      assigned[j] = static_cast<int>(i);
    }
    if (!is_used) {
      return fail(ErrorCode::invalid,
                  "the scene '{}' has no obstacle '{}', which a variation names", scene.name,
                  variation.name);
    }
  }
  return assigned;
}

}  // namespace

Result<Scene> vary(const Scene& scene, const Variations& variations, Rng& rng) {
  const auto assigned = MNEME_TRY(assign(scene, variations));
  Scene varied = scene;
  for (std::size_t i = 0; i < varied.obstacles.size(); ++i) {
    if (assigned[i] < 0) continue;
    Obstacle& obstacle = varied.obstacles[i];
    MNEME_TRY(vary_obstacle(variations.obstacles[internal::as_index(assigned[i])], rng, obstacle)
                  .map_error(internal::naming(fmt::format("obstacle '{}'", obstacle.name))));
  }
  if (!variations.scene.size.values.empty()) {
    return fail(ErrorCode::invalid, "the whole scene: it has a 'size'; expected 'scale'");
  }
  const Motion motion = MNEME_TRY(Motion::sample(variations.scene, variations.scene.center, rng)
                                      .map_error(internal::naming("the whole scene")));
  for (Obstacle& obstacle : varied.obstacles) motion.apply(obstacle);
  return varied;
}

}  // namespace mneme
