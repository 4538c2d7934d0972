// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots for KDL: the oracle and the peer of inverse kinematics.
#pragma once

#include "mneme/problem.h"
#include "mneme/robot.h"

#include <kdl/chain.hpp>
#include <kdl/jntarray.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace mneme::test {

inline KDL::Vector to_kdl(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline KDL::Frame to_kdl(const Transform& X) {
  const Eigen::Matrix3d& r = X.rotation;
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                        r(2, 2)),
          to_kdl(X.translation)};
}

/// The way from the root to a link. Joints outside the group are fixed where they stand; mimic
/// joints have no counterpart.
struct KdlChain {
  KDL::Chain chain;
  std::vector<int> joints;  ///< per joint of the chain its index in the group
  KDL::JntArray lower, upper;

  KdlChain(const Robot& robot, const std::string& link) {
    std::vector<int> way;
    int at = static_cast<int>(std::ranges::find(robot.links(), link, &Link::name) -
                              robot.links().begin());
    while (robot.links()[static_cast<std::size_t>(at)].parent_joint >= 0) {
      way.push_back(robot.links()[static_cast<std::size_t>(at)].parent_joint);
      at = robot.joints()[static_cast<std::size_t>(way.back())].parent_link;
    }
    std::ranges::reverse(way);
    for (const int joint : way) add(robot, joint);
    lower.resize(static_cast<unsigned>(joints.size()));
    upper.resize(static_cast<unsigned>(joints.size()));
    for (unsigned i = 0; i < joints.size(); ++i) {
      lower(i) = robot.group_joint(joints[i]).lower;
      upper(i) = robot.group_joint(joints[i]).upper;
    }
  }

  [[nodiscard]] KDL::JntArray to_kdl_joints(const Configuration& q) const {
    KDL::JntArray values(static_cast<unsigned>(joints.size()));
    for (unsigned i = 0; i < joints.size(); ++i) values(i) = q[static_cast<std::size_t>(joints[i])];
    return values;
  }

 private:
  void add(const Robot& robot, int index) {
    const Joint& joint = robot.joints()[static_cast<std::size_t>(index)];
    const auto in_group = std::ranges::find(robot.group(), index);
    const bool is_prismatic = joint.type == JointType::prismatic;
    if (in_group == robot.group().end()) {
      Transform X = joint.origin;
      if (is_prismatic)
        X = X * Transform{Eigen::Matrix3d::Identity(), joint.axis * joint.fixed_value};
      else if (joint.type != JointType::fixed)
        X = X * Transform{rotation_about(joint.axis, joint.fixed_value), Vec3::Zero()};
      chain.addSegment(
          KDL::Segment(joint.name, KDL::Joint(joint.name, KDL::Joint::None), to_kdl(X)));
      return;
    }
    joints.push_back(static_cast<int>(in_group - robot.group().begin()));
    const KDL::Frame origin = to_kdl(joint.origin);
    chain.addSegment(
        KDL::Segment(joint.name,
                     KDL::Joint(joint.name, origin.p, origin.M * to_kdl(joint.axis),
                                is_prismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis),
                     origin));
  }
};

}  // namespace mneme::test
