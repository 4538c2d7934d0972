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

/// The use that a planner made of a configuration.
enum class SampleOutcome {
  rejected,   ///< nothing: in contact, or no motion to it was free
  extended,   ///< a tree or roadmap has grown by it
  connected,  ///< it has grown, and met the other tree, a goal, or several parts of the roadmap
};

/// One query's stream of configurations. Refers to its sampler, which must outlive it. Not
/// thread-safe.
class SampleStream {
 public:
  virtual ~SampleStream() = default;
  /// Writes a configuration within the joint limits into `q` (joint_count() values).
  virtual SampleSource next(std::span<float> q) = 0;
  /// Tells the source what became of one of its configurations, in any order.
  virtual void report(SampleSource, SampleOutcome) {}
};

/// A distribution over configurations: immutable, shareable between threads.
class Sampler {
 public:
  virtual ~Sampler() = default;
  /// A stream that depends on `seed` alone.
  [[nodiscard]] virtual std::unique_ptr<SampleStream> start(std::uint64_t seed) const = 0;
};

/// The twin of SampleStream at the other end: one query's stream of goal configurations, for goals
/// that are more than a few of them. Not thread-safe.
class GoalSource {
 public:
  virtual ~GoalSource() = default;
  /// Looks for more for a short while. What it returns is free, and differs from all before; there
  /// may be nothing, and yet something the next time.
  [[nodiscard]] virtual std::vector<Configuration> more() = 0;
};

/// Uniform within the joint limits.
[[nodiscard]] std::unique_ptr<Sampler> make_uniform_sampler(const Robot& robot);

/// Halton points in the bases of the first primes, shifted by a random vector modulo the limits per
/// seed. Halton, DOI 10.1007/BF01386213; the shift is that of Cranley and Patterson,
/// DOI 10.1137/0713071.
[[nodiscard]] std::unique_ptr<Sampler> make_halton_sampler(const Robot& robot);

/// Numbers of a lower triangle with `rows` rows that is packed row by row: so many come before row
/// `rows` of a larger one.
[[nodiscard]] constexpr std::size_t triangle_size(std::size_t rows) {
  return rows * (rows + 1) / 2;
}

/// A Gaussian mixture with equiprobable components, eq. (1) of the paper. Means are float32,
/// row-major.
struct GaussianMixture {
  int joint_count = 0;
  std::vector<float> means;  ///< component_count() rows of joint_count values
  /// Per component the row of `factors` that shapes it, or -1 for the sampler's sigma; empty: all
  /// -1.
  std::vector<int> factor_rows;
  /// factor_count() rows of triangle_size(joint_count) values: lower triangles, row by row, of
  /// Cholesky factors L of covariances L L^T.
  std::vector<float> factors;
  std::vector<SampleSource> sources;  ///< per component the source it counts for; empty: all 0

  [[nodiscard]] int component_count() const {
    return joint_count == 0 ? 0 : static_cast<int>(means.size()) / joint_count;
  }
  [[nodiscard]] int factor_count() const {
    return joint_count == 0 ? 0 : static_cast<int>(factors.size() / factor_size());
  }
  /// Values of a row of `factors`.
  [[nodiscard]] std::size_t factor_size() const {
    return triangle_size(static_cast<std::size_t>(joint_count));
  }
  /// The row of `factors` that shapes a component; empty for the sampler's sigma.
  [[nodiscard]] std::span<const float> factor(int component) const {
    const int row = factor_rows.empty() ? -1 : factor_rows[static_cast<std::size_t>(component)];
    if (row < 0) return {};
    return {factors.data() + static_cast<std::size_t>(row) * factor_size(), factor_size()};
  }
  /// Shapes the next component without an entry in `factor_rows` by a row of its own, of another
  /// mixture; by the sampler's sigma if `factor` is empty.
  void add_factor(std::span<const float> factor) {
    factor_rows.push_back(factor.empty() ? -1 : factor_count());
    factors.insert(factors.end(), factor.begin(), factor.end());
  }
};

/// Progressive widening over components in order of relevance: sample n (from 0) is one of the
/// first `first + growth * n`.
struct Widening {
  double first = 0;  ///< 0: all components from the first sample, as in the paper
  double growth = 0;
};

