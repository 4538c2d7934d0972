// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/sampling.h"

#include "micro/suite.h"
#include "planning/configuration_set.h"
#include "planning/nearest_tree.h"

#include <memory>

namespace mneme::bench {
namespace {

constexpr int kQueries = 200;

/// A set of random configurations, and other ones whose nearest neighbours are searched.
template <class Set>
struct Trial {
  internal::JointSpace space;
  Set set;
  std::vector<float> queries;

  Trial(const Robot& robot, int size, Isa isa) : space(robot), set(space, isa) {
    const auto sampler = make_uniform_sampler(robot);
    const auto stream = sampler->start(1);
    std::vector<float> q(static_cast<std::size_t>(robot.joint_count()));
    for (int i = 0; i < size; ++i) {
      stream->next(q);
      set.add(q);
    }
    for (int i = 0; i < kQueries; ++i) {
      stream->next(q);
      queries.insert(queries.end(), q.begin(), q.end());
    }
  }
};

template <class Set>
void register_queries(const std::string& what, const Robot& robot, int size, Isa isa) {
  const auto trial = std::make_shared<Trial<Set>>(robot, size, isa);
  const auto joints = static_cast<std::size_t>(robot.joint_count());
  const std::string name = what + "_of_" + std::to_string(size) + "/" + std::string(to_string(isa));
  register_repeated(name, "query", [trial, joints] {
    const std::span<const float> queries = trial->queries;
    for (std::size_t i = 0; i < queries.size(); i += joints) {
      benchmark::DoNotOptimize(trial->set.nearest(queries.subspan(i, joints)));
    }
    return std::uint64_t{kQueries};
  });
}

}  // namespace

/// Sets look into themselves by scan until they are large; the tree alone shows what that saves.
void register_nearest(const Robot& robot) {
  for (const Isa isa : measured_isas()) {
    for (const int size : {100, 1000, 2000, 10000}) {
      register_queries<internal::ConfigurationSet>("nearest", robot, size, isa);
    }
    for (const int size : {500, 1000, 2000, 4000}) {
      register_queries<internal::NearestTree>("nearest_in_tree", robot, size, isa);
    }
  }
}

}  // namespace mneme::bench
