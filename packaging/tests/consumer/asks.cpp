// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A service and its client in one program.
#include <cstdio>

#include "mneme/client.h"
#include "mneme/service.h"

int main() {
  const auto file = mneme::find_scene("planar/threaded_b2.yaml");
  if (!file) return std::puts(file.error().message.c_str()), 1;
  const auto problem = mneme::load_problem(*file);
  if (!problem) return std::puts(problem.error().message.c_str()), 1;
  mneme::ServiceSettings settings;
  settings.listen = "127.0.0.1:0";
  const auto service = mneme::Service::start(problem->robot, nullptr, settings);
  if (!service) return std::puts(service.error().message.c_str()), 1;
  mneme::ClientSettings where;
  where.address = service->address();
  auto client = mneme::Client::make(where);
  if (!client) return std::puts(client.error().message.c_str()), 1;
  const auto plan = client->plan(*problem);
  if (!plan) return std::puts(plan.error().message.c_str()), 1;
  std::puts(plan->is_solved() ? "solved" : plan->message.c_str());
  return 0;
}
