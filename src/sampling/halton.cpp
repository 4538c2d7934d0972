// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "robot/joint_space.h"
#include "sampling/sampler_of.h"

#include <cmath>

namespace mneme {
namespace {

std::vector<std::uint32_t> first_primes(int count) {
  std::vector<std::uint32_t> primes;
  for (std::uint32_t candidate = 2; static_cast<int>(primes.size()) < count; ++candidate) {
    bool is_prime = true;
    for (const std::uint32_t p : primes) is_prime = is_prime && candidate % p != 0;
    if (is_prime) primes.push_back(candidate);
  }
  return primes;
}

/// The digits of `index` in `base`, mirrored at the point.
double radical_inverse(std::uint64_t index, std::uint32_t base) {
  double result = 0, weight = 1;
  for (; index > 0; index /= base) {
    weight /= base;
    result += weight * static_cast<double>(index % base);
  }
  return result;
}

class HaltonStream final : public SampleStream {
 public:
  HaltonStream(const internal::JointSpace& space, const std::vector<std::uint32_t>& primes,
               std::uint64_t seed)
      : space_(space), primes_(primes) {
    Rng rng(seed);
    for (int i = 0; i < space.joint_count(); ++i) shift_.push_back(rng.uniform());
  }

  SampleSource next(std::span<float> q) override {
    ++index_;
    for (int i = 0; i < space_.joint_count(); ++i) {
      const auto j = static_cast<std::size_t>(i);
      const double shifted = radical_inverse(index_, primes_[j]) + shift_[j];
      const double fraction = shifted - std::floor(shifted);
      q[j] = space_.into_limits(
          i, static_cast<float>(space_.lower(i) + (space_.upper(i) - space_.lower(i)) * fraction));
    }
    return kUniformSource;
  }

 private:
  const internal::JointSpace& space_;
  const std::vector<std::uint32_t>& primes_;
  std::vector<double> shift_;
  std::uint64_t index_ = 0;
};

}  // namespace

std::unique_ptr<Sampler> make_halton_sampler(const Robot& robot) {
  return internal::sampler_of([space = internal::JointSpace(robot),
                               primes = first_primes(robot.joint_count())](std::uint64_t seed) {
    return std::make_unique<HaltonStream>(space, primes, seed);
  });
}

}  // namespace mneme
