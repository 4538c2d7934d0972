// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "micro/suite.h"
#include "mneme/sampling.h"
#include "planning/configuration_set.h"

namespace mneme::bench {
namespace {

constexpr int kQueries = 200;

struct Tree {
  internal::JointSpace space;
  internal::ConfigurationSet set;
  std::vector<float> queries;

  Tree(const Robot& robot, int size, Isa isa) : space(robot), set(space, isa) {
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

}  // namespace

void register_nearest(const Robot& robot) {
  const auto joints = static_cast<std::size_t>(robot.joint_count());
  for (const Isa isa : measured_isas()) {
    for (const int size : {100, 1000, 10000}) {
      const auto tree = std::make_shared<Tree>(robot, size, isa);
      const std::string name =
          "nearest_of_" + std::to_string(size) + "/" + std::string(to_string(isa));
      register_repeated(name, "query", [tree, joints] {
        const std::span<const float> queries = tree->queries;
        for (std::size_t i = 0; i < queries.size(); i += joints) {
          benchmark::DoNotOptimize(tree->set.nearest(queries.subspan(i, joints)));
        }
        return std::uint64_t{kQueries};
      });
    }
  }
}

}  // namespace mneme::bench
