// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A program that serves plans from a thread of its own.
#include <cstdio>

#include "mneme/service.h"

int main() {
  const auto file = mneme::find_scene("planar/threaded_b2.yaml");
  if (!file) return std::puts(file.error().message.c_str()), 1;
  const auto problem = mneme::load_problem(*file);
  if (!problem) return std::puts(problem.error().message.c_str()), 1;
  mneme::ServiceSettings settings;
  settings.listen = "127.0.0.1:0";
  auto service = mneme::Service::start(problem->robot, nullptr, settings);
  if (!service) return std::puts(service.error().message.c_str()), 1;
  std::printf("serves at %s\n", service->address().c_str());
  service->stop();
  return 0;
}
