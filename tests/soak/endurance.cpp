// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "soak/endurance.h"

#include "soak/random_problem.h"
#include "support/kinds.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <malloc.h>
#include <span>
#include <unistd.h>

namespace mneme::soak {
namespace {

constexpr int kPlansPerRound = 60;

double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

SolveSettings settings_of(int plan) {
  SolveSettings settings;
  settings.planner = planners()[static_cast<std::size_t>(plan) % planners().size()].name;
  settings.retrieve_after = 0;
  settings.plan.seed = static_cast<std::uint64_t>(plan);
  settings.plan.timeout_s = 600;
  settings.plan.max_iterations = 3000;
  settings.memory = test::of_kind("paths");
  return settings;
}

/// Two connections to one file, as two processes have them.
struct Pair {
  Database writer, reader;
};

Result<Pair> open_both(const Robot& robot, const std::string& path) {
  const RobotSignature space = make_signature(robot);
  const std::ofstream empty(path, std::ios::app);  // a new file would come with its first row
  auto writer = Database::open(path, space, OpenMode::create);
  if (!writer) return tl::unexpected(writer.error());
  auto reader = Database::open(path, space, OpenMode::read_only);
  if (!reader) return tl::unexpected(reader.error());
  return Pair{*std::move(writer), *std::move(reader)};
}

Result<void> plan_and_remember(Pair& databases, const Problem& problem, int plan, Round& round) {
  const auto solved = solve(problem, &databases.reader, settings_of(plan));
  if (!solved) return tl::unexpected(solved.error());
  ++round.plans;
  if (!solved->plan.is_solved()) return {};
  const std::span<const Path> paths(&solved->plan.path, 1);
  auto rows = learn_from_paths({problem.robot, problem.scene}, paths, test::of_kind("paths"));
  if (!rows) return tl::unexpected(rows.error());
  const auto inserted = databases.writer.insert(std::move(*rows));
  if (!inserted) return tl::unexpected(inserted.error());
  const auto seen = databases.reader.refresh();
  if (!seen) return tl::unexpected(seen.error());
  round.rows += static_cast<int>(*seen);
  if (databases.reader.size() == databases.writer.size()) return {};
  return fail(ErrorCode::invalid, "the reader does not see what was inserted");
}

Result<Round> run_round(const Robot& robot, const std::string& path, std::uint64_t seed) {
  Round round;
  const double begin = cpu_s();
  {
    auto databases = open_both(robot, path);
    if (!databases) return tl::unexpected(databases.error());
    Rng rng(seed);
    for (int plan = 0; plan < kPlansPerRound; ++plan) {
      const Problem problem = random_problem(robot, 0, rng);
      auto done = plan_and_remember(*databases, problem, plan, round);
      if (!done) return tl::unexpected(done.error());
    }
  }
  for (const char* suffix : {"", "-wal", "-shm", ".tally"}) std::filesystem::remove(path + suffix);
  round.cpu_s = cpu_s() - begin;
  round.rss = resident_bytes();
  round.open_files = open_files();
  return round;
}

/// Other work on the machine only ever adds time.
double least_cpu_s(std::span<const Round> rounds) {
  return std::ranges::min_element(rounds, {}, &Round::cpu_s)->cpu_s;
}

template <class Value>
Value median_of(std::span<const Round> rounds, Value Round::*member) {
  std::vector<Value> values;
  for (const Round& round : rounds) values.push_back(round.*member);
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

std::int64_t resident_bytes() {
  // Memory that the allocator keeps for later, and pages of files, differ from run to run.
  ::malloc_trim(0);
  std::int64_t total = 0, resident = 0, of_files = 0;
  std::ifstream("/proc/self/statm") >> total >> resident >> of_files;
  return (resident - of_files) * ::sysconf(_SC_PAGESIZE);
}

int open_files() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return static_cast<int>(std::distance(begin(all), end(all)));
}

Result<std::vector<Round>> endure(const Robot& robot, const std::string& directory, double seconds,
                                  std::uint64_t seed) {
  const Stopwatch stopwatch;
  std::vector<Round> rounds;
  while (rounds.size() < kLeastRounds || stopwatch.elapsed_s() < seconds) {
    const auto round = run_round(robot, directory + "/endurance.db", seed);
    if (!round) return tl::unexpected(round.error());
    rounds.push_back(*round);
  }
  return rounds;
}

Drift drift_of(const std::vector<Round>& rounds) {
  // The first rounds fill what later ones find.
  const std::size_t cold = std::max<std::size_t>(rounds.size() / 10, 4);
  const std::span<const Round> warm = std::span(rounds).subspan(cold);
  const std::size_t quarter = std::max<std::size_t>(warm.size() / 4, 1);
  const auto first = warm.first(quarter), last = warm.last(quarter);
  return {least_cpu_s(last) / least_cpu_s(first),
          median_of(last, &Round::rss) - median_of(first, &Round::rss),
          median_of(last, &Round::open_files) - median_of(first, &Round::open_files)};
}

}  // namespace mneme::soak
