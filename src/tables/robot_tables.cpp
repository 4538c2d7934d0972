// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/as_index.h"
#include "tables/joint_reach.h"
#include "tables/make_tables.h"
#include "tables/merge_bodies.h"
#include "geometry/axis_box.h"
#include "tables/shape_groups.h"
#include "robot/kinematics.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

namespace mneme::internal {
namespace {

/// Metres; larger than the kernels' rounding where they turn a body's frame into another.
constexpr double kBoxRounding = 2e-5;

Ball to_ball(const Sphere& sphere) {
  Ball ball;
  store(sphere.center, ball.center);
  // Rounding to float must not shrink the bound.
  ball.radius = static_cast<float>(sphere.radius * (1 + 1e-6) + 1e-6);
  return ball;
}

std::vector<Sphere> to_spheres(std::span<const Ball> balls) {
  std::vector<Sphere> spheres;
  for (const Ball& ball : balls) {
    spheres.push_back({Vec3(ball.center[0], ball.center[1], ball.center[2]), ball.radius});
  }
  return spheres;
}

/// Returns a rotation of the z axis to the unit vector `axis`, or to its opposite, which sets
/// `is_reversed`. For coordinate axes it is a permutation without change of sign.
Eigen::Matrix3d rotation_to_axis(const Vec3& axis, bool& is_reversed) {
  constexpr double kLeastLean = 1e-9;
  is_reversed = false;
  for (int i = 0; i < 3; ++i) {
    const Vec3 lean = axis - axis[i] * Vec3::Unit(i);
    if (!(lean.cwiseAbs().maxCoeff() < kLeastLean)) continue;
    is_reversed = axis[i] < 0;
    Eigen::Matrix3d cyclic = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k) cyclic((i + 1 + k) % 3, k) = 1;
    return cyclic;
  }
  return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix();
}

void store_turn(const Eigen::Matrix3d& rotation, FrameRow& row) {
  const Eigen::Matrix3d rounded = rotation.array().round();
  store(rotation, row.rotation);
  // Files write right angles with as few as nine digits; floats have seven.
  if (!rotation.isApprox(rounded, 1e-8)) {
    row.turn = Turn::general;
    return;
  }
  row.turn = rounded.isIdentity() ? Turn::none : Turn::permutation;
  for (int i = 0; i < 3; ++i) {
    Eigen::Index source = 0;
    rounded.col(i).cwiseAbs().maxCoeff(&source);
    row.source[i] = static_cast<int>(source);
    row.is_reversed[i] = rounded(source, i) < 0;
  }
}

class RobotTablesBuilder {
 public:
  explicit RobotTablesBuilder(const Robot& robot)
      : robot_(robot), placements_(robot.links().size()), groups_of_link_(robot.links().size()) {
    tables_.joint_count = robot.joint_count();
  }

  Result<RobotTables> build() {
    const std::set<std::pair<int, int>> exact(robot_.exact_pairs().begin(),
                                              robot_.exact_pairs().end());
    std::vector<std::pair<int, int>> pairs;
    std::ranges::copy_if(robot_.self_pairs(), std::back_inserter(pairs),
                         [&](const auto& pair) { return !exact.contains(pair); });
    MNEME_TRY(add_bodies_and(pairs));
    add_limbs();
    add_reaches(tables_);
    add_separation_tables(robot_, tables_);
    return std::move(tables_);
  }

  /// Without limbs and separation tables.
  Result<RobotTables> build_of_exact_pairs() {
    MNEME_TRY(add_bodies_and(robot_.exact_pairs()));
    return std::move(tables_);
  }

  /// Adds attached objects to the tables of the bare robot.
  RobotTables build_on(const RobotTables& bare) {
    place_links();
    tables_ = bare;
    tables_.links.clear();
    add_links();
    find_bare_links();
    const std::size_t bare_pairs = robot_.without_attached().self_pairs().size();
    for (const Body& body : attached_bodies(as_index(kMaxBodies) - bare.bodies.size())) {
      add_body(body);
      if (body.frame > 0) move_last_body_to_front();
    }
    // Finding out which groups never meet would take longer than all the rest.
    add_pairs(robot_.self_pairs().subspan(bare_pairs),
              [](int, int) { return [](int, int) { return true; }; });
    add_reaches(tables_);
    return std::move(tables_);
  }

