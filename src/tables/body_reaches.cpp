// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "base/lengths.h"
#include "tables/make_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mneme::internal {
namespace {

/// Larger than the rounding errors of single precision.
constexpr float kRounding = 1 + 1e-5f;

/// Displacement bounds on one motion.
class Reach {
 public:
  Reach(const RobotTables& tables, std::span<const float> from, std::span<const float> to)
      : tables_(tables), from_(from), to_(to) {}

  /// Adds the bounds for each joint between a body and the frame `ancestor` to `row`.
  void add(const BodyRow& body, int ancestor, float* row) const {
    const float* center = body.ball.center;
    // The farthest of the body's points from the frame's axis, and from its origin.
    float from_axis = length_of(center[0], center[1]) + body.ball.radius;
    float from_origin = length_of(center[0], center[1], center[2]) + body.ball.radius;
    for (int frame = body.frame; frame != ancestor;) {
      const FrameRow& joint = tables_.frames[as_index(frame - 1)];
      const float reach = joint.is_prismatic ? 1 : from_axis;
      row[joint.joint] += kRounding * std::abs(joint.multiplier) * reach;
      from_origin += travel_of(joint);
      const float* t = joint.translation;
      from_axis = length_of(t[0], t[1]) + from_origin;
      from_origin += length_of(t[0], t[1], t[2]);
      frame = joint.parent;
    }
  }

 private:
  /// The largest offset of a prismatic frame, metres.
  [[nodiscard]] float travel_of(const FrameRow& row) const {
    if (!row.is_prismatic) return 0;
    const auto value = [&](std::span<const float> q) {
      return std::abs(row.multiplier * q[as_index(row.joint)] + row.offset);
    };
    return std::max(value(from_), value(to_));
  }

  const RobotTables& tables_;
  std::span<const float> from_, to_;
};

/// Displacement bounds of a motion, one per row of `reaches`.
std::vector<float> displacements_of(std::span<const float> reaches, std::span<const float> delta) {
  std::vector<float> moved(reaches.size() / delta.size(), 0.0f);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const float* row = reaches.data() + i * delta.size();
    for (std::size_t j = 0; j < delta.size(); ++j) moved[i] += row[j] * std::abs(delta[j]);
  }
  return moved;
}

float largest(std::span<const float> values) {
  return values.empty() ? 0.0f : *std::ranges::max_element(values);
}

Displacements displacements_with(const Reaches& reaches, std::span<const float> delta) {
  Displacements moved{displacements_of(reaches.bodies, delta),
                      displacements_of(reaches.pairs, delta)};
  moved.longest_of_bodies = largest(moved.bodies);
  moved.longest = std::max(moved.longest_of_bodies, largest(moved.pairs));
  moved.farthest_reach = largest(reaches.bodies);
  return moved;
}

/// A ball that contains a body in every configuration.
struct ReachedBall {
  const FrameRow* base = nullptr;  ///< the frame at the ball's centre, a child of the root
  float radius = 0;                ///< infinite if a prismatic joint moves the body
};

ReachedBall reached_ball(const RobotTables& tables, const BodyRow& body) {
  const auto norm = [](const float* v) { return length_of(v[0], v[1], v[2]); };
  ReachedBall ball{nullptr, norm(body.ball.center) + body.ball.radius};
  for (int frame = body.frame; frame > 0; frame = ball.base->parent) {
    if (ball.base != nullptr) ball.radius += norm(ball.base->translation);
    ball.base = &tables.frames[as_index(frame - 1)];
    if (ball.base->is_prismatic) ball.radius = std::numeric_limits<float>::infinity();
  }
  return ball;
}

int common_ancestor(const RobotTables& tables, int a, int b) {
  while (a != b) {
    int& lower = a > b ? a : b;
    lower = tables.frames[as_index(lower - 1)].parent;
  }
  return a;
}

/// Displacement bounds on the straight motion between two configurations. The radius of a turn is
/// at most the length of the links and slides between joint and point.
Reaches find_reaches(const RobotTables& tables, std::span<const float> from,
                     std::span<const float> to) {
  const Reach reach(tables, from, to);
  const auto joints = as_index(tables.joint_count);
  Reaches result;
  result.bodies.assign(as_index(tables.moving_count) * joints, 0.0f);
  for (std::size_t i = 0; i < as_index(tables.moving_count); ++i) {
    reach.add(tables.bodies[i], 0, result.bodies.data() + i * joints);
  }
  result.pairs.assign(tables.body_pairs.size() * joints, 0.0f);
  for (std::size_t i = 0; i < tables.body_pairs.size(); ++i) {
    const BodyPairRow& pair = tables.body_pairs[i];
    float* row = result.pairs.data() + i * joints;
    reach.add(tables.bodies[as_index(pair.first)], pair.ancestor, row);
    reach.add(tables.bodies[as_index(pair.second)], pair.ancestor, row);
  }
  return result;
}

}  // namespace

std::vector<float> find_clearances(const RobotTables& robot, const SceneTables& scene) {
  constexpr float kSlack = 1e-4f;  // metres, for rounding
  std::vector<float> clearances;
  for (int i = 0; i < robot.moving_count; ++i) {
    const ReachedBall ball = reached_ball(robot, robot.bodies[as_index(i)]);
    float nearest = std::numeric_limits<float>::max();
    for (std::size_t k = 0; k < scene.obstacles.size(); ++k) {
      float squares = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        float center = 0;
        for (std::size_t j = 0; j < 3; ++j) {
          center += scene.rotation[3 * axis + j] * ball.base->translation[j];
        }
        const float beyond =
            std::max({scene.lower[axis][k] - center, center - scene.upper[axis][k], 0.0f});
        squares += beyond * beyond;
      }
      nearest = std::min(nearest, std::sqrt(squares));
    }
    clearances.push_back(nearest - ball.radius * kRounding - kSlack);
  }
  return clearances;
}

void Displacements::include(const Displacements& other) {
  const auto take_larger = [](std::vector<float>& values, const std::vector<float>& others) {
    values.resize(others.size());
    std::ranges::transform(values, others, values.begin(), std::ranges::max);
  };
  take_larger(bodies, other.bodies);
  take_larger(pairs, other.pairs);
  longest_of_bodies = std::max(longest_of_bodies, other.longest_of_bodies);
  longest = std::max(longest, other.longest);
  farthest_reach = std::max(farthest_reach, other.farthest_reach);
}

Displacements find_displacements(const RobotTables& tables, std::span<const float> from,
                                 std::span<const float> to, std::span<const float> delta) {
  return tables.has_far_slides ? displacements_with(find_reaches(tables, from, to), delta)
                               : displacements_with(tables.reaches, delta);
}

void add_reaches(RobotTables& tables) {
  for (BodyPairRow& pair : tables.body_pairs) {
    pair.ancestor = common_ancestor(tables, tables.bodies[as_index(pair.first)].frame,
                                    tables.bodies[as_index(pair.second)].frame);
  }
  const std::vector<float> zero(as_index(tables.joint_count), 0.0f);
  tables.reaches = find_reaches(tables, zero, zero);
  const auto turns_below = [&](const FrameRow& row) {
    for (int frame = row.parent; frame > 0; frame = tables.frames[as_index(frame - 1)].parent) {
      if (!tables.frames[as_index(frame - 1)].is_prismatic) return true;
    }
    return false;
  };
  tables.has_far_slides = std::ranges::any_of(
      tables.frames, [&](const FrameRow& row) { return row.is_prismatic && turns_below(row); });
}

}  // namespace mneme::internal
