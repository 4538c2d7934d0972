// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/step_batch.h"

#include <algorithm>

namespace mneme::internal {
namespace {

constexpr int kMostSteps = 16;
constexpr int kPatience = 300;

}  // namespace

StepBatch::StepBatch(PlannerRun& run)
    : run_(run),
      rng_(derive_seed(run.settings().seed, 2)),
      samples_(kMostSteps * run.start().size()),
      ends_(kMostSteps * run.start().size()),
      is_valid_(kMostSteps) {
  steps_.reserve(kMostSteps);
}

bool StepBatch::draw(const Tree& tree) {
  const std::size_t joints = run_.start().size();
  const auto wanted = static_cast<std::size_t>(std::min(kMostSteps, 1 + rejections_));
  steps_.clear();
  while (steps_.size() < wanted && run_.begin_iterations() > 0) {
    const std::span<float> q(samples_.data() + steps_.size() * joints, joints);
    const Origin origin = run_.sample(q);
    const int node = choose_node(tree, q);
    if (node < 0) {
      report(origin, SampleOutcome::rejected);
      continue;
    }
    const std::span<float> end(ends_.data() + steps_.size() * joints, joints);
    steps_.push_back({node, tree.step(node, q, end), origin});
  }
  if (steps_.empty()) return false;
  run_.check_states({ends_.data(), steps_.size() * joints}, {is_valid_.data(), steps_.size()});
  return true;
}

int StepBatch::choose_node(const Tree& tree, std::span<const float> q) {
  if (rejections_ < kPatience) return tree.nearest_in_domain(q);
  rejections_ = 0;
  return static_cast<int>(rng_.index(static_cast<std::uint32_t>(tree.size())));
}

void StepBatch::settle(int i, SampleOutcome outcome) { report(step(i).origin, outcome); }

void StepBatch::report(Origin origin, SampleOutcome outcome) {
  rejections_ = outcome == SampleOutcome::rejected ? rejections_ + 1 : 0;
  run_.report(origin, outcome);
}

}  // namespace mneme::internal
