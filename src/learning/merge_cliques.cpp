// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Section V-A of the paper. Finding the fewest cliques is NP-hard; as in the paper they are found
// one after the other, here each starting from the first configuration that is left.
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "mneme/learning.h"
#include "robot/joint_space.h"

namespace mneme {
namespace {

/// Smallest standard deviation of a merged component, joint units: keeps covariances well
/// conditioned.
constexpr double kLeastDeviation = 0.01;

class CliqueMerger {
 public:
  CliqueMerger(const CollisionChecker& checker, const LocalSampler& sampler)
      : checker_(checker), space_(checker.robot()), sampler_(sampler) {
    merged_.joint_count = sampler.joint_count;
  }

  LocalSampler merge() {
    std::vector<bool> is_taken(static_cast<std::size_t>(sampler_.component_count()), false);
    for (std::size_t first = 0; first < is_taken.size(); ++first) {
      if (is_taken[first]) continue;
      std::vector<std::size_t> clique = {first};
      for (std::size_t i = first + 1; i < is_taken.size(); ++i) {
        if (is_taken[i] || !sees_all(i, clique)) continue;
        is_taken[i] = true;
        clique.push_back(i);
      }
      add_component(clique);
    }
    return std::move(merged_);
  }

 private:
  [[nodiscard]] std::span<const float> mean(std::size_t component) const {
    const auto joints = static_cast<std::size_t>(sampler_.joint_count);
    return {sampler_.means.data() + component * joints, joints};
  }

  bool sees_all(std::size_t component, const std::vector<std::size_t>& clique) {
    for (const std::size_t member : clique) {
      if (!checker_.is_motion_valid(mean(member), mean(component), counters_)) return false;
    }
    return true;
  }

  void add_component(const std::vector<std::size_t>& clique) {
    const auto joints = static_cast<Eigen::Index>(sampler_.joint_count);
    const std::span<const float> origin = mean(clique.front());
    // Displacements from one member are free of the jump where continuous joints wrap.
    Eigen::MatrixXd offsets(joints, static_cast<Eigen::Index>(clique.size()));
    std::vector<float> delta(origin.size());
    for (std::size_t i = 0; i < clique.size(); ++i) {
      space_.difference(origin.data(), mean(clique[i]).data(), delta.data());
      for (Eigen::Index j = 0; j < joints; ++j) {
        offsets(j, static_cast<Eigen::Index>(i)) = delta[static_cast<std::size_t>(j)];
      }
    }
    const Eigen::VectorXd center = offsets.rowwise().mean();
    for (Eigen::Index j = 0; j < joints; ++j) {
      const auto i = static_cast<std::size_t>(j);
      merged_.means.push_back(
          space_.into_limits(static_cast<int>(j), origin[i] + static_cast<float>(center(j))));
    }
    const bool has_covariance = static_cast<Eigen::Index>(clique.size()) > joints;
    merged_.factor_rows.push_back(has_covariance ? factor_count_++ : -1);
    if (has_covariance) add_factor(offsets.colwise() - center);
  }

  void add_factor(const Eigen::MatrixXd& centered) {
    const Eigen::Index joints = centered.rows();
    Eigen::MatrixXd covariance =
        centered * centered.transpose() / static_cast<double>(centered.cols() - 1);
    covariance.diagonal().array() += kLeastDeviation * kLeastDeviation;
    const Eigen::MatrixXd factor = covariance.llt().matrixL();
    for (Eigen::Index i = 0; i < joints; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j)
        merged_.factors.push_back(static_cast<float>(factor(i, j)));
    }
  }

  const CollisionChecker& checker_;
  internal::JointSpace space_;
  const LocalSampler& sampler_;
  CheckCounters counters_;
  LocalSampler merged_;
  int factor_count_ = 0;
};

}  // namespace

LocalSampler merge_cliques(const CollisionChecker& checker, const LocalSampler& sampler) {
  return CliqueMerger(checker, sampler).merge();
}

}  // namespace mneme
