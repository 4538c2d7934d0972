// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sources of configurations for sampling-based planners. Planners know only this interface.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace mneme {

/// Which source a configuration came from: kUniformSource, or the index of a local sampler.
using SampleSource = int;
inline constexpr SampleSource kUniformSource = -1;

/// A planner's use of a configuration.
enum class SampleOutcome {
  rejected,   ///< not used: in contact, or no free motion leads there
  extended,   ///< added to a tree or roadmap
  connected,  ///< added, and connected to the other tree, a goal, or several parts of the roadmap
};

/// One query's stream of configurations. The sampler must outlive its streams. Not thread-safe.
class SampleStream {
 public:
  virtual ~SampleStream() = default;
  /// Writes a configuration within the joint limits into `q` (joint_count() values).
  virtual SampleSource next(std::span<float> q) = 0;
  /// Reports the outcome of a configuration to its source, in any order.
  virtual void report(SampleSource, SampleOutcome) {}
};

/// A distribution over configurations: immutable, shareable between threads.
class Sampler {
 public:
  virtual ~Sampler() = default;
  /// Starts a stream that depends on `seed` alone.
  [[nodiscard]] virtual std::unique_ptr<SampleStream> start(std::uint64_t seed) const = 0;
};

/// One query's stream of goal configurations, for goals that are regions. Not thread-safe.
class GoalSource {
 public:
  virtual ~GoalSource() = default;
  /// Searches for further goals for a short while. Returns free configurations that no earlier call
  /// returned. After an empty result the next call may still find some.
  [[nodiscard]] virtual std::vector<Configuration> more() = 0;
};

/// Returns a sampler that is uniform within the joint limits.
[[nodiscard]] std::unique_ptr<Sampler> make_uniform_sampler(const Robot& robot);

/// Returns a sampler of Halton points in the bases of the first primes (DOI 10.1007/BF01386213),
/// shifted modulo the limits by a random vector per seed (Cranley and Patterson,
/// DOI 10.1137/0713071).
[[nodiscard]] std::unique_ptr<Sampler> make_halton_sampler(const Robot& robot);

/// Number of values in a lower triangle with `rows` rows, packed row by row; also the index of the
/// first value of row `rows` in a larger triangle.
[[nodiscard]] constexpr std::size_t triangle_size(std::size_t rows) {
  return rows * (rows + 1) / 2;
}

/// A Gaussian mixture with equiprobable components, eq. (1) of the paper. Means are float32,
/// row-major.
struct GaussianMixture {
  int joint_count = 0;
  std::vector<float> means;  ///< component_count() rows of joint_count values
  /// Per component the index of its row in `factors`; -1: the component has the sampler's sigma.
  /// Empty: all -1.
  std::vector<int> factor_rows = {};
  /// factor_count() rows of triangle_size(joint_count) values: lower triangles, row by row, of
  /// Cholesky factors L of covariances L L^T.
  std::vector<float> factors = {};
  std::vector<SampleSource> sources = {};  ///< per component the reported source; empty: all 0

  [[nodiscard]] int component_count() const {
    return joint_count == 0 ? 0 : static_cast<int>(means.size()) / joint_count;
  }
  [[nodiscard]] int factor_count() const {
    return joint_count == 0 ? 0 : static_cast<int>(factors.size() / factor_size());
  }
  /// Number of values in a row of `factors`.
  [[nodiscard]] std::size_t factor_size() const {
    return triangle_size(static_cast<std::size_t>(joint_count));
  }
  /// Returns a component's row of `factors`; empty if the component has the sampler's sigma.
  [[nodiscard]] std::span<const float> factor(int component) const {
    const int row = factor_rows.empty() ? -1 : factor_rows[static_cast<std::size_t>(component)];
    if (row < 0) return {};
    return {factors.data() + static_cast<std::size_t>(row) * factor_size(), factor_size()};
  }
  /// Adds an entry to `factor_rows` for the next component, and `factor` to `factors`. An empty
  /// `factor` gives the component the sampler's sigma.
  void add_factor(std::span<const float> factor) {
    factor_rows.push_back(factor.empty() ? -1 : factor_count());
    factors.insert(factors.end(), factor.begin(), factor.end());
  }
};

