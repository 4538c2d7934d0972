// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A run of a planner whose parts a test calls one by one, and robots for it.
#pragma once

#include "planning/small_worlds.h"
#include "planning/planner_run.h"

#include <memory>
#include <utility>

namespace mneme::test {

/// A run that outlives what it refers to. Its sampler is uniform unless a test brings another one.
struct RunFixture {
  explicit RunFixture(World world_, const PlanSettings& settings_ = {}, Isa isa = Isa::automatic,
                      std::unique_ptr<Sampler> sampler_ = nullptr)
      : world(std::move(world_)),
        settings(settings_),
        checker(make_checker(world, of_isa(isa))),
        sampler(sampler_ ? std::move(sampler_) : make_uniform_sampler(world.robot)),
        finisher(checker, settings.finish()),
        run({checker, world.query, *sampler, settings, finisher}) {}
  static CheckerSettings of_isa(Isa isa) {
    CheckerSettings checking;
    checking.isa = isa;
    return checking;
  }

  World world;
  PlanSettings settings;
  CollisionChecker checker;
  std::unique_ptr<Sampler> sampler;
  PathFinisher finisher;
  internal::PlannerRun run;
};

/// An arm with too many joints for computed steps.
inline Robot chain_without_limbs() {
  Robot::Parts parts;
  parts.name = "chain";
  parts.links.push_back({.name = "base"});
  parts.allowed_pairs.emplace();
  for (int i = 0; i < 33; ++i) {
    add_link(parts, JointType::revolute, Vec3(0.1, 0, 0), Vec3::UnitZ(), 0.2,
             {{Vec3(0.05, 0, 0), 0.02}});
  }
  return make_small_robot(std::move(parts));
}

}  // namespace mneme::test
