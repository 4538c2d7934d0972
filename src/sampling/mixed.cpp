// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

namespace mneme {
namespace {

/// Algorithm 1, lines 2 to 6.
class MixedStream final : public SampleStream {
 public:
  MixedStream(double lambda, std::unique_ptr<SampleStream> first,
              std::unique_ptr<SampleStream> second, std::uint64_t seed)
      : lambda_(lambda), first_(std::move(first)), second_(std::move(second)), rng_(seed) {}

  Origin next(std::span<float> q) override {
    SampleStream* stream = rng_.uniform() < lambda_ ? first_.get() : second_.get();
    const Origin origin = stream->next(q);
    const std::size_t place = place_of(origin);
    if (place >= sources_.size() && place < kMostOrigins) sources_.resize(place + 1);
    if (place < sources_.size()) sources_[place] = stream;
    return origin;
  }

  /// Goes to the stream that drew from this origin last.
  void report(Origin origin, SampleOutcome outcome) override {
    if (place_of(origin) >= sources_.size()) return;
    if (SampleStream* stream = sources_[place_of(origin)]) stream->report(origin, outcome);
  }

 private:
  /// Of those beyond nobody keeps the source.
  static constexpr std::size_t kMostOrigins = 1 << 20;

  static std::size_t place_of(Origin origin) {
    return static_cast<std::size_t>(std::int64_t{origin} - kUniformOrigin);
  }

  double lambda_;
  std::unique_ptr<SampleStream> first_, second_;
  std::vector<SampleStream*> sources_;  ///< by place_of() an origin; null for what was not drawn
  Rng rng_;
};

class MixedSampler final : public Sampler {
 public:
  MixedSampler(double lambda, std::shared_ptr<const Sampler> first,
               std::shared_ptr<const Sampler> second)
      : lambda_(lambda), first_(std::move(first)), second_(std::move(second)) {}

  std::unique_ptr<SampleStream> start(std::uint64_t seed) const override {
    return std::make_unique<MixedStream>(lambda_, first_->start(derive_seed(seed, 1)),
                                         second_->start(derive_seed(seed, 2)),
                                         derive_seed(seed, 3));
  }

 private:
  double lambda_;
  std::shared_ptr<const Sampler> first_, second_;
};

}  // namespace

std::unique_ptr<Sampler> make_mixed_sampler(double lambda, std::shared_ptr<const Sampler> first,
                                            std::shared_ptr<const Sampler> second) {
  return std::make_unique<MixedSampler>(lambda, std::move(first), std::move(second));
}

}  // namespace mneme
