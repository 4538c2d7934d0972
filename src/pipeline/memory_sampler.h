// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The sampler of one query that uses memory.
#pragma once

#include "memory/sampled_components.h"
#include "pipeline/memory_steps.h"
#include "pipeline/resolve_goals.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace mneme::internal {

/// Algorithm 2 for one kind of memory: returns its components and adds its matches to `gl`.
using Recall = std::function<Result<Recalled>(const Query&, const MemoryQuery&, const KindSettings&,
                                              GlSampler&)>;

/// Queries memory once, after the first stream has taken the number of samples in the settings.
/// Streams may belong to different threads.
class MemorySampler {
 public:
  /// A sampler to mix with uniform samples.
  struct Source {
    double lambda = 0;
    double least_lambda = 0;
    int after = 0;  ///< number of samples before `make` is called
    std::function<Result<std::shared_ptr<const Sampler>>()> make;  ///< may return null: no sampler
  };

  /// Queries memory after `retrieve_after` samples (lazy), or at once. Samplers of lazy queries
  /// must not outlive this object.
  enum class Timing { lazy, at_once };

  /// Refers to the query.
  MemorySampler(const ResolvedQuery& resolved, Recall recall, Timing timing = Timing::lazy)
      : resolved_(resolved),
        memory_query_(
            mneme::memory_query(resolved.query.problem, resolved.ends.start, resolved.ends.goals)),
        recall_(std::move(recall)),
        timing_(timing) {}

  [[nodiscard]] const Query& query() const { return resolved_.query; }
  [[nodiscard]] const MemoryQuery& memory_query() const { return memory_query_; }

  /// Returns Algorithm 1 over `recall` for each kind of memory of the query. This object must
  /// outlive the sampler.
  [[nodiscard]] std::shared_ptr<const Sampler> by_kind();
  /// Returns Algorithm 1 over one mixture that needs no retrieval by kind, such as a baseline's.
  [[nodiscard]] std::shared_ptr<const Sampler> from_mixture(
      std::function<Result<GaussianMixture>()> recall);
  /// Returns Algorithm 1 over any sampler.
  [[nodiscard]] std::shared_ptr<const Sampler> from_sampler(
      std::function<Result<std::shared_ptr<const Sampler>>()> make);

  /// Returns the query's sampler. Errors: those of the query to memory, if it is not lazy.
  [[nodiscard]] Result<std::shared_ptr<const Sampler>> make();
  /// Fails if one of the queries to memory that a stream of `samples` samples has made failed.
  [[nodiscard]] Result<void> check(std::uint64_t samples = kAny) const;
  [[nodiscard]] double time_s() const { return time_s_; }  ///< time spent in make()
  /// The number of samples before the first query to memory, by the settings; 0 without memory.
  [[nodiscard]] int retrieve_after() const { return retrieve_after_; }
  /// Returns the matches for a stream of `samples` samples. Components that are made on demand are
  /// those that any stream has sampled from.
  [[nodiscard]] GlSampler take(std::uint64_t samples = kAny);

 private:
  static constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();

  [[nodiscard]] std::shared_ptr<const Sampler> from_sources(std::vector<Source> sources);
  /// The sampler that replaces the current one after `samples` samples.
  [[nodiscard]] std::shared_ptr<const Sampler> sampler_after(int samples);
  [[nodiscard]] std::shared_ptr<const Sampler> mixed() const;
  /// State before a source was queried, and its error.
  struct Mark {
    int after = 0;
    std::size_t primitives = 0;
    std::size_t components = 0;
    std::shared_ptr<const GaussianMixture> mixture;
    std::optional<Error> failure = {};

    [[nodiscard]] bool is_within(std::uint64_t samples) const {
      return after == 0 || static_cast<std::uint64_t>(after) < samples;
    }
  };
  void query_source(const Source& source);
  /// Adds the components to the result and returns a sampler of them; null if there are none.
  [[nodiscard]] std::shared_ptr<const Sampler> sample(const KindSettings& kind, Recalled recalled);
  [[nodiscard]] std::shared_ptr<const Sampler> sample_mixture(const KindSettings& kind,
                                                              GaussianMixture mixture);
  void add_to_found(const GaussianMixture& mixture);

  const ResolvedQuery& resolved_;
  MemoryQuery memory_query_;
  Recall recall_;
  Timing timing_;
  int retrieve_after_ = 0;
  double time_s_ = 0;
  std::vector<Source> sources_;  ///< by `after`
  std::mutex mutex_;
  std::size_t queried_sources_ = 0;
  std::vector<MixedSource> samplers_;
  std::vector<std::pair<int, std::shared_ptr<const Sampler>>> stages_;  ///< by `after`
  std::vector<std::shared_ptr<const SampledComponents>> components_;
  GlSampler gl_;
  std::vector<Mark> marks_;  ///< per queried source
};

}  // namespace mneme::internal
