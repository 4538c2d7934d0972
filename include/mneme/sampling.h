// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Sources of configurations for sampling-based planners. Planners know only this interface.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace mneme {

/// Which source a configuration came from: kUniformOrigin, or the index of a local sampler.
using Origin = int;
inline constexpr Origin kUniformOrigin = -1;

/// What a planner did with a configuration.
enum class SampleOutcome { rejected, extended, connected };

/// One query's stream of configurations. Refers to its sampler, which must outlive it. Not
/// thread-safe.
class SampleStream {
 public:
  virtual ~SampleStream() = default;
  /// Writes a configuration within the joint limits into `q` (joint_count() values).
  virtual Origin next(std::span<float> q) = 0;
  /// Tells the source what became of one of its configurations, in any order.
  virtual void report(Origin, SampleOutcome) {}
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

/// A Gaussian mixture with equiprobable components, eq. (1) of the paper. Means are float32,
/// row-major.
struct GaussianMixture {
  int joint_count = 0;
  std::vector<float> means;  ///< component_count() rows of joint_count values
  /// Per component the row of `factors` that shapes it, or -1 for the sampler's sigma; empty: all
  /// -1.
  std::vector<int> factor_rows;
  /// Rows of joint_count * (joint_count + 1) / 2 values: lower triangles, row by row, of Cholesky
  /// factors L of covariances L L^T.
  std::vector<float> factors;
  std::vector<Origin> origins;  ///< per component the source it counts for; empty: all 0

  [[nodiscard]] int component_count() const {
    return joint_count == 0 ? 0 : static_cast<int>(means.size()) / joint_count;
  }
};

/// Progressive widening over components in order of relevance: the n-th draw (from 0) is one of the
/// first `first + growth * n`.
struct Widening {
  double first = 0;  ///< 0: all components from the first draw, as in the paper
  double growth = 0;
};

/// Draws a component with equal probability, then a configuration from it. `sigma` is the standard
/// deviation of components without a factor, >= 0: radians, and half as many metres for prismatic
/// joints. Continuous joints wrap, the others clamp to their limits. The mixture must have
/// components.
[[nodiscard]] std::unique_ptr<Sampler> make_mixture_sampler(
    const Robot& robot, std::shared_ptr<const GaussianMixture> mixture, double sigma,
    const Widening& widening = {});

/// The first `count` draws of a stream are from `first`; then `make_rest` is asked, once per
/// stream, for the sampler of all further ones: what is found quickly pays nothing for what takes
/// time to prepare. Origins are those of the sampler that was drawn from.
[[nodiscard]] std::unique_ptr<Sampler> make_lazy_sampler(
    std::shared_ptr<const Sampler> first, int count,
    std::function<std::shared_ptr<const Sampler>()> make_rest);

/// Algorithm 1, line 2: with probability `lambda` in [0, 1] from `first`, otherwise from `second`.
[[nodiscard]] std::unique_ptr<Sampler> make_mixed_sampler(double lambda,
                                                          std::shared_ptr<const Sampler> first,
                                                          std::shared_ptr<const Sampler> second);

}  // namespace mneme
