// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/ompl.h"

#include "ompl/planner_table.h"

#include <ompl/base/samplers/BridgeTestValidStateSampler.h>
#include <ompl/base/samplers/GaussianValidStateSampler.h>
#include <ompl/base/samplers/MaximizeClearanceValidStateSampler.h>
#include <ompl/base/samplers/ObstacleBasedValidStateSampler.h>

#include <algorithm>
#include <array>

namespace mneme {
namespace ompl {
namespace {

namespace ob = ::ompl::base;

template <class Sampler>
ob::ValidStateSamplerPtr make(const ob::SpaceInformation* information, double deviation) {
  auto sampler = std::make_shared<Sampler>(information);
  if constexpr (requires { sampler->setStdDev(deviation); }) {
    if (deviation > 0) sampler->setStdDev(deviation);
  }
  return sampler;
}

struct ValidSampler {
  std::string_view name;
  std::string_view summary;
  ob::ValidStateSamplerPtr (*make)(const ob::SpaceInformation* information, double deviation);
};

constexpr std::array<ValidSampler, 4> kSamplers = {{
    {"gaussian", "OMPL's sampler of valid states near obstacles",
     make<ob::GaussianValidStateSampler>},
    {"obstacle_based", "OMPL's sampler of valid states at obstacles",
     make<ob::ObstacleBasedValidStateSampler>},
    {"bridge_test", "OMPL's sampler of valid states between obstacles",
     make<ob::BridgeTestValidStateSampler>},
    {"max_clearance", "OMPL's sampler of valid states far from obstacles",
     make<ob::MaximizeClearanceValidStateSampler>},
}};

}  // namespace

ob::ValidStateSamplerAllocator valid_sampler_allocator(std::string_view name, double deviation) {
  const auto sampler = std::ranges::find(kSamplers, name, &ValidSampler::name);
  if (sampler == kSamplers.end()) return {};
  return [make = sampler->make, deviation](const ob::SpaceInformation* information) {
    return make(information, deviation);
  };
}

void add_valid_samplers() {
  std::vector<SamplerEntry> entries;
  for (const ValidSampler& sampler : kSamplers) {
    entries.push_back(
        {.name = sampler.name, .summary = sampler.summary, .samples_valid_states = true});
  }
  add_samplers(entries);
}

}  // namespace ompl
}  // namespace mneme
