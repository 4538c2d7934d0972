// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_micro --problems DIR --robot F.urdf --srdf F.srdf: nanoseconds per state and the like, per
// instruction set. Options of google-benchmark, such as --benchmark_filter=valid, are understood.
#include "micro/suite.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace mneme::bench {
namespace {

/// Most valid motions per problem, so that no problem outweighs the others.
constexpr int kMostMotions = 200;
constexpr int kRepetitions = 10;
constexpr double kMinTime = 0.05;  // seconds, of one repetition

struct Input {
  std::vector<std::string> problems = {MNEME_SOURCE_DIRECTORY "/scenes/planar/scenario1.yaml",
                                       MNEME_SOURCE_DIRECTORY "/scenes/planar/scenario2.yaml",
                                       MNEME_SOURCE_DIRECTORY "/scenes/planar/scenario3.yaml"};
  ProblemOptions options;
};

int run(const Input& input) {
  const auto problems = load_problems(input.problems, input.options);
  if (!problems || problems->empty()) {
    std::fprintf(stderr, "mneme_micro: %s\n",
                 problems ? "no problems there" : problems.error().message.c_str());
    return 1;
  }
  std::vector<Edges> recorded;
  std::size_t valid = 0, invalid = 0;
  for (const Problem& problem : *problems) {
    Edges edges = record_edges(problem, kMostMotions, 1);
    const std::size_t joints = problem.start.size();
    valid += edges.valid.from.size() / joints;
    invalid += edges.invalid.from.size() / joints;
    if (!edges.valid.from.empty()) recorded.push_back(std::move(edges));
  }
  std::fprintf(stderr, "mneme_micro: %zu of %zu problems, %zu valid and %zu invalid motions\n",
               recorded.size(), problems->size(), valid, invalid);
  if (recorded.empty()) return 1;
  register_collision(recorded);
  register_nearest(problems->front().robot);
  register_random();
  register_cvae(problems->front());
#ifdef MNEME_WITH_OMPL
  register_ompl(problems->front().robot);
#endif
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace

std::vector<Isa> measured_isas() {
  std::vector<Isa> isas = available_isas();
  std::ranges::reverse(isas);
  return isas;
}

void register_repeated(const std::string& name, const std::string& per_item,
                       const std::function<std::uint64_t()>& body) {
  const auto least = [](const std::vector<double>& values) {
    return *std::min_element(values.begin(), values.end());
  };
  benchmark::RegisterBenchmark(name.c_str(),
                               [body, per_item](benchmark::State& state) {
                                 std::uint64_t items = 0;
                                 for (auto _ : state) items += body();
                                 state.counters["s/" + per_item] = benchmark::Counter(
                                     static_cast<double>(items),
                                     benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
                               })
      ->MinTime(kMinTime)
      ->Repetitions(kRepetitions)
      ->ReportAggregatesOnly()
      ->ComputeStatistics("least", least)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace mneme::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  mneme::bench::Input input;
  CLI::App app{"Micro-benchmarks of mneme"};
  app.add_option("--problems", input.problems, "problem files, or directories of compact ones");
  app.add_option("--robot", input.options.robot_path, "URDF instead of the problems' own");
  app.add_option("--srdf", input.options.robot.srdf_path, "SRDF of the robot");
  CLI11_PARSE(app, argc, argv);
  return mneme::bench::run(input);
}