 private:
  Result<void> add_bodies_and(std::span<const std::pair<int, int>> pairs) {
    place_links();
    if (tables_.frames.size() > as_index(kMaxFrames)) {
      return fail(ErrorCode::unsupported, "robot '" + robot_.name() + "' has more than " +
                                              std::to_string(kMaxFrames) + " joints that move");
    }
    add_links();
    add_bodies();
    add_pairs(pairs, [this](int link_a, int link_b) {
      const Linkage linkage(robot_, tables_, placements_[as_index(link_a)].frame,
                            placements_[as_index(link_b)].frame);
      return [this, linkage](int a, int b) { return can_groups_meet(linkage, a, b); };
    });
    return {};
  }

  /// The frame that carries a link, and the link's pose in it.
  struct Placement {
    int frame = 0;
    Transform X_frame_link;
  };
  struct Range {
    int begin = 0, end = 0;
  };

  void place_links() {
    for (std::size_t i = 0; i < robot_.links().size(); ++i) {
      if (robot_.links()[i].parent_joint >= 0) place(static_cast<int>(i));
    }
  }

  /// A body per attached object, or per frame that carries some if there would be more than `most`.
  [[nodiscard]] std::vector<Body> attached_bodies(std::size_t most) const {
    const std::size_t count = robot_.attached().size();
    std::map<int, Body> by_frame;
    std::vector<Body> bodies;
    for (std::size_t i = robot_.links().size() - count; i < robot_.links().size(); ++i) {
      const int frame = placements_[i].frame, link = static_cast<int>(i);
      if (count <= most) {
        bodies.push_back({frame, {}, {link}});
      } else {
        by_frame[frame].frame = frame;
        by_frame[frame].links.push_back(link);
      }
    }
    for (auto& [frame, body] : by_frame) bodies.push_back(std::move(body));
    return bodies;
  }

  /// Reads the groups and bodies of links from the tables.
  void find_bare_links() {
    for (std::size_t i = 0; i < tables_.bodies.size(); ++i) {
      const BodyRow& body = tables_.bodies[i];
      for (int group = body.group_begin; group < body.group_end; ++group) {
        const int link = tables_.link_of_group[as_index(group)];
        Range& groups = groups_of_link_[as_index(link)];
        if (groups.end == 0) groups.begin = group;
        groups.end = group + 1;
        body_of_link_[link] = static_cast<int>(i);
      }
    }
  }

  /// Attached objects come first, like tips.
  void move_last_body_to_front() {
    std::rotate(tables_.bodies.begin(), tables_.bodies.end() - 1, tables_.bodies.end());
    const int last = static_cast<int>(tables_.bodies.size()) - 1;
    for (auto& [link, body] : body_of_link_) body = body == last ? 0 : body + 1;
    for (BodyPairRow& pair : tables_.body_pairs) {
      ++pair.first;
      ++pair.second;
    }
  }

  void place(int link_index) {
    const int joint_index = robot_.links()[as_index(link_index)].parent_joint;
    const Joint& joint = robot_.joints()[as_index(joint_index)];
    const Placement& parent = placements_[as_index(joint.parent_link)];
    const Transform X_frame_joint = parent.X_frame_link * joint.origin;
    Placement& placement = placements_[as_index(link_index)];
    const auto drive = find_drive(robot_, joint_index);
    if (!drive) {
      placement = {parent.frame, X_frame_joint * joint_motion(joint, joint.fixed_value)};
      return;
    }
    bool is_reversed = false;
    const Eigen::Matrix3d to_axis = rotation_to_axis(joint.axis, is_reversed);
    const double sign = is_reversed ? -1 : 1;
    FrameRow row;
    row.parent = parent.frame;
    row.joint = drive->joint;
    row.multiplier = static_cast<float>(sign * drive->rate);
    row.offset = static_cast<float>(sign * drive->offset);
    row.is_prismatic = joint.type == JointType::prismatic;
    store_turn(X_frame_joint.rotation * to_axis, row);
    store(X_frame_joint.translation, row.translation);
    tables_.frames.push_back(row);
    placement.frame = static_cast<int>(tables_.frames.size());
    placement.X_frame_link = Transform{to_axis, Vec3::Zero()}.inverse();
  }