/// Picks a component with equal probability, then samples a configuration from it. `sigma` is the
/// standard deviation of components without a factor, >= 0: radians, and half as many metres for
/// prismatic joints. Continuous joints wrap, the others clamp to their limits. The mixture must
/// have components.
[[nodiscard]] std::unique_ptr<Sampler> make_mixture_sampler(
    const Robot& robot, std::shared_ptr<const GaussianMixture> mixture, double sigma,
    const Widening& widening = {});

/// The first `count` samples of a stream are from `first`. Then `make_rest` is called, once per
/// stream, for the sampler of all further ones: a query that is solved quickly pays nothing for
/// what takes time to prepare. Sources are those of the sampler that gave the sample.
[[nodiscard]] std::unique_ptr<Sampler> make_lazy_sampler(
    std::shared_ptr<const Sampler> first, int count,
    std::function<std::shared_ptr<const Sampler>()> make_rest);

/// Components of a mixture that are made when one is first sampled, in groups of equally likely
/// ones in order of relevance. Const is parallel-safe.
class ComponentSource {
 public:
  /// Samples after which one more group takes part: the more relevant groups are tried first, and
  /// fewer components are made for nothing.
  static constexpr int kSamplesPerGroup = 1000;

  virtual ~ComponentSource() = default;
  [[nodiscard]] virtual int group_count() const = 0;
  /// Groups that take part from the first sample on.
  [[nodiscard]] virtual int first_groups() const { return 1; }
  [[nodiscard]] virtual int component_count(int group) const = 0;
  /// The source that samples of a group's components have.
  [[nodiscard]] virtual SampleSource sample_source(int group) const = 0;
  /// Writes a mean, within the limits; false if the component has nothing to say.
  [[nodiscard]] virtual bool make(int group, int component, std::span<float> mean) const = 0;
  /// The row of GaussianMixture::factors that shapes it; empty for the sampler's sigma.
  [[nodiscard]] virtual std::span<const float> factor(int group, int component) const = 0;
};

/// Samples from the groups of `source` that take part, all their components with equal probability,
/// as make_mixture_sampler() does; uniformly if none of them has a mean.
[[nodiscard]] std::unique_ptr<Sampler> make_component_sampler(
    const Robot& robot, std::shared_ptr<const ComponentSource> source, double sigma);

/// A sampler that takes part in a mixed one, with a probability that falls from `lambda` with the
/// number n of samples from it in the stream: lambda * h / (h + n), but at least the floor f =
/// `least_lambda`; h = 25000 f, at least 500. The probabilities of all sources are at most 1.
///
/// No regret: with a single useless source and 0 < f < 1, the expected number of samples until the
/// rest has given U of them is at most U / (1 - f) + max(0, n0) + 1, where n0 = h (lambda / f - 1),
/// which is 25000 (lambda - f) for f >= 0.02. Proof: lambda has fallen to f once n >= n0. At most
/// n0 + 1 samples from the source come before that; from then on each sample is from it with
/// probability f, so that f / (1 - f) of them are expected between two of the rest. With 0.8 and
/// 0.2 a useless memory costs at most a quarter more samples plus 15,001, with 0.5 and 0.02 a
/// fortieth more plus 12,001. If a planner is not slower for having seen more samples, the same
/// holds for its iterations.
struct MixedSource {
  std::shared_ptr<const Sampler> sampler;
  double lambda = 0;
  double least_lambda = 0;
};

/// Algorithm 1, line 2: from each of the sources with its probability, otherwise from `rest`.
[[nodiscard]] std::unique_ptr<Sampler> make_mixed_sampler(std::vector<MixedSource> sources,
                                                          std::shared_ptr<const Sampler> rest);
/// With probability `lambda` in [0, 1], which stays, from `first`, otherwise from `second`.
[[nodiscard]] std::unique_ptr<Sampler> make_mixed_sampler(double lambda,
                                                          std::shared_ptr<const Sampler> first,
                                                          std::shared_ptr<const Sampler> second);

}  // namespace mneme
