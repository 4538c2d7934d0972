// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/pipeline.h"

#include "base/fail.h"
#include "pipeline/memory_sampler.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

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

SharedSampler gl(MemorySampler& memory) { return memory.by_kind(); }

// To add a sampler: its function and a row here. Other libraries use add_samplers().
std::vector<SamplerEntry>& table() {
  static std::vector<SamplerEntry> entries = {
      {.name = "gl",
       .summary = "samples from memory for the scene, mixed with uniform ones (Algorithm 1)",
       .make = gl,
       .uses_memory = true},
      {.name = "uniform", .summary = "uniform within the joint limits", .make = uniform_source},
      {.name = "halton", .summary = "a Halton sequence with a random shift", .make = halton_source},
  };
  return entries;
}

const SamplerEntry* entry_of(std::string_view name) {
  const auto entry = std::ranges::find(table(), name, &SamplerEntry::name);
  return entry == table().end() ? nullptr : &*entry;
}

}  // namespace

std::span<const SamplerEntry> samplers() { return table(); }

std::vector<std::string> sampler_names() {
  std::vector<std::string> names;
  for (const SamplerEntry& sampler : table()) names.emplace_back(sampler.name);
  return names;
}

void add_samplers(std::span<const SamplerEntry> entries) {
  for (SamplerEntry entry : entries) {
    if (entry_of(entry.name) != nullptr) continue;
    if (entry.make == nullptr) entry.make = uniform_source;
    table().push_back(entry);
  }
}

Result<const SamplerEntry*> find_sampler(std::string_view name) {
  if (const SamplerEntry* entry = entry_of(name)) return entry;
  const std::vector<std::string> names = sampler_names();
  return fail(ErrorCode::invalid, "unknown sampler '{}': expected one of {}{}", name,
              fmt::join(names, ", "), did_you_mean(name, names));
}

}  // namespace mneme
