// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace mneme {
namespace {

constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15;

/// The output function of splitmix64: a bijection that spreads every input bit.
std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
  return z ^ (z >> 31);
}

constexpr std::size_t kLayerCount = 256;
/// Start of the tail: with it, 256 layers of equal area end exactly at the peak of the density.
constexpr double kTailStart = 3.6541528853610088;

double density(double x) { return std::exp(-0.5 * x * x); }

/// Layer `i` is the rectangle [0, width[i]) x [height[i], height[i + 1]) around the unnormalised
/// density. Layer 0 is the strip below; its width includes the area of the tail.
struct Ziggurat {
  std::array<double, kLayerCount + 1> width;
  std::array<double, kLayerCount + 1> height;

  Ziggurat() {
    const double tail_area =
        std::sqrt(0.5 * std::numbers::pi) * std::erfc(kTailStart / std::numbers::sqrt2);
    const double layer_area = kTailStart * density(kTailStart) + tail_area;
    width[0] = layer_area / density(kTailStart);
    height[0] = 0;
    width[1] = kTailStart;
    height[1] = density(kTailStart);
    for (std::size_t i = 2; i < kLayerCount; ++i) {
      height[i] = height[i - 1] + layer_area / width[i - 1];
      width[i] = std::sqrt(-2 * std::log(height[i]));
    }
    width[kLayerCount] = 0;
    height[kLayerCount] = 1;
  }
};

const Ziggurat& ziggurat() {
  static const Ziggurat instance;
  return instance;
}

/// Marsaglia's exact method for the tail beyond kTailStart.
double sample_tail(Rng& rng) {
  for (;;) {
    // 1 - uniform() is in (0, 1], where the logarithm is finite.
    const double x = -std::log(1 - rng.uniform()) / kTailStart;
    const double y = -std::log(1 - rng.uniform());
    if (2 * y > x * x) return kTailStart + x;
  }
}

}  // namespace

Rng::Rng(std::uint64_t seed) : state_{} {
  for (std::uint64_t& word : state_) {
    seed += kGoldenRatio;
    word = mix(seed);
  }
}

double Rng::normal() {
  const Ziggurat& table = ziggurat();
  for (;;) {
    // Layer, sign and position come from disjoint bits, so that they are independent.
    const std::uint64_t bits = next();
    const std::size_t layer = bits % kLayerCount;
    const double sign = (bits & kLayerCount) != 0 ? -1.0 : 1.0;
    const double x = static_cast<double>(bits >> 11) * 0x1.0p-53 * table.width[layer];
    if (x < table.width[layer + 1]) return sign * x;
    if (layer == 0) return sign * sample_tail(*this);
    if (uniform(table.height[layer], table.height[layer + 1]) < density(x)) return sign * x;
  }
}

float Rng::bell() {
  constexpr std::uint64_t kEvenBytes = 0x00ff00ff00ff00ff, kSumOfLanes = 0x0001000100010001;
  const std::uint64_t bytes = next();
  const std::uint64_t lanes = (bytes & kEvenBytes) + ((bytes >> 8) & kEvenBytes);
  const auto sum = static_cast<float>((lanes * kSumOfLanes) >> 48);
  constexpr float kMean = 8 * 127.5f;
  constexpr float kDeviation = 209.0215f;  // sqrt(8 (256^2 - 1) / 12)
  return (sum - kMean) / kDeviation;
}

std::uint64_t derive_seed(std::uint64_t seed, std::uint64_t task) {
  return mix(mix(seed + kGoldenRatio) + kGoldenRatio * (task + 1));
}

}  // namespace mneme
