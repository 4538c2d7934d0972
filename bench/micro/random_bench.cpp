// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "micro/suite.h"

namespace mneme::bench {
namespace {

constexpr int kDraws = 1000;

template <class Draw>
void register_draws(const std::string& name, const Draw& draw) {
  register_repeated(name, "number", [draw, rng = Rng(1)]() mutable {
    for (int i = 0; i < kDraws; ++i) benchmark::DoNotOptimize(draw(rng));
    return std::uint64_t{kDraws};
  });
}

}  // namespace

void register_random() {
  register_draws("random/uniform", [](Rng& rng) { return rng.uniform(-1.0, 1.0); });
  register_draws("random/normal", [](Rng& rng) { return rng.normal(); });
}

}  // namespace mneme::bench
