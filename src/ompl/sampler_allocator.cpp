// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>

#include "mneme/ompl.h"
#include "ompl/count_samples.h"
#include "ompl/joint_values.h"
#include "pipeline/complete_settings.h"
#include "pipeline/recall.h"
#include "pipeline/valid_components.h"

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

namespace {

/// Algorithm 1 with what was recalled. The settings are complete.
Result<ob::StateSamplerAllocator> allocate_from(Result<GlSampler> gl, const Robot& robot,
                                                const Scene& scene, const SolveSettings& settings) {
  if (!gl) return tl::unexpected(gl.error());
  if (settings.drop_invalid_means) {
    const auto checker =
        CollisionChecker::make(robot, scene, {settings.resolution, settings.margin, settings.isa});
    if (!checker) return tl::unexpected(checker.error());
    gl->mixture = std::make_shared<const GaussianMixture>(
        internal::keep_valid_components(*checker, *gl->mixture));
  }
  std::shared_ptr<const Sampler> sampler = internal::make_sampler(robot, settings, *gl);
  if (settings.retrieve_after > 0) {
    sampler = make_lazy_sampler(make_uniform_sampler(robot), settings.retrieve_after,
                                [rest = std::move(sampler)] { return rest; });
  }
  return sampler_allocator(std::move(sampler), settings.plan.seed);
}

}  // namespace

Result<ob::StateSamplerAllocator> gl_sampler_allocator(const Robot& robot, const Scene& scene,
                                                       Database& database,
                                                       const SolveSettings& asked) {
  const SolveSettings settings = internal::complete_settings(asked, robot, &database);
  return allocate_from(create_gl_sampler(robot, scene, database, settings), robot, scene, settings);
}

Result<ob::StateSamplerAllocator> gl_sampler_allocator(const Problem& problem, Database& database,
                                                       const SolveSettings& asked) {
  const SolveSettings settings = internal::complete_settings(asked, problem.robot, &database);
  return allocate_from(create_gl_sampler(problem, database, settings), problem.robot, problem.scene,
                       settings);
}

}  // namespace mneme::ompl
