// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Growth of a tree.
#pragma once

#include "planning/anchored_samples.h"
#include "planning/escape_walk.h"
#include "planning/planner_run.h"
#include "planning/tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace mneme::internal {

/// Decides where a tree grows next: towards a sample, around the newest node, or on an escape walk.
/// Steps towards samples come in batches whose ends are checked a vector at a time. In narrow
/// passages most steps are blocked at their ends; they then cost one lane instead of a vector. Not
/// thread-safe.
class Growth {
 public:
  explicit Growth(PlannerRun& run);

  /// Samples steps of `tree`: one after a success, more the longer there has been none. Rejects
  /// samples outside the domain of their nearest node; after kPatience rejections in a row a step
  /// starts at a random node instead. `target`: see AnchoredSamples. Returns false if a limit is
  /// reached before the first step.
  bool sample_steps(const Tree& tree, std::span<const float> target = {});

  [[nodiscard]] int size() const { return static_cast<int>(steps_.size()); }
  /// Takes step `i` and continues towards its sample until blocked. Returns the last new node, or
  /// -1 if the step is blocked.
  int take(int i, Tree& tree);
  // The functions below are not defined for an escape walk.
  /// The node at which step `i` starts.
  [[nodiscard]] int node(int i) const { return step(i).node; }
  [[nodiscard]] std::span<const float> sample(int i) const { return row(samples_, i); }
  [[nodiscard]] std::span<const float> end(int i) const { return row(ends_, i); }
  /// True if step `i` ends at its sample.
  [[nodiscard]] bool is_sample_reached(int i) const { return step(i).is_sample_reached; }
  /// True if the end of step `i` is valid, and always if the batch has one step, whose motion check
  /// covers its end.
  [[nodiscard]] bool is_end_valid(int i) const {
    return is_valid_[static_cast<std::size_t>(i)] != 0;
  }
  /// Reports the outcome of step `i` to the sampler.
  void settle(int i, SampleOutcome outcome);

 private:
  struct Step {
    int node = -1;
    bool is_sample_reached = false;
    SampleSource source = kUniformSource;
    bool is_walk = false;
  };

  [[nodiscard]] const Step& step(int i) const { return steps_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] std::span<const float> row(const std::vector<float>& rows, int i) const {
    const std::size_t joints = run_.start().size();
    return {rows.data() + static_cast<std::size_t>(i) * joints, joints};
  }
  int step_towards(int i, Tree& tree);
  [[nodiscard]] int choose_node(const Tree& tree, std::span<const float> q);
  void report(SampleSource source, SampleOutcome outcome);

  PlannerRun& run_;
  AnchoredSamples anchored_;
  EscapeWalk walk_;
  Rng rng_;
  int rejections_ = 0;  ///< in a row
  std::vector<Step> steps_;
  std::vector<float> samples_, ends_;
  std::vector<std::uint8_t> is_valid_;
};

}  // namespace mneme::internal
