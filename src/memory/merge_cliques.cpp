// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Section V-A of the paper. Finding the fewest cliques is NP-hard. As in the paper they are found
// greedily, here each from the first remaining configuration.
#include "mneme/memory.h"

#include "robot/joint_space.h"

#include <Eigen/Cholesky>

namespace mneme {
namespace {

/// Smallest standard deviation of a merged component, joint units: keeps covariances well
/// conditioned.
constexpr double kLeastDeviation = 0.01;

class CliqueMerger {
 public:
  CliqueMerger(const CollisionChecker& checker, const LocalSampler& sampler,
               const std::function<bool()>& is_late)
      : checker_(checker), space_(checker.robot()), sampler_(sampler), is_late_(is_late) {
    merged_.joint_count = sampler.joint_count;
  }

  LocalSampler merge() {
    std::vector<bool> is_taken(static_cast<std::size_t>(sampler_.component_count()), false);
    for (std::size_t first = 0; first < is_taken.size(); ++first) {
      if (is_taken[first]) continue;
      std::vector<std::size_t> clique = {first};
      for (std::size_t i = first + 1; i < is_taken.size() && !is_late(); ++i) {
        if (is_taken[i] || !can_join(i, clique)) continue;
        is_taken[i] = true;
        clique.push_back(i);
      }
      add_clique(clique);
    }
    return std::move(merged_);
  }

 private:
  [[nodiscard]] bool is_late() const { return is_late_ && is_late_(); }

  [[nodiscard]] std::span<const float> factor(std::size_t component) const {
    return sampler_.factor(static_cast<int>(component));
  }
  [[nodiscard]] bool has_factor(std::size_t component) const { return !factor(component).empty(); }
  [[nodiscard]] SampleSource source(std::size_t component) const {
    return sampler_.sources.empty() ? 0 : sampler_.sources[component];
  }

  bool can_join(std::size_t component, const std::vector<std::size_t>& clique) {
    return !has_factor(component) && !has_factor(clique.front()) &&
           source(component) == source(clique.front()) && sees_all(component, clique);
  }

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

  void add_clique(const std::vector<std::size_t>& clique) {
    const Eigen::MatrixXd offsets = offsets_from_first(clique);
    const Eigen::VectorXd center = offsets.rowwise().mean();
    const std::span<const float> first = mean(clique.front());
    std::vector<float> middle(first.size());
    for (std::size_t j = 0; j < middle.size(); ++j) {
      const auto offset = static_cast<float>(center(static_cast<Eigen::Index>(j)));
      middle[j] = space_.into_limits(static_cast<int>(j), first[j] + offset);
    }
    if (clique.size() == 1 || !checker_.is_valid(std::span<const float>(middle))) {
      for (const std::size_t member : clique) add_as_it_is(member);
      return;
    }
    add_mean(middle, source(clique.front()));
    const bool has_covariance = clique.size() > middle.size();
    merged_.add_factor(has_covariance ? factor_of(offsets.colwise() - center)
                                      : std::vector<float>());
  }

  /// Displacements of the members from the first one, without jumps where continuous joints wrap.
  [[nodiscard]] Eigen::MatrixXd offsets_from_first(const std::vector<std::size_t>& clique) const {
    Eigen::MatrixXd offsets(sampler_.joint_count, static_cast<Eigen::Index>(clique.size()));
    Eigen::VectorXf delta(sampler_.joint_count);
    for (std::size_t i = 0; i < clique.size(); ++i) {
      space_.difference(mean(clique.front()).data(), mean(clique[i]).data(), delta.data());
      offsets.col(static_cast<Eigen::Index>(i)) = delta.cast<double>();
    }
    return offsets;
  }

  void add_mean(std::span<const float> values, SampleSource from) {
    merged_.means.insert(merged_.means.end(), values.begin(), values.end());
    if (!sampler_.sources.empty()) merged_.sources.push_back(from);
  }

  void add_as_it_is(std::size_t component) {
    add_mean(mean(component), source(component));
    merged_.add_factor(factor(component));
  }

  static std::vector<float> factor_of(const Eigen::MatrixXd& centered) {
    const Eigen::Index joints = centered.rows();
    Eigen::MatrixXd covariance =
        centered * centered.transpose() / static_cast<double>(centered.cols() - 1);
    covariance.diagonal().array() += kLeastDeviation * kLeastDeviation;
    const Eigen::MatrixXd factor = covariance.llt().matrixL();
    std::vector<float> packed;
    for (Eigen::Index i = 0; i < joints; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) packed.push_back(static_cast<float>(factor(i, j)));
    }
    return packed;
  }

  const CollisionChecker& checker_;
  internal::JointSpace space_;
  const LocalSampler& sampler_;
  const std::function<bool()>& is_late_;
  CheckCounters counters_;
  LocalSampler merged_;
};

}  // namespace

LocalSampler merge_cliques(const CollisionChecker& checker, const LocalSampler& sampler,
                           const std::function<bool()>& is_late) {
  return CliqueMerger(checker, sampler, is_late).merge();
}

}  // namespace mneme
