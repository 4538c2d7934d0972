// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A planar arm among circles, small enough for any planner.
#pragma once

#include "mneme/ompl.h"

#include "support/planar_memory.h"

namespace mneme::test {

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;

/// An arm of three links that reaches from beside a pair of circles into the gap between them. Its
/// first joint is continuous, and the short way leads over the seam.
inline Problem gap_problem() {
  Problem problem{.name = "gap", .robot = planar_arm({1, 0.8, 0.6})};
  problem.scene = make_circle_scene("", {{-1.8, 0.6, 0.35}, {-1.8, -0.6, 0.35}});
  problem.start = {-2.0, -0.5, 1.0};
  problem.goals = {{kPi - 0.01, 0, 0}};
  return problem;
}

/// The arm's first link is locked between posts: nothing leads to the goal.
inline Problem locked_problem() {
  Problem problem{
      .name = "locked", .robot = planar_arm({1, 0.5}), .start = {-kPi, 0.5}, .goals = {{0, 0.5}}};
  std::vector<std::array<double, 3>> ring;
  for (int i = 0; i < 18; ++i) {
    const double angle = i * kPi / 9;
    if (i != 0 && i != 9) ring.push_back({0.8 * std::cos(angle), 0.8 * std::sin(angle), 0.2});
  }
  problem.scene = make_circle_scene("ring", ring);
  return problem;
}

/// Settings for one of OMPL's planners, which are in the table from here on.
inline SolveSettings settings_for(const std::string& planner,
                                  const std::string& sampler = "uniform") {
  add_ompl_planners();
  SolveSettings settings;
  settings.planner = "ompl:" + planner;
  settings.sampler = sampler;
  return settings;
}

inline const PlannerEntry& ompl_planner(const std::string& name) {
  add_ompl_planners();
  const auto entry = find_planner("ompl:" + name);
  REQUIRE_MESSAGE(entry.has_value(), (entry ? "" : entry.error().message));
  return **entry;
}

/// Names of all OMPL planners, without the prefix.
inline std::vector<std::string> ompl_names() {
  add_ompl_planners();
  std::vector<std::string> names;
  for (const std::string& name : planner_names()) {
    if (name.starts_with("ompl:")) names.push_back(name.substr(5));
  }
  REQUIRE(names.size() == 18);
  return names;
}

/// Names of OMPL's samplers of valid states.
inline std::vector<std::string> valid_sampler_names() {
  add_ompl_planners();
  std::vector<std::string> names;
  for (const SamplerEntry& sampler : samplers()) {
    if (sampler.samples_valid_states) names.emplace_back(sampler.name);
  }
  return names;
}

inline CollisionChecker checker_of(const Problem& problem) {
  return make_checker(problem.robot, problem.scene);
}

inline void set_values(ob::State* state, const Configuration& q) {
  for (std::size_t i = 0; i < q.size(); ++i) {
    state->as<ob::RealVectorStateSpace::StateType>()->values[i] = q[i];
  }
}

inline Configuration values_of(const ob::State* state, int joints) {
  const double* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  return {values, values + joints};
}

/// A state of the space that is freed with it.
inline ob::ScopedState<> state_of(const ob::SpaceInformationPtr& information,
                                  const Configuration& q) {
  ob::ScopedState<> state(information);
  state = q;
  return state;
}

/// Draws `configuration`, over and over, and counts.
class ConstantSampler final : public Sampler {
 public:
  explicit ConstantSampler(std::vector<float> configuration)
      : configuration_(std::move(configuration)) {}

  std::unique_ptr<SampleStream> start(std::uint64_t) const override {
    return std::make_unique<Stream>(configuration_, *drawn_);
  }
  [[nodiscard]] int drawn() const { return drawn_->load(); }

 private:
  struct Stream final : SampleStream {
    Stream(const std::vector<float>& q, std::atomic<int>& count) : configuration(q), drawn(count) {}
    SampleSource next(std::span<float> q) override {
      std::copy(configuration.begin(), configuration.end(), q.begin());
      ++drawn;
      return 0;
    }
    const std::vector<float>& configuration;
    std::atomic<int>& drawn;
  };
  std::vector<float> configuration_;
  std::unique_ptr<std::atomic<int>> drawn_ = std::make_unique<std::atomic<int>>(0);
};

}  // namespace mneme::test
