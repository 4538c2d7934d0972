// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "pipeline/baseline_samplers.h"
#include "pipeline/cvae_sampler.h"
#include "pipeline/memory_sampler.h"

#include <algorithm>
#include <array>

namespace mneme {
namespace {

using internal::MemorySampler;
using SharedSampler = std::shared_ptr<const Sampler>;

SharedSampler uniform_source(MemorySampler& memory) {
  return make_uniform_sampler(memory.query().problem.robot);
}

SharedSampler halton_source(MemorySampler& memory) {
  return make_halton_sampler(memory.query().problem.robot);
}

SharedSampler gl(MemorySampler& memory) { return memory.draw_by_kind(); }

SharedSampler pooled(MemorySampler& memory) {
  return memory.draw_mixture([&memory] { return pool_all(memory.query(), memory.asked()); });
}

SharedSampler nearest_scenes(MemorySampler& memory) {
  return memory.draw_mixture(
      [&memory] { return recall_nearest_scenes(memory.query(), memory.asked()); });
}

SharedSampler cvae(MemorySampler& memory) {
  return memory.draw_from([&query = memory.query()]() -> Result<SharedSampler> {
    const auto weights = internal::load_cvae(internal::cvae_path(*query.database));
    if (!weights) return tl::unexpected(weights.error());
    return internal::make_cvae_sampler(query.problem.robot, query.problem.scene, *weights);
  });
}

// To add a sampler: what makes it, and a row here.
constexpr bool kFromMemory = true;
constexpr std::array<SamplerEntry, 10> kSamplers = {{
    {"gl", "what memory knows of the scene, mixed with uniform samples (Algorithm 1)", gl,
     kFromMemory},
    {"uniform", "uniform within the joint limits", uniform_source},
    {"halton", "a Halton sequence with a random shift", halton_source},
    {"pooled", "baseline: all components of the memory, wherever they were learned", pooled,
     kFromMemory},
    {"nearest_scenes", "baseline: components of the scenes that are most similar as a whole",
     nearest_scenes, kFromMemory},
    {"cvae", "baseline: a variational autoencoder that was trained on the memory", cvae,
     kFromMemory},
    {"gaussian", "OMPL's sampler of valid states near obstacles", uniform_source, false, true},
    {"obstacle_based", "OMPL's sampler of valid states at obstacles", uniform_source, false, true},
    {"bridge_test", "OMPL's sampler of valid states between obstacles", uniform_source, false,
     true},
    {"max_clearance", "OMPL's sampler of valid states far from obstacles", uniform_source, false,
     true},
}};

}  // namespace

std::span<const SamplerEntry> samplers() { return kSamplers; }

std::vector<std::string> sampler_names() {
  std::vector<std::string> names;
  const bool can_draw_valid_states =
      std::ranges::any_of(planners(), &PlannerEntry::draws_valid_states);
  for (const SamplerEntry& sampler : kSamplers) {
    if (can_draw_valid_states || !sampler.draws_valid_states) names.emplace_back(sampler.name);
  }
  return names;
}

Result<const SamplerEntry*> find_sampler(std::string_view name) {
  const auto found = std::ranges::find(kSamplers, name, &SamplerEntry::name);
  if (found != kSamplers.end()) return &*found;
  std::string known;
  const std::vector<std::string> names = sampler_names();
  for (const std::string& entry : names) known += (known.empty() ? "" : ", ") + entry;
  return fail(ErrorCode::invalid, "unknown sampler '" + std::string(name) + "': expected one of " +
                                      known + did_you_mean(name, names));
}

}  // namespace mneme
