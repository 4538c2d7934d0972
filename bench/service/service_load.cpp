// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_service_load PROBLEM.yaml [--clients N] [--plans N] [--threads N] [--iterations N]
//
// Plans one problem in this process and over HTTP on loopback, with the same threads. Prints the
// median time that HTTP adds to a plan on a kept connection, plans per second of both ways, and the
// requests that failed. Memory use is printed before and after; for a soak test set --plans to some
// hundred thousands.
#include "mneme/mneme.h"
#include "mneme/service.h"

#include <fmt/format.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>
#include <sys/resource.h>

namespace mneme {
namespace {

struct Options {
  std::string problem;
  int clients = 32;
  int plans = 2000;  ///< of each client
  int threads = 2;
  std::uint64_t iterations = 100000;
};

double quantile(std::vector<double> values, double fraction) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1))];
}

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// MiB of this process, clients included.
double resident_mib() {
  std::ifstream file("/proc/self/statm");
  long pages = 0;
  file >> pages >> pages;
  return static_cast<double>(pages) * 4096 / (1 << 20);
}

SolveSettings settings_of(const Options& options, int plan) {
  SolveSettings settings;
  settings.sampler = "uniform";
  settings.plan.seed = static_cast<std::uint64_t>(plan % 100);
  settings.plan.max_iterations = options.iterations;
  return settings;
}

std::string body_of(const Problem& problem, const Options& options, int plan) {
  using Json = nlohmann::json;
  const Json file = Json::parse(to_compact_json({problem.scene, ""}));
  Json body = file["problems"][0];
  body["start"] = problem.start;
  body["goals"] = problem.goals;
  body["settings"] = {{"seed", plan % 100}, {"max-iterations", options.iterations}};
  return body.dump();
}

struct Spent {
  double wall_s = 0, cpu_s = 0;
};
/// Runs `work(thread)` in `count` threads. Returns wall and CPU time.
template <class Work>
Spent run_threads(int count, const Work& work) {
  const double cpu_before = cpu_s();
  const Stopwatch stopwatch;
  std::vector<std::thread> threads;
  for (int i = 0; i < count; ++i) threads.emplace_back([&, i] { work(i); });
  for (std::thread& thread : threads) thread.join();
  return {stopwatch.elapsed_s(), cpu_s() - cpu_before};
}

void measure_overhead(const Problem& problem, const Options& options, httplib::Client& client) {
  std::vector<double> added_us, inside_us;
  for (int plan = 0; plan < options.plans; ++plan) {
    const std::string body = body_of(problem, options, plan);
    const Stopwatch stopwatch;
    const auto reply = client.Post("/v1/plan", body, "application/json");
    const double whole_us = 1e6 * stopwatch.elapsed_s();
    if (!reply || reply->status != 200) continue;
    const double solve_us = 1e6 * nlohmann::json::parse(reply->body)["total_time_s"].get<double>();
    inside_us.push_back(solve_us);
    added_us.push_back(whole_us - solve_us);
  }
  if (added_us.empty()) return;
  fmt::print(
      "one client, {} plans: solve() {:.0f} us; HTTP adds {:.0f} us (p50), {:.0f} us (p95)\n",
      added_us.size(), quantile(inside_us, 0.5), quantile(added_us, 0.5), quantile(added_us, 0.95));
}

int run(const Options& options) {
  const auto problem = load_problem(options.problem);
  if (!problem) return fmt::print("{}\n", problem.error().message), 1;
  ServiceSettings settings;
  settings.listen = "127.0.0.1:0";
  settings.threads = options.threads;
  const auto service = Service::start(problem->robot, nullptr, settings);
  if (!service) return fmt::print("{}\n", service.error().message), 1;
  const int port = std::stoi(service->address().substr(service->address().rfind(':') + 1));
  const auto connect = [&](httplib::Client& client) {
    client.set_keep_alive(true);
    client.set_tcp_nodelay(true);
    client.set_read_timeout(100);
  };
  httplib::Client alone("127.0.0.1", port);
  connect(alone);
  measure_overhead(*problem, options, alone);

  const int total = options.clients * options.plans;
  std::atomic<int> next = 0, failures = 0;
  const Spent inside = run_threads(options.threads, [&](int) {
    for (int plan = next++; plan < total; plan = next++) {
      const auto result = solve(*problem, nullptr, settings_of(options, plan));
      failures += result && result->plan.is_solved() ? 0 : 1;
    }
  });
  std::vector<std::string> bodies;
  for (int plan = 0; plan < 100; ++plan) bodies.push_back(body_of(*problem, options, plan));
  const double before_mib = resident_mib();
  const Spent over_http = run_threads(options.clients, [&](int client_number) {
    httplib::Client client("127.0.0.1", port);
    connect(client);
    for (int plan = 0; plan < options.plans; ++plan) {
      const auto& body = bodies[static_cast<std::size_t>((client_number + plan) % 100)];
      const auto reply = client.Post("/v1/plan", body, "application/json");
      const bool is_solved = reply && reply->status == 200 &&
                             reply->body.find("\"solved\": true") != std::string::npos;
      failures += is_solved ? 0 : 1;
    }
  });
  fmt::print("{} plans, {} threads: {:.0f}/s in this process ({:.0f} us of CPU each)\n", total,
             options.threads, total / inside.wall_s, 1e6 * inside.cpu_s / total);
  fmt::print("{} clients over HTTP: {:.0f}/s ({:.0f} us of CPU each, clients included), {:.1f} %\n",
             options.clients, total / over_http.wall_s, 1e6 * over_http.cpu_s / total,
             100 * inside.wall_s / over_http.wall_s);
  fmt::print("failures {}; resident {:.1f} MiB before, {:.1f} MiB after\n", failures.load(),
             before_mib, resident_mib());
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace mneme

int main(int argument_count, char** arguments) {
  mneme::Options options;
  for (int i = 1; i < argument_count; ++i) {
    const std::string_view flag = arguments[i];
    const bool has_value = flag.starts_with("--") && i + 1 < argument_count;
    const int value = has_value ? std::atoi(arguments[i + 1]) : 0;
    if (flag == "--clients") options.clients = value;
    if (flag == "--plans") options.plans = value;
    if (flag == "--threads") options.threads = value;
    if (flag == "--iterations") options.iterations = static_cast<std::uint64_t>(value);
    if (has_value) {
      ++i;
    } else {
      options.problem = flag;
    }
  }
  return mneme::run(options);
}
