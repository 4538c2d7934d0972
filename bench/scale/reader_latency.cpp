// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_reader_latency URL [SECONDS READERS WRITERS]: how long find() lasts, and how often it
// waits, while processes insert into the same database (which must be new) and it is refreshed.
#include "mneme/experience.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mneme::bench {
namespace {

const RobotSignature kSpace = {"latency", "", "0123456789abcdef", 8};
using Key = std::vector<double>;

constexpr const char* kKind = "latency/1";
constexpr int kMeans = 24;
constexpr double kEdge = 4;

Key random_key(Rng& rng) {
  Key key(6);
  for (double& number : key) number = rng.uniform(0, kEdge);
  return key;
}

std::vector<Experience> random_rows(Rng& rng, int count) {
  std::vector<Experience> rows(static_cast<std::size_t>(count));
  for (Experience& row : rows) {
    row.kind = kKind;
    row.key = random_key(rng);
    row.sampler().joint_count = kSpace.joint_count;
    for (int i = 0; i < kMeans * kSpace.joint_count; ++i) {
      row.sampler().means.push_back(static_cast<float>(rng.uniform(-3, 3)));
    }
    row.provenance = {"reader_latency", "random", rng.next(), "2020-01-02T03:04:05Z"};
  }
  return rows;
}

/// A process that inserts until it is told to end.
pid_t start_writer(const std::string& url, std::uint64_t seed) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  auto database = Database::open(url, kSpace, OpenMode::read_write);
  Rng rng(seed);
  while (database && database->insert(random_rows(rng, 100))) {
  }
  std::fprintf(stderr, "a writer ended: %s\n",
               database ? "a row was refused" : database.error().message.c_str());
  ::_exit(1);
}

struct Latencies {
  std::vector<double> seconds;  // of queries during which the machine did not stop the thread
  std::int64_t waits = 0;       // queries during which the thread itself waited
  std::int64_t stopped = 0;     // queries during which something else ran instead
};

Latencies measure(const Database& database, std::uint64_t seed, const std::atomic<bool>& is_over) {
  Latencies latencies;
  Rng rng(seed);
  rusage before{};
  rusage after{};
  while (!is_over) {
    const Key key = random_key(rng);
    ::getrusage(RUSAGE_THREAD, &before);
    const auto begin = std::chrono::steady_clock::now();
    const auto found = database.find(kKind, {&key, 1}, 0.3, 8);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    ::getrusage(RUSAGE_THREAD, &after);
    if (!found) std::fprintf(stderr, "%s\n", found.error().message.c_str());
    latencies.waits += after.ru_nvcsw - before.ru_nvcsw;
    if (after.ru_nivcsw == before.ru_nivcsw) {
      latencies.seconds.push_back(time.count());
    } else {
      ++latencies.stopped;
    }
  }
  return latencies;
}

void print(std::vector<Latencies> parts, std::int64_t rows, std::int64_t refreshes) {
  Latencies all;
  for (Latencies& part : parts) {
    all.seconds.insert(all.seconds.end(), part.seconds.begin(), part.seconds.end());
    all.waits += part.waits;
    all.stopped += part.stopped;
  }
  std::sort(all.seconds.begin(), all.seconds.end());
  const auto at = [&](double share) {
    return 1e3 * all.seconds[static_cast<std::size_t>(share * double(all.seconds.size() - 1))];
  };
  std::printf(
      "%zu queries, %lld rows came in %lld refreshes: p50 %.3f, p99 %.3f, p99.9 %.3f, longest %.3f "
      "ms; %lld waits; not counted, because another program ran instead: %lld\n",
      all.seconds.size(), static_cast<long long>(rows), static_cast<long long>(refreshes), at(0.5),
      at(0.99), at(0.999), at(1), static_cast<long long>(all.waits),
      static_cast<long long>(all.stopped));
}

int run(const std::string& url, double seconds, int readers, int writers) {
  {
    auto made = Database::open(url, kSpace, OpenMode::create);
    Rng rng(1);
    if (!made || made->size() > 0 || !made->insert(random_rows(rng, 10000))) {
      std::fprintf(stderr, "%s\n", made ? "expected a new database" : made.error().message.c_str());
      return 1;
    }
  }
  std::vector<pid_t> children;
  for (int i = 0; i < writers; ++i) children.push_back(start_writer(url, 100 + std::uint64_t(i)));
  auto database = Database::open(url, kSpace, OpenMode::read_only);
  if (!database) return 1;
  const std::int64_t first = database->size();
  std::int64_t refreshes = 0;
  std::vector<Latencies> parts(static_cast<std::size_t>(readers));
  {
    std::atomic<bool> is_over = false;
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      threads.emplace_back([&, i] { parts[i] = measure(*database, i, is_over); });
    }
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      refreshes += database->refresh().has_value() ? 1 : 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    is_over = true;
  }
  for (const pid_t child : children) {
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
  print(std::move(parts), database->size() - first, refreshes);
  return 0;
}

}  // namespace
}  // namespace mneme::bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: mneme_reader_latency URL [SECONDS READERS WRITERS]\n");
    return 2;
  }
  return mneme::bench::run(argv[1], argc > 2 ? std::atof(argv[2]) : 10,
                           argc > 3 ? std::atoi(argv[3]) : 2, argc > 4 ? std::atoi(argv[4]) : 2);
}
