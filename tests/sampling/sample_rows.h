// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Robots with joints of all kinds, and rows of samples with their moments.
#pragma once

#include "support/support.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace mneme::test {

/// A chain about z: a joint of each of `types`; revolute ones from -2 to 1, prismatic ones from 0.5
/// to 2.
inline Robot joints_of(const std::vector<JointType>& types) {
  Robot::Parts parts;
  parts.name = "chain";
  parts.links.push_back({.name = "link0"});
  for (std::size_t i = 0; i < types.size(); ++i) {
    parts.links.push_back({.name = "link" + std::to_string(i + 1)});
    Joint joint;
    joint.name = "joint" + std::to_string(i + 1);
    joint.type = types[i];
    joint.parent_link = static_cast<int>(i);
    joint.child_link = static_cast<int>(i) + 1;
    joint.axis = Vec3::UnitZ();
    joint.lower = types[i] == JointType::prismatic ? 0.5 : -2;
    joint.upper = types[i] == JointType::prismatic ? 2 : 1;
    parts.joints.push_back(joint);
  }
  return require(make_robot(parts));
}

/// A continuous, a revolute and a prismatic joint.
inline Robot all_kinds() {
  return joints_of({JointType::continuous, JointType::revolute, JointType::prismatic});
}

/// Samples as columns, one per joint.
struct Samples {
  std::vector<std::vector<double>> columns;
  std::vector<SampleSource> sources;
};

inline Samples draw(const Sampler& sampler, int joints, std::uint64_t seed, int count) {
  const auto stream = sampler.start(seed);
  Samples samples;
  samples.columns.resize(static_cast<std::size_t>(joints));
  std::vector<float> q(static_cast<std::size_t>(joints));
  for (int i = 0; i < count; ++i) {
    samples.sources.push_back(stream->next(q));
    for (std::size_t j = 0; j < q.size(); ++j) samples.columns[j].push_back(q[j]);
  }
  return samples;
}

inline double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

inline double covariance(const std::vector<double>& a, const std::vector<double>& b) {
  const double mean_a = mean(a), mean_b = mean(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  return sum / static_cast<double>(a.size() - 1);
}

inline double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  return covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
}

/// Sum of (observed - expected)^2 / expected over `cells` equal cells of [lower, upper].
inline double chi_square(const std::vector<double>& values, double lower, double upper, int cells) {
  std::vector<int> counts(static_cast<std::size_t>(cells), 0);
  for (const double value : values) {
    const int cell = static_cast<int>((value - lower) / (upper - lower) * cells);
    ++counts[static_cast<std::size_t>(std::clamp(cell, 0, cells - 1))];
  }
  const double expected = static_cast<double>(values.size()) / cells;
  double sum = 0;
  for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
  return sum;
}

/// `columns` of a stream are those of a second stream with this seed, and of no stream with
/// another.
inline void check_seeds(const Sampler& sampler, int joints) {
  const Samples first = draw(sampler, joints, 11, 500);
  const Samples again = draw(sampler, joints, 11, 500);
  const Samples other = draw(sampler, joints, 12, 500);
  CHECK(first.columns == again.columns);
  CHECK(first.sources == again.sources);
  for (int j = 0; j < joints; ++j) {
    const auto& a = first.columns[static_cast<std::size_t>(j)];
    const auto& b = other.columns[static_cast<std::size_t>(j)];
    int equal = 0;
    for (std::size_t i = 0; i < a.size(); ++i) equal += a[i] == b[i] ? 1 : 0;
    CHECK(equal < 250);
  }
}

/// Every sample is a configuration of the robot.
inline void check_limits(const Sampler& sampler, const Robot& robot, int count) {
  const auto stream = sampler.start(13);
  std::vector<float> q(static_cast<std::size_t>(robot.joint_count()));
  for (int i = 0; i < count; ++i) {
    stream->next(q);
    const auto violation = robot.describe_violation(Configuration(q.begin(), q.end()), "sample");
    REQUIRE_MESSAGE(!violation, *violation);
    for (int j = 0; j < robot.joint_count(); ++j) {
      REQUIRE(q[static_cast<std::size_t>(j)] >= robot.group_joint(j).lower - 3e-6);
      REQUIRE(q[static_cast<std::size_t>(j)] <= robot.group_joint(j).upper + 3e-6);
    }
  }
}

}  // namespace mneme::test
