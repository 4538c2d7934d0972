// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "base/fail.h"
#include "base/files.h"
#include "cell/cell_data.h"
#include "problem/problem_input.h"
#include "scene/scene_input.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <string_view>

namespace mneme {
namespace {

using internal::as_index;
using internal::Input;

constexpr const char* kFirstStart = "start";

void read_extents(const Input& input, CellRegion& region) {
  double largest = 0;
  for (std::size_t k = 0; k < kTaskSize; ++k) {
    const auto extent = input.find_value(kTaskNames[k]);
    if (!extent) continue;
    const bool is_turn = k == as_index(internal::kYaw);
    region.half_extents[k] = extent->taking_angles(is_turn).finite_number();
    if (region.half_extents[k] < 0 || (is_turn && region.half_extents[k] > std::numbers::pi)) {
      extent->fail_expecting(is_turn ? "half of an angle, 0 to pi radians"
                                     : "half of an extent, metres");
    }
    largest = std::max(largest, region.half_extents[k]);
  }
  if (largest == 0) input.fail_expecting("a positive extent x, y, z or yaw");
}

void read_starts(const Input& input, CellRegion& region) {
  const auto starts = input.find_value("starts");
  if (!starts) return;
  for (const auto& [name, value] : starts->entries()) {
    if (name.empty()) value.fail(ErrorCode::invalid, "expected a name for this start, got \"\"");
    if (std::ranges::find(region.starts, name, &CellStart::name) != region.starts.end()) {
      value.fail(ErrorCode::invalid,
                 "expected another name: \"{}\" is a start of this region already{}", name,
                 name == kFirstStart ? ", the problem's" : "");
    }
    region.starts.push_back({name, internal::read_configuration(value, region.problem.robot)});
  }
}

void read_region(const Input& file, CellRegion& region) {
  const Input input = file.at("region");
  input.allow_keys({"x", "y", "z", "yaw", "heading", "pivot", "starts"});
  read_extents(input, region);
  const auto heading = input.taking_angles().find_value("heading");
  region.axes = internal::read_frame(file, region.problem.robot).rotation *
                rotation_about(Vec3::UnitZ(), heading ? heading->finite_number() : 0);
  if (const auto pivot = input.find_value("pivot")) region.pivot = internal::read_point(*pivot);
  region.starts.push_back({kFirstStart, region.problem.start});
  read_starts(input, region);
}

/// Collects bytes to hash.
class Digest {
 public:
  void add(std::string_view text) {
    add(static_cast<std::uint64_t>(text.size()));
    bytes_.append(text);
  }
  void add(std::uint64_t word) {
    for (int shift = 0; shift < 64; shift += 8) bytes_.push_back(static_cast<char>(word >> shift));
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value)); }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) add(double{matrix(i)});
  }
  void add(const Transform& pose) {
    add(pose.rotation);
    add(pose.translation);
  }
  template <class Item>
  void add(const std::vector<Item>& items) {
    add(static_cast<std::uint64_t>(items.size()));
    for (const Item& item : items) add(item);
  }
  void add(const Sphere& s) {
    add(s.center);
    add(s.radius);
  }
  void add(const Capsule& c) {
    add(c.a);
    add(c.b);
    add(c.radius);
  }
  void add(const Box& b) {
    add(b.pose);
    add(b.half_extents);
  }
  void add(const Cylinder& c) {
    add(c.pose);
    add(c.radius);
    add(c.length);
  }
  void add(const CloudPoint& p) {
    for (const float value : p) add(double{value});
  }
  void add(const Triangle& t) {
    add(t.a);
    add(t.b);
    add(t.c);
  }
  void add(const Cube& c) {
    add(c.center);
    add(c.half_extent);
  }
  template <class Part>
  void add(const CompoundShape<Part>& shape) {
    add(shape.pose);
    add(shape.radius);
    add(shape.parts->list());
  }
  void add(const Shape& shape) {
    add(static_cast<std::uint64_t>(shape.index()));
    std::visit([this](const auto& alternative) { add(alternative); }, shape);
  }
  void add(const std::string& text) { add(std::string_view(text)); }
  void add(const Obstacle& obstacle) {
    add(obstacle.shapes);
    add(obstacle.may_touch);
  }
  void add(const ApproximatedObject& object) {
    add(object.object.link);
    add(object.spheres);
    add(object.capsules);
    add(object.object.may_touch);
  }

  [[nodiscard]] std::string text() const {
    return fmt::format("{:016x}", XXH3_64bits(bytes_.data(), bytes_.size()));
  }

 private:
  std::string bytes_;
};

}  // namespace

