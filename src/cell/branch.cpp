// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/branch.h"

#include "base/as_index.h"
#include "bent_path/bent_path.h"

#include <algorithm>
#include <cmath>

namespace mneme::internal {
namespace {

/// Multiple of the largest error at the probes, and what is added to it, radians.
constexpr double kRestFactor = 2, kLeastRest = 2e-5;
/// Largest `rest`, radians: beyond it a smaller box proves more.
constexpr double kMostRest = 0.004;
/// Largest motion of a joint from the middle of a box.
constexpr double kMostMotion = 1.5;
/// Boxes that need more than this multiple of the room to the limits are not fitted.
constexpr double kLeastSlack = 0.2;
constexpr int kProbesPerParameter = 20, kNodesPerParameter = 8;
/// Random probes at which models are checked.
constexpr int kChecksPerParameter = 10;
/// Accuracy of configurations that models are fitted to, metres.
constexpr double kNear = 1e-6;

/// All points of {-1, 0, 1}^d.
std::vector<std::vector<double>> make_grid(int parameters) {
  std::vector<std::vector<double>> points(1);
  for (int k = 0; k < parameters; ++k) {
    std::vector<std::vector<double>> wider;
    for (const auto& point : points) {
      for (const double value : {-1.0, 0.0, 1.0}) {
        wider.push_back(point);
        wider.back().push_back(value);
      }
    }
    points = std::move(wider);
  }
  return points;
}

std::vector<double> monomials(const std::vector<double>& u) {
  std::vector<double> values = {1};
  values.insert(values.end(), u.begin(), u.end());
  for (std::size_t k = 0; k < u.size(); ++k) {
    for (std::size_t l = k; l < u.size(); ++l) values.push_back(u[k] * u[l]);
  }
  return values;
}

/// Writes coefficients in the order of monomials(), a column per joint.
GoalShift to_shift(const Eigen::MatrixXd& coefficients, int parameters) {
  const auto joints = coefficients.cols();
  GoalShift shift;
  shift.parameters = parameters;
  const auto append = [&](std::vector<float>& rows, Eigen::Index row) {
    for (Eigen::Index j = 0; j < joints; ++j) {
      rows.push_back(rounded(coefficients(row, j), kShiftStep));
    }
  };
  append(shift.constant, 0);
  for (int k = 0; k < parameters; ++k) append(shift.slopes, 1 + k);
  shift.curvatures.resize(as_index(parameters * parameters) * as_index(static_cast<int>(joints)));
  Eigen::Index row = 1 + parameters;
  for (int k = 0; k < parameters; ++k) {
    for (int l = k; l < parameters; ++l, ++row) {
      for (Eigen::Index j = 0; j < joints; ++j) {
        const float value = rounded((k == l ? 2 : 1) * coefficients(row, j), kShiftStep);
        shift.curvatures[static_cast<std::size_t>((k * parameters + l) * joints + j)] = value;
        shift.curvatures[static_cast<std::size_t>((l * parameters + k) * joints + j)] = value;
      }
    }
  }
  return shift;
}

}  // namespace

Branch make_branch(const LinkChain& chain, const JointVector& q) {
  Branch branch;
  branch.q0 = q.unaryExpr([](double value) { return double{rounded(value, kPathStep)}; });
  branch.response = chain.response(branch.q0);
  return branch;
}

BranchFitter::BranchFitter(const LinkChain& chain, const TaskFrame& frame)
    : chain_(chain), frame_(frame), parameters_(static_cast<int>(frame.varying().size())) {
  for (const auto& point : make_grid(parameters_)) {
    const auto zeros = std::ranges::count(point, 0.0);
    if (zeros == 0 || zeros >= parameters_ - 1) nodes_.push_back(point);
  }
  Rng rng(1);
  const auto random = [&](const auto& shape) {
    std::vector<double> u;
    for (int k = 0; k < parameters_; ++k) u.push_back(shape(rng.uniform(-1, 1)));
    return u;
  };
  // Denser near the border, where the error is largest.
  const auto outer = [](double x) { return std::copysign(std::sqrt(std::abs(x)), x); };
  for (int i = 0; i < kNodesPerParameter * parameters_; ++i) nodes_.push_back(random(outer));
  for (const auto& point : make_grid(parameters_)) {
    if (std::ranges::count(point, 0.0) == 0) probes_.push_back(point);
  }
  checks_ = probes_.size() + as_index(kChecksPerParameter * parameters_);
  for (int i = 0; i < kProbesPerParameter * parameters_; ++i) {
    probes_.push_back(random([](double x) { return x; }));
  }
  const auto rows = static_cast<Eigen::Index>(nodes_.size());
  Eigen::MatrixXd design(rows, static_cast<Eigen::Index>(monomials(nodes_.front()).size()));
  for (Eigen::Index i = 0; i < rows; ++i) {
    const std::vector<double> row = monomials(nodes_[static_cast<std::size_t>(i)]);
    design.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), design.cols());
  }
  solver_ = design.completeOrthogonalDecomposition().pseudoInverse();
}

