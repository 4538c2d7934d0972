// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "micro/edges.h"

#include "mneme/collision.h"
#include "mneme/planning.h"
#include "mneme/sampling.h"

#include "robot/joint_space.h"

#include <algorithm>
#include <filesystem>

namespace mneme::bench {
namespace {

constexpr int kMaxIterations = 4000;

using Row = std::vector<float>;
using Tree = std::vector<Row>;

Row to_row(const Configuration& q) { return {q.begin(), q.end()}; }

class Recorder {
 public:
  Recorder(const Problem& problem, const CollisionChecker& checker)
      : edges{problem, {}, {}},
        checker_(checker),
        space_(problem.robot),
        range_(default_range(problem.robot)) {}

  /// Extends the tree by one step towards `target`. True if the motion is valid; `has_reached`
  /// tells whether it ends there.
  bool extend(Tree& tree, const Row& target, bool& has_reached) {
    const Row& from = nearest(tree, target);
    Row delta(target.size());
    const float distance = space_.difference(from.data(), target.data(), delta.data());
    const float fraction = std::min(1.0f, static_cast<float>(range_) / distance);
    Row to = target;
    for (std::size_t j = 0; j < to.size() && fraction < 1; ++j) {
      to[j] = space_.into_limits(static_cast<int>(j), from[j] + fraction * delta[j]);
    }
    has_reached = !(fraction < 1);
    const bool is_valid = checker_.is_motion_valid(from, to, counters_);
    Motions& motions = is_valid ? edges.valid : edges.invalid;
    motions.from.insert(motions.from.end(), from.begin(), from.end());
    motions.to.insert(motions.to.end(), to.begin(), to.end());
    valid_count += is_valid ? 1 : 0;
    if (is_valid) tree.push_back(std::move(to));
    return is_valid;
  }

  Edges edges;
  int valid_count = 0;

 private:
  const Row& nearest(const Tree& tree, const Row& q) const {
    Row delta(q.size());
    return *std::ranges::min_element(tree, {}, [&](const Row& node) {
      return space_.difference(node.data(), q.data(), delta.data());
    });
  }

  const CollisionChecker& checker_;
  internal::JointSpace space_;
  double range_;
  CheckCounters counters_;
};

std::vector<std::string> files_of(const std::string& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path().string());
  }
  std::ranges::sort(files);
  return files;
}

/// One for each problem of a compact file; any other file holds one.
std::vector<std::string> addresses_of(const std::string& file) {
  if (std::filesystem::path(file).extension() != ".json") return {file};
  std::vector<std::string> addresses;
  const auto names = list_problems(file);
  for (std::size_t i = 0; names && i < names->size(); ++i) {
    addresses.push_back(file + "#" + (*names)[i]);
  }
  return addresses;
}

}  // namespace

Result<std::vector<Problem>> load_problems(const std::vector<std::string>& paths,
                                           const ProblemOptions& options) {
  std::vector<Problem> problems;
  for (const std::string& path : paths) {
    for (const std::string& file : files_of(path)) {
      for (const std::string& address : addresses_of(file)) {
        auto problem = load_problem(address, options);
        if (!problem) return tl::unexpected(problem.error());
        problems.push_back(std::move(*problem));
      }
    }
  }
  return problems;
}

Edges record_edges(const Problem& problem, int most, std::uint64_t seed) {
  const auto checker = CollisionChecker::make(problem.robot, problem.scene);
  if (!checker || refuse_query(*checker, {problem.start, problem.goals})) return {problem, {}, {}};
  Recorder recorder(problem, *checker);
  Tree trees[2] = {{to_row(problem.start)}, {}};
  for (const Configuration& goal : problem.goals) trees[1].push_back(to_row(goal));
  const auto sampler = make_uniform_sampler(problem.robot);
  const auto stream = sampler->start(seed);
  Row sample(problem.start.size());
  int current = 0;
  bool has_met = false;
  for (int i = 0; i < kMaxIterations && recorder.valid_count < most && !has_met; ++i) {
    stream->next(sample);
    bool has_reached = false;
    if (recorder.extend(trees[current], sample, has_reached)) {
      const Row target = trees[current].back();
      while (!has_met && recorder.valid_count < most &&
             recorder.extend(trees[1 - current], target, has_met)) {
      }
    }
    current = 1 - current;
  }
  return std::move(recorder.edges);
}

}  // namespace mneme::bench