namespace internal {

WorldHash hash_world(const Problem& problem) {
  Digest robot;
  robot.add(problem.robot.hash());
  const auto attached = problem.robot.attached();
  robot.add(std::vector<ApproximatedObject>(attached.begin(), attached.end()));
  WorldHash hash{robot.text(), {}};
  for (const Obstacle& obstacle : problem.scene.obstacles) {
    Digest digest;
    digest.add(obstacle);
    hash.obstacles.push_back(digest.text());
  }
  return hash;
}

std::string hash_tasks(const CellRegion& region) {
  Digest digest;
  digest.add(region.middle().link);
  digest.add(region.middle().pose);
  digest.add(region.axes);
  digest.add(region.pivot);
  for (const double extent : region.half_extents) digest.add(extent);
  for (const CellStart& start : region.starts) {
    digest.add(start.name);
    digest.add(start.q);
  }
  return digest.text();
}

namespace {

/// Refuses what motions of a cell cannot have at their ends.
Result<void> check_ends(const Problem& problem) {
  if (problem.is_moving()) {
    return fail(ErrorCode::unsupported,
                "{}: motions of a cell begin and end at rest; remove the key, or plan these tasks",
                problem.start_velocity.empty() ? "end_velocity" : "start_velocity");
  }
  if (!problem.scene.end_contacts.empty()) {
    const EndContact& contact = problem.scene.end_contacts.front();
    return fail(ErrorCode::unsupported,
                "allow: {} and {} may touch at the ends only (at_ends), which a cell cannot prove; "
                "allow the pair throughout, [{}, {}], or plan these tasks",
                contact.first, contact.second, contact.first, contact.second);
  }
  return {};
}

Result<void> check_exact(const CellRegion& region) {
  const Robot& robot = region.problem.robot;
  if (!robot.exact_pairs().empty()) {
    const auto [first, second] = robot.exact_pairs().front();
    return fail(ErrorCode::unsupported,
                "links {} and {} are checked by exact geometry, which a cell cannot prove; allow "
                "the pair, or give the robot spheres that keep apart",
                robot.links()[as_index(first)].name, robot.links()[as_index(second)].name);
  }
  for (const Obstacle& obstacle : region.problem.scene.obstacles) {
    if (obstacle.exact_links.empty()) continue;
    return fail(ErrorCode::unsupported,
                "obstacle {} and link {} are checked by exact geometry, which a cell cannot prove",
                obstacle.name, obstacle.exact_links.front());
  }
  return {};
}

}  // namespace

Result<void> check_region(const CellRegion& region) {
  const Problem& problem = region.problem;
  if (!problem.constraints.empty()) {
    return fail(ErrorCode::unsupported,
                "a constraint on link {}: a cell proves motions without cones only; remove the "
                "constraint, or plan these tasks",
                problem.constraints.front().link);
  }
  MNEME_TRY(check_ends(problem));
  MNEME_TRY(check_exact(region));
  if (problem.pose_goals.size() != 1 || !problem.goals.empty()) {
    return fail(ErrorCode::invalid, "expected one pose of a link as goal, the region's middle");
  }
  const PoseGoal& middle = region.middle();
  if (!middle.position_tolerance.isZero() || middle.cone > 0 || middle.turn > 0) {
    return fail(ErrorCode::invalid,
                "expected a pose of link {} with quat_xyzw and without tolerances, the region's "
                "middle",
                middle.link);
  }
  for (const CellStart& start : region.starts) {
    if (const auto fault = problem.robot.describe_violation(start.q, "start " + start.name)) {
      return fail(ErrorCode::invalid, *fault);
    }
  }
  return {};
}

}  // namespace internal

Result<CellRegion> load_region(const std::string& path, const ProblemOptions& options) {
  CellRegion region{MNEME_TRY(load_problem(path, options)), {}, {}, {}, {}, path};
  const std::string text = MNEME_TRY(internal::read_text_file(path));
  MNEME_TRY(internal::without_throwing([&] {
    const internal::InputValue value = internal::parse_yaml(text, path);
    read_region(Input(value, path), region);
  }));
  MNEME_TRY(internal::check_region(region).map_error(internal::naming(path)));
  return region;
}

std::string to_yaml(const CellRegion& region, const std::string& robot) {
  std::string text = to_yaml(region.problem, robot) + "region:\n";
  for (std::size_t k = 0; k < kTaskSize; ++k) {
    if (region.half_extents[k] == 0) continue;
    text += fmt::format("  {}: {}\n", kTaskNames[k], internal::yaml_number(region.half_extents[k]));
  }
  const double heading = std::atan2(region.axes(1, 0), region.axes(0, 0));
  const Vec3& p = region.pivot;
  text += fmt::format("  heading: {}\n  pivot: [{}, {}, {}]\n", internal::yaml_number(heading),
                      internal::yaml_number(p[0]), internal::yaml_number(p[1]),
                      internal::yaml_number(p[2]));
  if (region.starts.size() > 1) text += "  starts:\n";
  for (std::size_t i = 1; i < region.starts.size(); ++i) {
    text += fmt::format("    {}: {}\n", internal::yaml_string(region.starts[i].name),
                        internal::yaml_flow(nlohmann::ordered_json(region.starts[i].q)));
  }
  return text;
}

}  // namespace mneme
