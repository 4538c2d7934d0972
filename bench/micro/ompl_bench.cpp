// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include "micro/suite.h"

namespace mneme::bench {
namespace {

constexpr int kDraws = 1000;
constexpr int kComponents = 1000;

std::shared_ptr<const Sampler> make_memory(const Robot& robot) {
  auto mixture = std::make_shared<GaussianMixture>();
  mixture->joint_count = robot.joint_count();
  mixture->means.resize(static_cast<std::size_t>(kComponents * robot.joint_count()));
  const auto uniform = make_uniform_sampler(robot);
  const auto stream = uniform->start(1);
  const auto joints = static_cast<std::size_t>(robot.joint_count());
  for (std::size_t i = 0; i < kComponents; ++i) {
    stream->next(std::span(mixture->means).subspan(i * joints, joints));
  }
  return make_mixed_sampler(0.5, make_mixture_sampler(robot, std::move(mixture), 0.05),
                            make_uniform_sampler(robot));
}

/// Draws as OMPL's planners do, from what `allocator` allocates (empty: OMPL's own).
void register_state_sampler(const std::string& name, const Robot& robot,
                            const ::ompl::base::StateSamplerAllocator& allocator) {
  const auto space = std::make_shared<ompl::JointStateSpace>(robot);
  space->setup();
  if (allocator) space->setStateSamplerAllocator(allocator);
  register_repeated(name, "sample", [space, sampler = space->allocStateSampler()] {
    ::ompl::base::ScopedState<> state(space);
    for (int i = 0; i < kDraws; ++i) {
      sampler->sampleUniform(state.get());
      benchmark::DoNotOptimize(state.get());
    }
    return std::uint64_t{kDraws};
  });
}

void register_stream(const std::string& name, const Robot& robot,
                     std::shared_ptr<const Sampler> sampler) {
  register_repeated(
      name, "sample",
      [sampler, stream = std::shared_ptr<SampleStream>(sampler->start(1)),
       q = std::vector<float>(static_cast<std::size_t>(robot.joint_count()))]() mutable {
        for (int i = 0; i < kDraws; ++i) {
          benchmark::DoNotOptimize(stream->next(q));
        }
        return std::uint64_t{kDraws};
      });
}

}  // namespace

void register_ompl(const Robot& robot) {
  const std::shared_ptr<const Sampler> uniform = make_uniform_sampler(robot);
  const std::shared_ptr<const Sampler> memory = make_memory(robot);
  register_state_sampler("ompl/own_uniform", robot, {});
  register_state_sampler("ompl/adapter_uniform", robot, ompl::sampler_allocator(uniform));
  register_state_sampler("ompl/adapter_memory", robot, ompl::sampler_allocator(memory));
  register_stream("ompl/without_adapter_uniform", robot, uniform);
  register_stream("ompl/without_adapter_memory", robot, memory);
}

}  // namespace mneme::bench
