// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What remembering a path costs the caller of solve() in an unchanged cell. Plans PROBLEM COUNT
/// times from different seeds and remembers each path in a new DATABASE.
///     mneme_remember_cost PROBLEM DATABASE [COUNT]
#include "mneme/pipeline.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

using namespace mneme;

namespace {

int refuse(const Error& error) {
  std::fprintf(stderr, "mneme_remember_cost: %s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return refuse({ErrorCode::invalid, "expected PROBLEM DATABASE [COUNT]"});
  const int count = argc > 3 ? std::max(std::atoi(argv[3]), 1) : 200;
  const auto problem = load_problem(argv[1]);
  if (!problem) return refuse(problem.error());
  auto database = Database::open(argv[2], make_signature(problem->robot), OpenMode::create);
  if (!database) return refuse(database.error());
  SolveSettings settings;
  settings.sampler = "uniform";
  settings.memory.kind = "paths";
  settings.remember_after = 0;
  std::vector<double> costs_us;
  for (int i = 0; i < count; ++i) {
    settings.plan.seed = static_cast<std::uint64_t>(i) + 1;
    const auto solved = solve(*problem, &*database, settings);
    if (!solved) return refuse(solved.error());
    if (solved->remembered.is_queued) costs_us.push_back(1e6 * solved->remembered.time_s);
  }
  if (const auto stored = database->flush(); !stored) return refuse(stored.error());
  if (costs_us.empty()) return refuse({ErrorCode::invalid, "no path was found"});
  std::ranges::sort(costs_us);
  const auto at = [&](double share) {
    return costs_us[static_cast<std::size_t>(share * static_cast<double>(costs_us.size() - 1))];
  };
  std::printf("%zu paths remembered, %lld rows stored: p50 %.1f us, p95 %.1f us, max %.1f us\n",
              costs_us.size(), static_cast<long long>(database->queued_rows().stored), at(0.5),
              at(0.95), at(1));
}
