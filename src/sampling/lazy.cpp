// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "sampling/sampler_of.h"

namespace mneme {
namespace {

using MakeSampler = std::function<std::shared_ptr<const Sampler>()>;

class LazyStream final : public SampleStream {
 public:
  LazyStream(std::unique_ptr<SampleStream> first, int count, const MakeSampler& make_rest,
             std::uint64_t seed)
      : stream_(std::move(first)), left_(count), make_rest_(make_rest), seed_(seed) {}

  SampleSource next(std::span<float> q) override {
    if (left_ > 0) {
      --left_;
    } else if (!rest_) {
      rest_ = make_rest_();
      stream_ = rest_->start(seed_);
    }
    return stream_->next(q);
  }

  void report(SampleSource source, SampleOutcome outcome) override {
    stream_->report(source, outcome);
  }

 private:
  std::shared_ptr<const Sampler> rest_;  ///< outlives its stream
  std::unique_ptr<SampleStream> stream_;
  int left_;
  const MakeSampler& make_rest_;
  std::uint64_t seed_;
};

}  // namespace

std::unique_ptr<Sampler> make_lazy_sampler(std::shared_ptr<const Sampler> first, int count,
                                           MakeSampler make_rest) {
  return internal::sampler_of([first = std::move(first), count,
                               make_rest = std::move(make_rest)](std::uint64_t seed) {
    return std::make_unique<LazyStream>(first->start(seed), count, make_rest, derive_seed(seed, 1));
  });
}

}  // namespace mneme
