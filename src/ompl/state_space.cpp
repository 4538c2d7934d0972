// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include <ompl/base/spaces/RealVectorStateProjections.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace mneme::ompl {
namespace {

namespace ob = ::ompl::base;

constexpr double kTurn = 2 * std::numbers::pi;

double* values(ob::State* state) {
  return state->as<ob::RealVectorStateSpace::StateType>()->values;
}
const double* values(const ob::State* state) {
  return state->as<ob::RealVectorStateSpace::StateType>()->values;
}

/// `angle` in [-pi, pi).
double wrapped(double angle) {
  // Distances of states, of which OMPL's searches for neighbours compute many, mostly need no turn.
  if (angle >= -std::numbers::pi && angle < std::numbers::pi) return angle;
  return angle - kTurn * std::floor(angle / kTurn + 0.5);
}

/// OMPL's sampler, but samples near a state continue across the seam of a continuous joint.
class JointStateSampler final : public ob::RealVectorStateSampler {
 public:
  JointStateSampler(const JointStateSpace* space, const std::vector<char>& is_continuous)
      : RealVectorStateSampler(space), is_continuous_(is_continuous) {}

  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    RealVectorStateSampler::sampleUniformNear(state, near, distance);
    for (std::size_t i = 0; i < is_continuous_.size(); ++i) {
      if (is_continuous_[i] == 0) continue;
      const double reach = std::min(distance, std::numbers::pi);
      values(state)[i] = wrapped(values(near)[i] + rng_.uniformReal(-reach, reach));
    }
  }

  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    for (std::size_t i = 0; i < is_continuous_.size(); ++i) {
      values(state)[i] = rng_.gaussian(values(mean)[i], deviation);
    }
    space_->enforceBounds(state);
  }

 private:
  const std::vector<char>& is_continuous_;
};

}  // namespace

JointStateSpace::JointStateSpace(const Robot& robot)
    : RealVectorStateSpace(static_cast<unsigned>(robot.joint_count())), robot_(robot) {
  setName("mneme " + robot.name());
  ob::RealVectorBounds bounds(dimension_);
  for (unsigned i = 0; i < dimension_; ++i) {
    const Joint& joint = robot.group_joint(static_cast<int>(i));
    bounds.setLow(i, joint.lower);
    bounds.setHigh(i, joint.upper);
    setDimensionName(i, joint.name);
    is_continuous_.push_back(joint.type == JointType::continuous ? 1 : 0);
  }
  setBounds(bounds);
}

ob::State* JointStateSpace::allocState() const {
  state_count_.fetch_add(1, std::memory_order_relaxed);
  return RealVectorStateSpace::allocState();
}

void JointStateSpace::freeState(ob::State* state) const {
  state_count_.fetch_sub(1, std::memory_order_relaxed);
  RealVectorStateSpace::freeState(state);
}

double JointStateSpace::getMaximumExtent() const {
  double sum = 0;
  for (unsigned i = 0; i < dimension_; ++i) {
    const double extent =
        is_continuous_[i] != 0 ? std::numbers::pi : bounds_.high[i] - bounds_.low[i];
    sum += extent * extent;
  }
  return std::sqrt(sum);
}

double JointStateSpace::distance(const ob::State* a, const ob::State* b) const {
  const double *const from = values(a), *const to = values(b);
  double sum = 0;
  for (unsigned i = 0; i < dimension_; ++i) {
    double difference = to[i] - from[i];
    if (is_continuous_[i] != 0) difference = wrapped(difference);
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

void JointStateSpace::interpolate(const ob::State* from, const ob::State* to, double t,
                                  ob::State* state) const {
  for (unsigned i = 0; i < dimension_; ++i) {
    const double begin = values(from)[i];
    const double difference = values(to)[i] - begin;
    values(state)[i] =
        is_continuous_[i] != 0 ? wrapped(begin + t * wrapped(difference)) : begin + t * difference;
  }
}

void JointStateSpace::enforceBounds(ob::State* state) const {
  for (unsigned i = 0; i < dimension_; ++i) {
    double& value = values(state)[i];
    value = is_continuous_[i] != 0 ? wrapped(value)
                                   : std::clamp(value, bounds_.low[i], bounds_.high[i]);
  }
}

bool JointStateSpace::equalStates(const ob::State* a, const ob::State* b) const {
  return distance(a, b) < 1e-12;
}

void JointStateSpace::registerProjections() {
  // The default of OMPL 1.5 for one or two dimensions fails an assertion in Eigen.
  if (dimension_ > 2) return RealVectorStateSpace::registerProjections();
  std::vector<unsigned> components(dimension_);
  std::iota(components.begin(), components.end(), 0u);
  registerDefaultProjection(
      std::make_shared<ob::RealVectorOrthogonalProjectionEvaluator>(this, components));
}

ob::StateSamplerPtr JointStateSpace::allocDefaultStateSampler() const {
  return std::make_shared<JointStateSampler>(this, is_continuous_);
}

::ompl::geometric::PathGeometric to_ompl(const Path& path,
                                         const ob::SpaceInformationPtr& information) {
  ::ompl::geometric::PathGeometric result(information);
  const ob::StateSpacePtr& space = information->getStateSpace();
  for (const Configuration& q : path) {
    ob::State* state = space->allocState();
    space->copyFromReals(state, q);
    space->enforceBounds(state);
    result.getStates().push_back(state);
  }
  return result;
}

Path from_ompl(const ::ompl::geometric::PathGeometric& path, const Robot& robot) {
  const ob::StateSpacePtr& space = path.getSpaceInformation()->getStateSpace();
  Path result;
  std::vector<double> q;
  for (std::size_t i = 0; i < path.getStateCount(); ++i) {
    space->copyToReals(q, path.getState(static_cast<unsigned>(i)));
    result.push_back(robot.normalized(q));
  }
  return result;
}

}  // namespace mneme::ompl
