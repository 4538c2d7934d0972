// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "planning/growth.h"

#include <algorithm>

namespace mneme::internal {
namespace {

constexpr int kMostSteps = 16;
constexpr int kPatience = 300;

}  // namespace

Growth::Growth(PlannerRun& run)
    : run_(run),
      anchored_(run),
      walk_(run),
      rng_(run.make_rng(RngStream::relief)),
      samples_(kMostSteps * run.start().size()),
      ends_(kMostSteps * run.start().size()),
      is_valid_(kMostSteps) {
  steps_.reserve(kMostSteps);
}

bool Growth::sample_steps(const Tree& tree, std::span<const float> target) {
  const std::size_t joints = run_.start().size();
  const auto wanted = static_cast<std::size_t>(std::min(kMostSteps, 1 + rejections_));
  steps_.clear();
  if (walk_.is_due() && run_.begin_iterations() > 0) {
    steps_.push_back({.is_walk = true});
    return true;
  }
  while (steps_.size() < wanted && run_.begin_iterations() > 0) {
    const std::span<float> q(samples_.data() + steps_.size() * joints, joints);
    const SampleSource source = anchored_.next(tree.newest(), q, target);
    const int node = choose_node(tree, q);
    if (node < 0) {
      report(source, SampleOutcome::rejected);
      continue;
    }
    const std::span<float> end(ends_.data() + steps_.size() * joints, joints);
    steps_.push_back({node, tree.step(node, q, end), source});
  }
  if (steps_.empty()) return false;
  // The motion check of a single step covers its end.
  is_valid_[0] = 1;
  if (steps_.size() > 1) {
    run_.check_states({ends_.data(), steps_.size() * joints}, {is_valid_.data(), steps_.size()});
  }
  return true;
}

int Growth::choose_node(const Tree& tree, std::span<const float> q) {
  if (rejections_ < kPatience) return tree.nearest_in_domain(q);
  rejections_ = 0;
  return static_cast<int>(rng_.index(static_cast<std::uint32_t>(tree.size())));
}

int Growth::take(int i, Tree& tree) {
  return step(i).is_walk ? walk_.extend(tree) : step_towards(i, tree);
}

int Growth::step_towards(int i, Tree& tree) {
  const int from = node(i);
  const bool is_free = is_end_valid(i) && run_.is_motion_valid(tree[from], end(i));
  tree.adapt_domain(from, is_free);
  if (!is_free || run_.must_stop()) return -1;
  int last = tree.add(end(i), from);
  bool is_reached = is_sample_reached(i);
  for (int node = last; node >= 0 && !is_reached && !run_.must_stop();) {
    node = tree.extend(last, sample(i), is_reached);
    if (node >= 0) last = node;
  }
  return last;
}

void Growth::settle(int i, SampleOutcome outcome) {
  if (!step(i).is_walk) report(step(i).source, outcome);
}

void Growth::report(SampleSource source, SampleOutcome outcome) {
  rejections_ = outcome == SampleOutcome::rejected ? rejections_ + 1 : 0;
  run_.report(source, outcome);
}

}  // namespace mneme::internal
