// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include "ompl/planner_table.h"

#include <ompl/base/samplers/BridgeTestValidStateSampler.h>
#include <ompl/base/samplers/GaussianValidStateSampler.h>
#include <ompl/base/samplers/MaximizeClearanceValidStateSampler.h>
#include <ompl/base/samplers/ObstacleBasedValidStateSampler.h>

#include <array>

namespace mneme {
namespace ompl {
namespace {

namespace ob = ::ompl::base;

constexpr std::array<std::string_view, 4> kSamplers = {"gaussian", "obstacle_based", "bridge_test",
                                                       "max_clearance"};

template <class Sampler>
ob::ValidStateSamplerPtr make(const ob::SpaceInformation* information, double deviation) {
  auto sampler = std::make_shared<Sampler>(information);
  if constexpr (requires { sampler->setStdDev(deviation); }) {
    if (deviation > 0) sampler->setStdDev(deviation);
  }
  return sampler;
}

}  // namespace

ob::ValidStateSamplerAllocator valid_sampler_allocator(std::string_view name, double deviation) {
  using Make = ob::ValidStateSamplerPtr (*)(const ob::SpaceInformation*, double);
  constexpr std::array<Make, kSamplers.size()> kMakers = {
      make<ob::GaussianValidStateSampler>, make<ob::ObstacleBasedValidStateSampler>,
      make<ob::BridgeTestValidStateSampler>, make<ob::MaximizeClearanceValidStateSampler>};
  for (std::size_t i = 0; i < kSamplers.size(); ++i) {
    if (kSamplers[i] != name) continue;
    return [make = kMakers[i], deviation](const ob::SpaceInformation* information) {
      return make(information, deviation);
    };
  }
  return {};
}

}  // namespace ompl
}  // namespace mneme