/// Progressive widening over components in order of relevance. Sample n, counted from 0, is from
/// one of the first `first + growth * n` components.
struct Widening {
  double first = 0;  ///< 0: all components from the first sample, as in the paper
  double growth = 0;
};

/// Returns a sampler that picks a component with equal probability and samples from it. `sigma` is
/// the standard deviation of components without a factor, >= 0: radians, or half that number of
/// metres for prismatic joints. Continuous joints wrap, others clamp to their limits. The mixture
/// must have components.
[[nodiscard]] std::unique_ptr<Sampler> make_mixture_sampler(
    const Robot& robot, std::shared_ptr<const GaussianMixture> mixture, double sigma,
    const Widening& widening = {});

/// Returns a sampler whose streams take the first `count` samples from `first`. Then each stream
/// calls `make_rest` once and takes all further samples from its result. Queries that are solved
/// quickly thus never pay for `make_rest`. Samples keep the sources that `first` and the other
/// sampler report.
[[nodiscard]] std::unique_ptr<Sampler> make_lazy_sampler(
    std::shared_ptr<const Sampler> first, int count,
    std::function<std::shared_ptr<const Sampler>()> make_rest);

/// Components of a mixture, each computed when it is first sampled. They form groups in order of
/// relevance; components of one group are equally likely. Const is parallel-safe.
class ComponentSource {
 public:
  /// Number of samples after which the next group joins. Relevant groups are thus tried first, and
  /// components of others are computed only for long searches.
  static constexpr int kSamplesPerGroup = 1000;

  virtual ~ComponentSource() = default;
  [[nodiscard]] virtual int group_count() const = 0;
  /// Number of groups that take part from the first sample on.
  [[nodiscard]] virtual int first_groups() const { return 1; }
  [[nodiscard]] virtual int component_count(int group) const = 0;
  /// Source of the samples from a group's components.
  [[nodiscard]] virtual SampleSource sample_source(int group) const = 0;
  /// Writes the mean of a component, within the limits. Returns false if the component has no mean.
  [[nodiscard]] virtual bool make(int group, int component, std::span<float> mean) const = 0;
  /// Returns the component's factor, as GaussianMixture::factor().
  [[nodiscard]] virtual std::span<const float> factor(int group, int component) const = 0;
};

/// Returns a sampler like make_mixture_sampler() over all components of the groups that take part.
/// Samples are uniform if no component has a mean.
[[nodiscard]] std::unique_ptr<Sampler> make_component_sampler(
    const Robot& robot, std::shared_ptr<const ComponentSource> source, double sigma);

/// A sampler that make_mixed_sampler() mixes with others. Its samples have the probability lambda
/// at first, and lambda * h / (h + n) after n of them in a stream, where h = max(500, 25000 f). The
/// probability never falls below the floor f = `least_lambda`. The probabilities of all sources sum
/// to at most 1.
///
/// The cost of a useless source is limited (no regret). Let a query need U samples of `rest`
/// without the source. With this source alone and 0 < f < 1, the query needs at most U / (1 - f) +
/// n0 + 1 samples on average. Here n0 = max(0, h (lambda / f - 1)) is the number of the source's
/// samples until its probability is f; for lambda >= f >= 0.02 it is 25000 (lambda - f). Proof: at
/// most n0 + 1 samples of the source come before its probability is f. Afterwards f / (1 - f) of
/// its samples are expected per sample of `rest`. Examples: lambda = 0.8 and f = 0.2 cost at most
/// 25 % more samples plus 15,001; lambda = 0.5 and f = 0.02 cost at most 2.1 % more plus 12,001.
/// The bound also holds for the iterations of a planner that more samples never slow down.
struct MixedSource {
  std::shared_ptr<const Sampler> sampler;
  double lambda = 0;
  double least_lambda = 0;
};

/// Algorithm 1, line 2. Samples from each source with its probability, otherwise from `rest`.
[[nodiscard]] std::unique_ptr<Sampler> make_mixed_sampler(std::vector<MixedSource> sources,
                                                          std::shared_ptr<const Sampler> rest);
/// Samples with constant probability `lambda`, in [0, 1], from `first`, otherwise from `second`.
[[nodiscard]] std::unique_ptr<Sampler> make_mixed_sampler(double lambda,
                                                          std::shared_ptr<const Sampler> first,
                                                          std::shared_ptr<const Sampler> second);

}  // namespace mneme