  void add_links() {
    for (const Placement& placement : placements_) {
      LinkPlace& place = tables_.links.emplace_back();
      place.frame = placement.frame;
      store(placement.X_frame_link.rotation, place.rotation);
      store(placement.X_frame_link.translation, place.translation);
    }
  }

  /// The shapes of a link in its frame.
  [[nodiscard]] std::vector<Capsule> shapes_of(int link_index) const {
    return internal::shapes_of(robot_.links()[as_index(link_index)],
                               placements_[as_index(link_index)].X_frame_link);
  }

  void add_bodies() {
    std::vector<Body> bodies;
    for (std::size_t i = 0; i < robot_.links().size(); ++i) {
      const int link = static_cast<int>(i);
      const std::vector<Capsule> shapes = shapes_of(link);
      if (!shapes.empty()) bodies.push_back({placements_[i].frame, enclosing_ball(shapes), {link}});
    }
    merge_bodies(bodies, as_index(kMaxBodies));
    std::stable_sort(bodies.begin(), bodies.end(),
                     [](const Body& a, const Body& b) { return a.frame > b.frame; });
    for (const Body& body : bodies) add_body(body);
  }

  void add_body(const Body& body) {
    BodyRow row = {.frame = body.frame};
    row.group_begin = static_cast<int>(tables_.groups.size());
    row.cluster_begin = static_cast<int>(tables_.clusters.size());
    std::vector<Capsule> all;
    clustered_.clear();
    for (const int link : body.links) {
      std::vector<Capsule> shapes = shapes_of(link);
      const auto capsules = std::partition(shapes.begin(), shapes.end(), is_sphere);
      Range& groups = groups_of_link_[as_index(link)];
      groups.begin = static_cast<int>(tables_.groups.size());
      for_each_part({shapes.begin(), capsules}, kClusterSize * kGroupSize, [&](auto part) {
        const std::size_t begin = tables_.groups.size();
        for_each_part(part, kGroupSize, [&](auto group) { add_spheres(group); });
        cluster_groups(begin, part);
      });
      for (auto capsule = capsules; capsule != shapes.end(); ++capsule) {
        add_capsule(*capsule);
        cluster_groups(tables_.groups.size() - 1, std::span(&*capsule, 1));
      }
      groups.end = static_cast<int>(tables_.groups.size());
      tables_.link_of_group.resize(tables_.groups.size(), link);
      body_of_link_[link] = static_cast<int>(tables_.bodies.size());
      all.insert(all.end(), shapes.begin(), shapes.end());
    }
    row.group_end = static_cast<int>(tables_.groups.size());
    row.cluster_end = static_cast<int>(tables_.clusters.size());
    row.ball = to_ball(enclosing_ball(all));
    store_box(all, row);
    tables_.bodies.push_back(row);
    if (body.frame > 0) ++tables_.moving_count;
  }

  static void store_box(std::span<const Capsule> shapes, BodyRow& row) {
    AxisBox box;
    for (const Capsule& shape : shapes) {
      box.include(box_of(Capsule{shape.a, shape.b, shape.radius + kBoxRounding}));
    }
    store(Vec3(0.5 * (box.low + box.high)), row.box_center);
    store(Vec3(0.5 * (box.high - box.low)), row.box_half_extents);
  }

  /// Sorts `shapes` into groups of at most `most` neighbours.
  template <class Add>
  static void for_each_part(std::span<Capsule> shapes, int most, const Add& add) {
    std::size_t begin = 0;
    for (const std::size_t end : sort_into_groups(shapes, as_index(most))) {
      add(shapes.subspan(begin, end - begin));
      begin = end;
    }
  }

  /// Adds the groups from `begin` on, which hold `shapes`, to the body's last cluster, or to a new
  /// one. Links of a gripper, of one or two spheres each, share clusters.
  void cluster_groups(std::size_t begin, std::span<const Capsule> shapes) {
    const std::size_t end = tables_.groups.size();
    const auto has_room = [&](const ClusterRow& cluster) {
      return end - as_index(cluster.begin) <= as_index(kClusterSize) &&
             !tables_.groups[as_index(cluster.begin)].is_capsule &&
             !tables_.groups[begin].is_capsule;
    };
    if (clustered_.empty() || !has_room(tables_.clusters.back())) {
      tables_.clusters.push_back({{}, static_cast<int>(begin), static_cast<int>(end)});
      clustered_.clear();
    }
    clustered_.insert(clustered_.end(), shapes.begin(), shapes.end());
    ClusterRow& cluster = tables_.clusters.back();
    cluster.ball = to_ball(enclosing_ball(clustered_));
    cluster.end = static_cast<int>(end);
    for (std::size_t i = begin; i < end; ++i) {
      tables_.groups[i].cluster = static_cast<int>(tables_.clusters.size()) - 1;
    }
  }

