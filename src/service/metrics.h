// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Counts and latencies of a service in the text format of Prometheus.
#pragma once

#include "mneme/experience.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme::internal {

/// The state of a service.
struct ServiceGauges {
  std::int64_t memory_rows = 0;
  QueuedRows queued;  ///< remembered rows on their way into the database
  int threads = 0;
  int waiting = 0;
  int connections = 0;
  std::size_t scenes = 0;
  std::uint64_t studied = 0;  ///< problems, in idle time
};

/// Counts since the start of a service.
struct ServiceCounts {
  /// The last latencies, for quantiles.
  struct Latencies {
    static constexpr std::size_t kKept = 1024;
    std::vector<float> last;
    std::size_t next = 0;
    std::uint64_t count = 0;
    double sum_s = 0;
    void add(double seconds);
  };

  std::map<std::pair<std::string, int>, std::uint64_t, std::less<>> requests;
  std::map<std::string, Latencies, std::less<>> latencies;
  std::map<std::string, std::uint64_t, std::less<>> plans;
  std::map<std::string, std::uint64_t, std::less<>> cell_answers;  ///< by tier
  std::uint64_t hits = 0, retrieved = 0;
};

/// Thread-safe.
class Metrics {
 public:
  /// `endpoint`: a documented path, such as "/v1/scenes/{id}".
  void add_request(std::string_view endpoint, int status, double seconds);
  /// `status`: a PlanStatus in words. `retrieved`: local samplers from memory.
  void add_plan(std::string_view status, std::size_t retrieved);
  /// `tier`: a CellTier in words.
  void add_cell_answer(std::string_view tier);

  /// Returns all metrics in the text format of Prometheus.
  [[nodiscard]] std::string text(const ServiceGauges& gauges) const;

 private:
  mutable std::mutex mutex_;
  ServiceCounts counts_;
};

}  // namespace mneme::internal