Eigen::MatrixXd BranchFitter::slopes(const TaskBox& box, const Branch& branch) const {
  Eigen::MatrixXd slopes(chain_.joint_count(), parameters_);
  for (int i = 0; i < parameters_; ++i) {
    const int k = frame_.varying()[as_index(i)];
    slopes.col(i) = branch.response * frame_.twist(box.center, k) * box.half[as_index(k)];
  }
  return slopes;
}

LimitSlack BranchFitter::slack(const JointVector& q, const Eigen::MatrixXd& slopes) const {
  constexpr double kRoom = 0.01;
  LimitSlack least;
  for (int j = 0; j < chain_.joint_count(); ++j) {
    const double room = std::min(q[j] - chain_.lower()[j], chain_.upper()[j] - q[j]);
    const double ratio = room / (slopes.row(j).cwiseAbs().sum() + kRoom);
    if (ratio < least.ratio) least = {ratio, j};
  }
  return least;
}

double BranchFitter::rate(const TaskBox& box, const JointVector& q) const {
  const Eigen::MatrixXd motion = slopes(box, {q, chain_.response(q)});
  return std::min(slack(q, motion).ratio, 1.5) - 0.25 * motion.cwiseAbs().sum() / parameters_;
}

bool BranchFitter::solve(const Transform& pose, const Branch& branch, JointVector& q) const {
  const JointVector from = q;
  if (chain_.approach(pose, branch.response, kNear, q)) return true;
  q = from;
  return chain_.reach(pose, branch.response, 8, kNear, q);
}

FitFault BranchFitter::fit(const TaskBox& box, const Branch& branch, GoalShift& shift) const {
  const Eigen::MatrixXd motion = slopes(box, branch);
  if (slack(branch.q0, motion).ratio < kLeastSlack) return FitFault::limits;
  if (motion.rowwise().lpNorm<1>().maxCoeff() > kMostMotion) return FitFault::bends;
  Eigen::MatrixXd values(static_cast<Eigen::Index>(nodes_.size()), chain_.joint_count());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    JointVector q = branch.q0;
    for (int k = 0; k < parameters_; ++k) q += motion.col(k) * nodes_[i][as_index(k)];
    const Transform pose = frame_.pose(box.at(frame_.varying(), nodes_[i].data()));
    if (!solve(pose, branch, q)) return FitFault::bends;
    values.row(static_cast<Eigen::Index>(i)) = (q - branch.q0).transpose();
  }
  shift = to_shift(solver_ * values, parameters_);
  JointVector error = JointVector::Zero(chain_.joint_count());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const JointVector change = values.row(static_cast<Eigen::Index>(i)).transpose();
    error = error.cwiseMax((change - evaluate(shift, nodes_[i].data())).cwiseAbs());
  }
  for (std::size_t i = 0; i < checks_; ++i) {
    const std::vector<double>& u = probes_[i];
    const JointVector modelled = branch.q0 + evaluate(shift, u.data());
    JointVector q = modelled;
    const Transform pose = frame_.pose(box.at(frame_.varying(), u.data()));
    if (!solve(pose, branch, q)) return FitFault::bends;
    error = error.cwiseMax((q - modelled).cwiseAbs());
  }
  if (kRestFactor * error.maxCoeff() > kMostRest) return FitFault::bends;
  for (int j = 0; j < chain_.joint_count(); ++j) {
    shift.rest.push_back(rounded(kRestFactor * error[j] + kLeastRest, kShiftStep));
  }
  return FitFault::none;
}

bool follow(const LinkChain& chain, const TaskFrame& frame, const CellTask& from,
            const CellTask& to, int steps, JointVector& q) {
  const Response directions = chain.directions(q);
  for (int i = 1; i <= steps; ++i) {
    CellTask task = from;
    for (std::size_t k = 0; k < kTaskSize; ++k) task[k] += (to[k] - from[k]) * i / steps;
    if (!chain.reach(frame.pose(task), directions, 12, 1e-7, q)) return false;
  }
  return true;
}

}  // namespace mneme::internal