  /// Includes capsules so short that floats cannot represent their direction.
  static bool is_sphere(const Capsule& shape) { return (shape.b - shape.a).norm() < 1e-9; }

  void add_spheres(std::span<const Capsule> spheres) {
    tables_.groups.push_back(
        {to_ball(enclosing_ball(spheres)), false, static_cast<int>(tables_.spheres.size())});
    for (std::size_t i = 0; i < as_index(kGroupSize); ++i) {
      const Capsule& sphere = spheres[std::min(i, spheres.size() - 1)];
      Ball& row = tables_.spheres.emplace_back();
      store(sphere.a, row.center);
      row.radius = static_cast<float>(sphere.radius);
    }
  }

  void add_capsule(const Capsule& capsule) {
    tables_.groups.push_back({to_ball(enclosing_ball(std::span(&capsule, 1))), true,
                              static_cast<int>(tables_.capsules.size())});
    CapsuleRow& row = tables_.capsules.emplace_back();
    store(capsule.a, row.a);
    store(Vec3(capsule.b - capsule.a), row.along);
    row.inverse_length2 = static_cast<float>(1 / (capsule.b - capsule.a).squaredNorm());
    row.radius = static_cast<float>(capsule.radius);
  }

  /// `between(a, b)` returns a test of which groups of two links may meet.
  template <class Between>
  void add_pairs(std::span<const std::pair<int, int>> self_pairs, const Between& between) {
    std::map<std::pair<int, int>, std::vector<GroupPairRow>> pairs;
    for (auto [a, b] : self_pairs) {
      if (body_of_link_.at(a) > body_of_link_.at(b)) std::swap(a, b);
      const Range& first = groups_of_link_[as_index(a)];
      const Range& second = groups_of_link_[as_index(b)];
      const auto may_meet = between(a, b);
      for (int i = first.begin; i < first.end; ++i) {
        for (int k = second.begin; k < second.end; ++k) {
          if (!may_meet(i, k)) continue;
          auto& rows = pairs[{body_of_link_.at(a), body_of_link_.at(b)}];
          if (rows.empty() || rows.back().first != i || rows.back().second_end != k) {
            rows.push_back({i, k, k});
          }
          ++rows.back().second_end;
        }
      }
    }
    tables_.body_pairs.reserve(tables_.body_pairs.size() + pairs.size());
    for (const auto& [bodies, rows] : pairs) {
      const float reach = tables_.bodies[as_index(bodies.first)].ball.radius +
                          tables_.bodies[as_index(bodies.second)].ball.radius;
      BodyPairRow row{bodies.first, bodies.second, reach * reach,
                      static_cast<int>(tables_.group_pairs.size())};
      tables_.group_pairs.insert(tables_.group_pairs.end(), rows.begin(), rows.end());
      row.end = static_cast<int>(tables_.group_pairs.size());
      tables_.body_pairs.push_back(row);
    }
  }

  void add_limbs() {
    if (tables_.joint_count > kMostWalkingJoints) return;
    for (int frame = static_cast<int>(tables_.frames.size()); frame > 0; --frame) {
      const bool is_tip = std::ranges::none_of(
          tables_.frames, [&](const FrameRow& f) { return f.parent == frame; });
      if (is_tip) add_limb(frame);
    }
  }

  void add_limb(int frame) {
    Limb limb;
    limb.points.push_back(tip_of(frame));
    using RowMajor = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
    // The last point, in `frame`.
    Eigen::Vector3f place = Eigen::Map<const Eigen::Vector3f>(limb.points[0].point);
    for (; frame > 0; frame = tables_.frames[as_index(frame - 1)].parent) {
      const FrameRow& row = tables_.frames[as_index(frame - 1)];
      if (!row.is_prismatic) {
        limb.points.push_back({frame, {}});
        limb.length += place.norm();
        place.setZero();
      } else {
        place.z() += row.offset;
      }
      place = Eigen::Map<const RowMajor>(row.rotation) * place +
              Eigen::Map<const Eigen::Vector3f>(row.translation);
    }
    if (limb.length > 0) tables_.limbs.push_back(std::move(limb));
  }

