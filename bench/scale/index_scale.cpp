// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// mneme_index_scale [KEYS KEY_SIZE...]: how the index in memory and a database in a file do with
// many keys. Keys are uniform in a cube that holds 50 of them, on average, within the threshold of
// a query. Times are those of the processor.
#include "mneme/experience.h"

#include "experience/key_index.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <malloc.h>
#include <unistd.h>

namespace mneme::bench {
namespace {

constexpr int kQueries = 1000;
constexpr int kMatches = 50;
constexpr int kMeans = 24;
constexpr int kJoints = 8;
constexpr std::size_t kRowsPerInsert = 10000;
constexpr double kThreshold = 1;

/// Returns the CPU time of this thread: without other programs and without waiting for the disk.
double processor_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double allocated_bytes() {
  const auto info = ::mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

using Key = std::vector<double>;

/// The edge of a cube in which `count` points leave kMatches in a ball of squared radius
/// kThreshold.
double cube_edge(std::int64_t count, int size) {
  const double ball =
      std::pow(std::numbers::pi * kThreshold, 0.5 * size) / std::tgamma(0.5 * size + 1);
  return std::pow(static_cast<double>(count) * ball / kMatches, 1.0 / size);
}

Key random_key(int size, double edge, Rng& rng) {
  Key key(static_cast<std::size_t>(size));
  for (double& number : key) number = rng.uniform(0, edge);
  return key;
}

/// Seconds of a single image's query, sorted, and the mean number of matches.
struct Latencies {
  std::vector<double> seconds;
  double matches = 0;
};

Latencies measure_queries(const internal::ExperienceIndex& index, int size, double edge, Rng& rng) {
  Latencies latencies;
  for (int i = 0; i < kQueries; ++i) {
    const std::vector<Key> query = {random_key(size, edge, rng)};
    const auto begin = processor_seconds();
    const auto found = index.find(query, kThreshold, kMatches);
    latencies.seconds.push_back(processor_seconds() - begin);
    latencies.matches += static_cast<double>(found.size()) / kQueries;
  }
  std::sort(latencies.seconds.begin(), latencies.seconds.end());
  return latencies;
}

void measure_index(std::int64_t count, int size) {
  Rng rng(1);
  const double edge = cube_edge(count, size);
  const double before = allocated_bytes();
  internal::ExperienceIndex index(size);
  const auto begin = processor_seconds();
  internal::IndexRows rows;
  for (std::int64_t i = 0; i < count; ++i) {
    const Key key = random_key(size, edge, rng);
    rows.keys.insert(rows.keys.end(), key.begin(), key.end());
    rows.ids.push_back(i + 1);
    rows.components.push_back(kMeans);
  }
  index.append(std::move(rows));
  const double build_s = processor_seconds() - begin;
  const double bytes = (allocated_bytes() - before) / static_cast<double>(count);
  const Latencies found = measure_queries(index, size, edge, rng);
  std::printf(
      "index: %lld keys of %d numbers: built in %.2f s, %.0f bytes per key, %.1f matches, "
      "p50 %.3f ms, p99 %.3f ms\n",
      static_cast<long long>(count), size, build_s, bytes, found.matches,
      1e3 * found.seconds[kQueries / 2], 1e3 * found.seconds[kQueries * 99 / 100]);
}

constexpr const char* kKind = "scale/1";

Experience make_row(int size, double edge, Rng& rng) {
  Experience row;
  row.kind = kKind;
  row.key = random_key(size, edge, rng);
  row.sampler().joint_count = kJoints;
  for (int i = 0; i < kMeans * kJoints; ++i) {
    row.sampler().means.push_back(static_cast<float>(rng.uniform(-3, 3)));
  }
  row.provenance = {"index_scale", "random", rng.next(), "2020-01-02T03:04:05Z"};
  return row;
}

/// Rows per second of the processor, or nothing if the disk is full.
std::optional<double> fill(const std::string& path, const RobotSignature& space, std::int64_t count,
                           int size, double edge) {
  Rng rng(1);
  double seconds = 0;
  auto database = Database::open(path, space, OpenMode::create);
  if (!database) return std::nullopt;
  for (std::int64_t done = 0; done < count;) {
    std::vector<Experience> rows;
    for (; rows.size() < kRowsPerInsert && done < count; ++done) {
      rows.push_back(make_row(size, edge, rng));
    }
    const auto begin = processor_seconds();
    if (!database->insert(std::move(rows))) return std::nullopt;
    seconds += processor_seconds() - begin;
  }
  return static_cast<double>(count) / seconds;
}

/// Times the opening of a database, queries of one image which find rows that were not asked for
/// before, and the same once more.
bool measure_opening(const std::string& path, const RobotSignature& space, int size, double edge,
                     const char* what) {
  const double before = allocated_bytes();
  const auto begin = processor_seconds();
  const auto opened = Database::open(path, space, OpenMode::read_only);
  const double open_s = processor_seconds() - begin;
  if (!opened) return false;
  const double bytes = (allocated_bytes() - before) / static_cast<double>(opened->size());
  Rng rng(2);
  Latencies first, again;
  for (int i = 0; i < kQueries; ++i) {
    const Key key = random_key(size, edge, rng);
    for (Latencies* found : {&first, &again}) {
      const auto start = processor_seconds();
      const auto matches = opened->find(kKind, {&key, 1}, kThreshold, kMatches);
      found->seconds.push_back(processor_seconds() - start);
      if (!matches) return false;
      found->matches += static_cast<double>(matches->size()) / kQueries;
    }
  }
  for (Latencies* found : {&first, &again}) std::sort(found->seconds.begin(), found->seconds.end());
  const auto ms = [](const Latencies& found, int percent) {
    return 1e3 * found.seconds[static_cast<std::size_t>(kQueries * percent / 100)];
  };
  std::printf(
      "database: %s: opened in %.2f s, %.0f bytes per row in memory; find(): %.1f matches, "
      "p50 %.3f ms, p99 %.3f ms, again p50 %.3f ms, p99 %.3f ms\n",
      what, open_s, bytes, first.matches, ms(first, 50), ms(first, 99), ms(again, 50),
      ms(again, 99));
  return true;
}

bool measure_database(std::int64_t count, int size) {
  const std::string path = std::filesystem::temp_directory_path() /
                           ("mneme_scale_" + std::to_string(::getpid()) + ".db");
  const std::string index = path + ".index";
  const RobotSignature space{"scale", "", "0123456789abcdef", kJoints};
  const double edge = cube_edge(count, size);
  const auto rows_per_s = fill(path, space, count, size, edge);
  if (rows_per_s) {
    std::printf("database: %lld keys of %d numbers: %.0f rows/s inserted, %.0f bytes per row\n",
                static_cast<long long>(count), size, *rows_per_s,
                static_cast<double>(std::filesystem::file_size(path)) / static_cast<double>(count));
  }
  const bool has_index = std::filesystem::exists(index);
  bool is_sound = rows_per_s && measure_opening(path, space, size, edge,
                                                has_index ? "with its index" : "all in memory");
  if (is_sound && has_index) {
    std::filesystem::remove(index);
    is_sound = measure_opening(path, space, size, edge, "without its index");
  }
  std::filesystem::remove(path);
  std::filesystem::remove(index);
  return is_sound;
}

}  // namespace
}  // namespace mneme::bench

int main(int argc, char** argv) {
  const std::int64_t count = argc > 1 ? std::atoll(argv[1]) : 100000;
  std::vector<int> sizes;
  for (int i = 2; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {6, 12, 20};
  for (const int size : sizes) {
    mneme::bench::measure_index(count, size);
    if (!mneme::bench::measure_database(count, size)) return 1;
  }
  return 0;
}
