// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The sampler of one query that uses memory: retrieves when the planner has sampled long enough
/// without.
#pragma once

#include "pipeline/drawn_components.h"
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

/// Algorithm 2 for one kind of memory: its components for the query, and in `gl` what it found.
using Recall = std::function<Result<Recalled>(const Query&, const MemoryQuery&, const KindSettings&,
                                              GlSampler&)>;

/// Asks memory, once only, whichever of the sampler's streams asks first and from whichever thread.
class MemorySampler {
 public:
  /// One of the samplers that are mixed with uniform samples.
  struct Source {
    double lambda = 0;
    double least_lambda = 0;
    int after = 0;  ///< iterations before it is asked
    /// Null if there is nothing to draw from.
    std::function<Result<std::shared_ptr<const Sampler>>()> ask;
  };

  /// When a sampler queries memory: after `retrieve_after` samples, or as soon as it is made. Only
  /// the latter's samplers may outlive this.
  enum class Timing { lazy, at_once };

  /// Refers to the query.
  MemorySampler(const ResolvedQuery& resolved, Recall recall, Timing timing = Timing::lazy)
      : resolved_(resolved),
        memory_query_(memory_query(resolved.query.problem, resolved.ends.goals)),
        recall_(std::move(recall)),
        timing_(timing) {}

  [[nodiscard]] const Query& query() const { return resolved_.query; }
  [[nodiscard]] const MemoryQuery& asked() const { return memory_query_; }

  /// Algorithm 1 over `recall` for each kind of memory of the query. Refers to this.
  [[nodiscard]] std::shared_ptr<const Sampler> draw_by_kind();
  /// Algorithm 1 over one mixture that needs no retrieval by kind, such as a baseline's.
  [[nodiscard]] std::shared_ptr<const Sampler> draw_mixture(
      std::function<Result<GaussianMixture>()> recall);
  /// The same over any sampler.
  [[nodiscard]] std::shared_ptr<const Sampler> draw_from(
      std::function<Result<std::shared_ptr<const Sampler>>()> make);

  /// The query's sampler. Error: memory that is queried at once fails.
  [[nodiscard]] Result<std::shared_ptr<const Sampler>> make();
  /// Error: memory failed before some stream had sampled `draws` times; others may have sampled
  /// more.
  [[nodiscard]] Result<void> check(std::uint64_t draws = kAny) const;
  [[nodiscard]] double time_s() const { return time_s_; }  ///< of make()
  /// The least number of samples before the settings want a source of the sampler to be queried; 0
  /// without a source.
  [[nodiscard]] int retrieve_after() const { return retrieve_after_; }
  /// What was found for such a stream; with the components that any stream has drawn from until now
  /// where they are made then.
  [[nodiscard]] GlSampler take(std::uint64_t draws = kAny);

 private:
  static constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();

  [[nodiscard]] std::shared_ptr<const Sampler> draw(std::vector<Source> sources);
  /// What a planner draws from after so many samples.
  [[nodiscard]] std::shared_ptr<const Sampler> drawn_after(int samples);
  [[nodiscard]] std::shared_ptr<const Sampler> mixed() const;
  /// How much was known before a source was asked, and why that failed.
  struct Mark {
    int after = 0;
    std::size_t primitives = 0;
    std::size_t drawn = 0;
    std::shared_ptr<const GaussianMixture> mixture;
    std::optional<Error> failure = {};

    [[nodiscard]] bool is_within(std::uint64_t draws) const {
      return after == 0 || static_cast<std::uint64_t>(after) < draws;
    }
  };
  void ask(const Source& source);
  /// Adds the components to what was found, and samples them as the kind says; null if there are
  /// none.
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
  std::vector<Source> sources_;  ///< those that are asked first, first
  std::mutex mutex_;
  std::size_t asked_ = 0;
  std::vector<MixedSource> samplers_;
  std::vector<std::pair<int, std::shared_ptr<const Sampler>>> stages_;  ///< by `after`
  std::vector<std::shared_ptr<const DrawnComponents>> drawn_;
  GlSampler gl_;
  std::vector<Mark> marks_;  ///< of the sources that were asked
};

}  // namespace mneme::internal
