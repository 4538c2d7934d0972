// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/proven_motions.h"

#include <algorithm>
#include <list>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

namespace mneme::internal {
namespace {

constexpr std::size_t kMostCells = 32;
constexpr std::size_t kMostMotions = 1024;

/// Bytes of values, one after the other.
class Bytes {
 public:
  template <class Value>
  requires std::is_arithmetic_v<Value> || std::is_enum_v<Value>
  void add(Value value) { add(std::span<const Value>(&value, 1)); }
  template <class Value>
  void add(std::span<const Value> values) {
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  void add(const Vec3& v) { add(std::span<const double>(v.data(), 3)); }
  void add(const Transform& X) {
    add(std::span<const double>(X.rotation.data(), 9));
    add(X.translation);
  }
  void add(const std::vector<std::string>& names) {
    add(names.size());
    for (const std::string& name : names) {
      add(name.size());
      bytes_ += name;
    }
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// False for a shape of many parts.
struct AddShape {
  Bytes& bytes;

  bool operator()(const Sphere& sphere) const { return add(sphere.center, sphere.radius); }
  bool operator()(const Box& box) const { return add(box.pose, box.half_extents); }
  bool operator()(const Cylinder& c) const { return add(c.pose, c.radius, c.length); }
  bool operator()(const Capsule& c) const { return add(c.a, c.b, c.radius); }
  template <class Parts>
  bool operator()(const Parts&) const {
    return false;
  }

  template <class... Fields>
  bool add(const Fields&... fields) const {
    (bytes.add(fields), ...);
    return true;
  }
};

/// All that a proof depends on besides robot and motion; nothing if that is too much.
std::optional<std::string> describe_cell(const CollisionChecker& checker,
                                         Verification verification) {
  if (!checker.constraints().empty()) return std::nullopt;
  Bytes bytes;
  bytes.add(checker.resolution());
  bytes.add(checker.margin());
  bytes.add(checker.isa());
  bytes.add(verification);
  for (const Obstacle& obstacle : checker.scene().obstacles) {
    bytes.add(obstacle.shapes.size());
    for (const Shape& shape : obstacle.shapes) {
      bytes.add(shape.index());
      if (!std::visit(AddShape{bytes}, shape)) return std::nullopt;
    }
    bytes.add(obstacle.may_touch);
    bytes.add(obstacle.by_solid);
  }
  for (const auto& [first, second] : checker.scene().by_solid) {
    bytes.add(std::vector{first, second});
  }
  return bytes.take();
}

struct Cell {
  Robot robot;
  std::string description;
  std::shared_ptr<ProvenMotions> motions;
};

bool is_same(const Robot& a, const Robot& b) {
  const auto first = a.identity(), second = b.identity();
  return !first.owner_before(second) && !second.owner_before(first);
}

std::string bytes_of(std::span<const float> from, std::span<const float> to, MotionEnds ends) {
  Bytes bytes;
  bytes.add(from);
  bytes.add(to);
  bytes.add(ends.is_first);
  bytes.add(ends.is_last);
  return bytes.take();
}

}  // namespace

std::shared_ptr<ProvenMotions> ProvenMotions::of(const CollisionChecker& checker,
                                                 Verification verification) {
  static std::mutex mutex;
  static std::list<Cell> cells;  // that which was asked for last comes first
  auto description = describe_cell(checker, verification);
  if (!description) return nullptr;
  const std::lock_guard lock(mutex);
  const auto known = std::ranges::find_if(cells, [&](const Cell& cell) {
    return is_same(cell.robot, checker.robot()) && cell.description == *description;
  });
  if (known != cells.end()) {
    cells.splice(cells.begin(), cells, known);
  } else {
    cells.push_front({checker.robot(), *std::move(description), std::make_shared<ProvenMotions>()});
    if (cells.size() > kMostCells) cells.pop_back();
  }
  return cells.front().motions;
}

bool ProvenMotions::contain(std::span<const float> from, std::span<const float> to,
                            MotionEnds ends) const {
  const std::lock_guard lock(mutex_);
  return motions_.contains(bytes_of(from, to, ends));
}

void ProvenMotions::add(std::span<const float> from, std::span<const float> to, MotionEnds ends) {
  const std::lock_guard lock(mutex_);
  if (motions_.size() >= kMostMotions) motions_.clear();
  motions_.insert(bytes_of(from, to, ends));
}

}  // namespace mneme::internal
