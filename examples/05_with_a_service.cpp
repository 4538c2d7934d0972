// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Plans a problem with a service that is warm already: `mneme serve --robot NAME` first.
#include "mneme/client.h"

#include <cstdio>

namespace {

int fail_with(const mneme::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 3) {
    std::fputs("usage: 05_with_a_service http://HOST:PORT|unix:PATH PROBLEM.yaml\n", stderr);
    return 2;
  }
  mneme::ClientSettings where;
  where.address = arguments[1];
  auto client = mneme::Client::make(where);
  if (!client) return fail_with(client.error());
  const auto problem = mneme::load_problem(arguments[2]);
  if (!problem) return fail_with(problem.error());

  // The scene travels once, and each plan in it names it.
  const auto kept = client->put_scene("example", problem->scene);
  if (!kept) return fail_with(kept.error());
  mneme::SolveSettings settings;
  for (settings.plan.seed = 1; settings.plan.seed <= 3; ++settings.plan.seed) {
    const auto plan = client->plan(*problem, "example", settings);
    if (!plan) return fail_with(plan.error());
    if (!plan->is_solved()) return std::puts(plan->message.c_str()), 3;
    std::printf("%s: %zu configurations, %.2f ms\n", problem->name.c_str(), plan->path.size(),
                1e3 * plan->total_time_s);
  }
  const auto forgotten = client->delete_scene("example");
  return forgotten ? 0 : fail_with(forgotten.error());
}
