// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "robot/joint_space.h"
#include "sampling/sampler_of.h"

namespace mneme {
namespace {

class UniformStream final : public SampleStream {
 public:
  UniformStream(const internal::JointSpace& space, std::uint64_t seed)
      : space_(space), rng_(seed) {}

  SampleSource next(std::span<float> q) override {
    for (int i = 0; i < space_.joint_count(); ++i) {
      const float fraction = static_cast<float>(rng_.next() >> 40) * 0x1.0p-24f;
      q[static_cast<std::size_t>(i)] =
          space_.lower(i) + (space_.upper(i) - space_.lower(i)) * fraction;
    }
    return kUniformSource;
  }

 private:
  const internal::JointSpace& space_;
  Rng rng_;
};

}  // namespace

std::unique_ptr<Sampler> make_uniform_sampler(const Robot& robot) {
  return internal::sampler_of([space = internal::JointSpace(robot)](std::uint64_t seed) {
    return std::make_unique<UniformStream>(space, seed);
  });
}

}  // namespace mneme
