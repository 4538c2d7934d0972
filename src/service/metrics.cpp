// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace mneme::internal {
namespace {

void add_head(std::string& text, std::string_view name, std::string_view type,
              std::string_view help) {
  fmt::format_to(std::back_inserter(text), "# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
}

template <class Value>
void add_single(std::string& text, std::string_view name, std::string_view type,
                std::string_view help, Value value) {
  add_head(text, name, type, help);
  fmt::format_to(std::back_inserter(text), "{} {}\n", name, value);
}

}  // namespace

void Metrics::Latencies::add(double seconds) {
  if (last.size() < kKept) {
    last.push_back(static_cast<float>(seconds));
  } else {
    last[next] = static_cast<float>(seconds);
    next = (next + 1) % kKept;
  }
  ++count;
  sum_s += seconds;
}

void Metrics::add_request(std::string_view endpoint, int status, double seconds) {
  const std::lock_guard lock(mutex_);
  ++requests_[{std::string(endpoint), status}];
  latencies_[std::string(endpoint)].add(seconds);
}

void Metrics::add_plan(std::string_view status, std::size_t retrieved, int remembered) {
  const std::lock_guard lock(mutex_);
  ++plans_[std::string(status)];
  hits_ += retrieved > 0 ? 1 : 0;
  retrieved_ += retrieved;
  remembered_ += static_cast<std::uint64_t>(remembered);
}

std::string Metrics::text(const ServiceGauges& gauges) const {
  const std::lock_guard lock(mutex_);
  std::string text;
  const auto out = std::back_inserter(text);
  add_head(text, "mneme_requests_total", "counter", "Requests that were answered.");
  for (const auto& [key, count] : requests_) {
    fmt::format_to(out, "mneme_requests_total{{path=\"{}\",status=\"{}\"}} {}\n", key.first,
                   key.second, count);
  }
  add_head(text, "mneme_request_seconds", "summary",
           "From the last byte of a request to its answer; quantiles of the last 1024.");
  for (const auto& [path, latencies] : latencies_) {
    std::vector<float> sorted = latencies.last;
    std::ranges::sort(sorted);
    for (const double quantile : {0.5, 0.95, 0.99}) {
      const auto rank = static_cast<std::size_t>(quantile * static_cast<double>(sorted.size() - 1));
      fmt::format_to(out, "mneme_request_seconds{{path=\"{}\",quantile=\"{}\"}} {:.6g}\n", path,
                     quantile, sorted[rank]);
    }
    fmt::format_to(out, "mneme_request_seconds_sum{{path=\"{}\"}} {:.6g}\n", path,
                   latencies.sum_s);
    fmt::format_to(out, "mneme_request_seconds_count{{path=\"{}\"}} {}\n", path, latencies.count);
  }
  add_head(text, "mneme_plans_total", "counter", "Plans by how they ended.");
  for (const auto& [status, count] : plans_) {
    fmt::format_to(out, "mneme_plans_total{{status=\"{}\"}} {}\n", status, count);
  }
  add_single(text, "mneme_memory_hits_total", "counter", "Plans that memory gave samplers.", hits_);
  add_single(text, "mneme_retrieved_total", "counter", "Samplers that memory gave.", retrieved_);
  add_single(text, "mneme_remembered_total", "counter", "Samplers that plans taught.", remembered_);
  add_single(text, "mneme_memory_rows", "gauge", "Samplers in memory.", gauges.memory_rows);
  add_single(text, "mneme_threads", "gauge", "Plans that may run at a time.", gauges.threads);
  add_single(text, "mneme_waiting", "gauge", "Requests that wait for a thread.", gauges.waiting);
  add_single(text, "mneme_connections", "gauge", "Connections that are open.", gauges.connections);
  add_single(text, "mneme_scenes", "gauge", "Scenes that are kept.", gauges.scenes);
  return text;
}

}  // namespace mneme::internal
