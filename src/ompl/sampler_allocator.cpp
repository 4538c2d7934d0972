// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include "ompl/states.h"

#include <atomic>

namespace mneme::ompl {
namespace {

namespace ob = ::ompl::base;

class StreamSampler final : public ob::StateSampler {
 public:
  StreamSampler(const ob::StateSpace* space, std::shared_ptr<const Sampler> sampler,
                std::uint64_t seed)
      : StateSampler(space),
        values_(space),
        near_(space->allocDefaultStateSampler()),
        sampler_(std::move(sampler)),
        stream_(sampler_->start(seed)),
        q_(space->getValueLocations().size()) {}

  void sampleUniform(ob::State* state) override {
    stream_->next(q_);
    values_.write(q_, state);
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    near_->sampleUniformNear(state, near, distance);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    near_->sampleGaussian(state, mean, deviation);
  }

 private:
  JointValues values_;
  ob::StateSamplerPtr near_;
  std::shared_ptr<const Sampler> sampler_;
  std::unique_ptr<SampleStream> stream_;
  std::vector<float> q_;
};

class CountingSampler final : public ob::StateSampler {
 public:
  CountingSampler(const ob::StateSpace* space, ob::StateSamplerPtr sampler,
                  std::shared_ptr<WorkCounters> counters)
      : StateSampler(space), sampler_(std::move(sampler)), counters_(std::move(counters)) {}

  void sampleUniform(ob::State* state) override {
    count();
    sampler_->sampleUniform(state);
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    count();
    sampler_->sampleUniformNear(state, near, distance);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    count();
    sampler_->sampleGaussian(state, mean, deviation);
  }

 private:
  void count() { counters_->samples.fetch_add(1, std::memory_order_relaxed); }
  ob::StateSamplerPtr sampler_;
  std::shared_ptr<WorkCounters> counters_;
};

}  // namespace

ob::StateSamplerAllocator count_samples(ob::StateSamplerAllocator allocator,
                                        std::shared_ptr<WorkCounters> counters) {
  return [=](const ob::StateSpace* space) -> ob::StateSamplerPtr {
    ob::StateSamplerPtr sampler = allocator ? allocator(space) : space->allocDefaultStateSampler();
    return std::make_shared<CountingSampler>(space, std::move(sampler), counters);
  };
}

ob::StateSamplerAllocator sampler_allocator(std::shared_ptr<const Sampler> sampler,
                                            std::uint64_t seed) {
  const auto count = std::make_shared<std::atomic<std::uint64_t>>(0);
  return [=](const ob::StateSpace* space) -> ob::StateSamplerPtr {
    const std::uint64_t task = count->fetch_add(1, std::memory_order_relaxed);
    return std::make_shared<StreamSampler>(space, sampler, derive_seed(seed, task));
  };
}

Result<ob::StateSamplerAllocator> gl_sampler_allocator(const Problem& problem, Database& database,
                                                       const SolveSettings& settings) {
  return make_sampler(problem, &database, settings)
      .map([&](std::shared_ptr<const Sampler> sampler) {
        return sampler_allocator(std::move(sampler), settings.plan.seed);
      });
}

}  // namespace mneme::ompl
