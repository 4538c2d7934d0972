// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "sampling/sampler_of.h"

#include <algorithm>
#include <cstddef>

namespace mneme {
namespace {

/// Number of samples from a source that halve its lambda. A lower floor is reached faster, so that
/// the decline costs about the same number of samples for every floor.
double samples_to_half(double least_lambda) {
  constexpr double kSamples = 25000, kLeast = 500;
  return std::max(kSamples * least_lambda, kLeast);
}

/// Algorithm 1, lines 2 to 6.
class MixedStream final : public SampleStream {
 public:
  MixedStream(const std::vector<MixedSource>& sources, const Sampler& rest, std::uint64_t seed)
      : rng_(derive_seed(seed, sources.size() + 2)) {
    for (const MixedSource& source : sources) {
      const std::uint64_t own_seed = derive_seed(seed, streams_.size() + 1);
      streams_.push_back({source, source.sampler->start(own_seed)});
    }
    streams_.push_back({{}, rest.start(derive_seed(seed, streams_.size() + 1))});
  }

  SampleSource next(std::span<float> q) override {
    SampleStream* stream = choose();
    const SampleSource source = stream->next(q);
    const std::size_t place = place_of(source);
    if (place >= stream_of_.size() && place < kMostSources) stream_of_.resize(place + 1);
    if (place < stream_of_.size()) stream_of_[place] = stream;
    return source;
  }

  /// Reports to the stream that used this source last.
  void report(SampleSource source, SampleOutcome outcome) override {
    if (place_of(source) >= stream_of_.size()) return;
    if (SampleStream* stream = stream_of_[place_of(source)]) stream->report(source, outcome);
  }

 private:
  /// Sources at or above this index are not tracked; their reports are dropped.
  static constexpr std::size_t kMostSources = 1 << 20;

  struct Weighted {
    MixedSource source;
    std::unique_ptr<SampleStream> stream;
    double samples = 0;

    [[nodiscard]] double lambda() const {
      const double half = samples_to_half(source.least_lambda);
      const double falling = source.lambda * half / (half + samples);
      return std::max(std::min(source.lambda, source.least_lambda), falling);
    }
  };

  SampleStream* choose() {
    double remaining = rng_.uniform();
    for (std::size_t i = 0; i + 1 < streams_.size(); ++i) {
      Weighted& weighted = streams_[i];
      const double lambda = weighted.lambda();
      if (remaining < lambda) {
        ++weighted.samples;
        return weighted.stream.get();
      }
      remaining -= lambda;
    }
    return streams_.back().stream.get();
  }

  static std::size_t place_of(SampleSource source) {
    return static_cast<std::size_t>(std::int64_t{source} - kUniformSource);
  }

  std::vector<Weighted> streams_;         ///< the rest is the last
  std::vector<SampleStream*> stream_of_;  ///< by place_of(); null for a source without samples
  Rng rng_;
};

}  // namespace

std::unique_ptr<Sampler> make_mixed_sampler(std::vector<MixedSource> sources,
                                            std::shared_ptr<const Sampler> rest) {
  return internal::sampler_of(
      [sources = std::move(sources), rest = std::move(rest)](std::uint64_t seed) {
        return std::make_unique<MixedStream>(sources, *rest, seed);
      });
}

std::unique_ptr<Sampler> make_mixed_sampler(double lambda, std::shared_ptr<const Sampler> first,
                                            std::shared_ptr<const Sampler> second) {
  return make_mixed_sampler({{std::move(first), lambda, lambda}}, std::move(second));
}

}  // namespace mneme
