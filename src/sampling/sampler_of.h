// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Samplers made of a function that starts a stream.
#pragma once

#include "mneme/sampling.h"

#include <utility>

namespace mneme::internal {

template <class Start>
class StartedSampler final : public Sampler {
 public:
  explicit StartedSampler(Start start) : start_(std::move(start)) {}
  std::unique_ptr<SampleStream> start(std::uint64_t seed) const override { return start_(seed); }

 private:
  Start start_;
};

/// Returns a sampler that starts streams by `start(seed)`. Streams may refer to what `start`
/// captures.
template <class Start>
[[nodiscard]] std::unique_ptr<Sampler> sampler_of(Start start) {
  return std::make_unique<StartedSampler<Start>>(std::move(start));
}

}  // namespace mneme::internal