  /// The point carried by a frame that is farthest from its origin.
  [[nodiscard]] LimbPoint tip_of(int frame) const {
    LimbPoint tip{frame, {}};
    float farthest = 0;
    const auto look_at = [&](const Vec3& point) {
      const auto distance = static_cast<float>(point.norm());
      if (distance <= farthest) return;
      farthest = distance;
      store(point, tip.point);
    };
    for (std::size_t link = 0; link < placements_.size(); ++link) {
      if (placements_[link].frame != frame) continue;
      for (const Capsule& shape : shapes_of(static_cast<int>(link))) {
        look_at(shape.a);
        look_at(shape.b);
      }
    }
    return tip;
  }

  [[nodiscard]] bool can_groups_meet(const Linkage& linkage, int a, int b) const {
    const auto meet = [&](std::span<const Ball> first, std::span<const Ball> second) {
      return linkage.can_meet(to_spheres(first), to_spheres(second));
    };
    const GroupRow& first = tables_.groups[as_index(a)];
    const GroupRow& second = tables_.groups[as_index(b)];
    return meet({&first.ball, 1}, {&second.ball, 1}) && meet(balls_of(first), balls_of(second));
  }

  /// The spheres of a group, or the ball around a capsule.
  [[nodiscard]] std::span<const Ball> balls_of(const GroupRow& group) const {
    if (group.is_capsule) return {&group.ball, 1};
    return std::span(tables_.spheres).subspan(as_index(group.begin), as_index(kGroupSize));
  }

  const Robot& robot_;
  std::vector<Placement> placements_;
  std::vector<Range> groups_of_link_;
  std::map<int, int> body_of_link_;
  std::vector<Capsule> clustered_;  ///< shapes of the last cluster; empty if that is another body's
  RobotTables tables_;
};

}  // namespace

Result<RobotTables> make_robot_tables(const Robot& robot) {
  return RobotTablesBuilder(robot).build();
}

Result<std::vector<PairTables>> make_pair_tables(const Robot& robot) {
  std::vector<PairTables> made;
  if (robot.exact_pairs().empty()) return made;
  const RobotTables all = MNEME_TRY(RobotTablesBuilder(robot).build_of_exact_pairs());
  for (const auto& pair : robot.exact_pairs()) {
    std::set<std::pair<int, int>> others(robot.exact_pairs().begin(), robot.exact_pairs().end());
    others.erase(pair);
    made.push_back({pair, without_pairs(all, others)});
  }
  return made;
}

Result<RobotTables> add_attached(const Robot& robot, const RobotTables& bare) {
  // At the worst there is an attached body per frame.
  const std::size_t most = std::min(robot.attached().size(), bare.frames.size() + 1);
  if (bare.bodies.size() + most > as_index(kMaxBodies)) return make_robot_tables(robot);
  return RobotTablesBuilder(robot).build_on(bare);
}

RobotTables without_pairs(RobotTables tables, const std::set<std::pair<int, int>>& pairs) {
  const auto is_excluded = [&](int first, int second) {
    const auto& link = tables.link_of_group;
    return pairs.contains(std::minmax(link[as_index(first)], link[as_index(second)]));
  };
  std::vector<GroupPairRow> kept;
  for (BodyPairRow& bodies : tables.body_pairs) {
    const auto begin = kept.size();
    for (int i = bodies.begin; i < bodies.end; ++i) {
      const GroupPairRow& row = tables.group_pairs[as_index(i)];
      for (int k = row.second_begin; k < row.second_end; ++k) {
        if (is_excluded(row.first, k)) continue;
        const bool is_next =
            kept.size() > begin && kept.back().first == row.first && kept.back().second_end == k;
        if (!is_next) kept.push_back({row.first, k, k});
        ++kept.back().second_end;
      }
    }
    bodies.begin = static_cast<int>(begin);
    bodies.end = static_cast<int>(kept.size());
  }
  std::erase_if(tables.body_pairs, [](const BodyPairRow& row) { return row.begin == row.end; });
  tables.group_pairs = std::move(kept);
  add_reaches(tables);
  return tables;
}

}  // namespace mneme::internal
