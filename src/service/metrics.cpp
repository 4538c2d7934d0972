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

/// A counter by the values of `label`.
void add_counts(std::string& text, std::string_view name, std::string_view label,
                std::string_view help,
                const std::map<std::string, std::uint64_t, std::less<>>& counts) {
  add_head(text, name, "counter", help);
  for (const auto& [value, count] : counts) {
    fmt::format_to(std::back_inserter(text), "{}{{{}=\"{}\"}} {}\n", name, label, value, count);
  }
}

void add_requests(std::string& text, const ServiceCounts& counts) {
  add_head(text, "mneme_requests_total", "counter", "Answered requests.");
  for (const auto& [key, count] : counts.requests) {
    fmt::format_to(std::back_inserter(text),
                   "mneme_requests_total{{path=\"{}\",status=\"{}\"}} {}\n", key.first, key.second,
                   count);
  }
}

void add_latencies(std::string& text, ServiceCounts& counts) {
  add_head(text, "mneme_request_seconds", "summary",
           "Seconds from the last byte of a request to its answer. Quantiles of the last 1024.");
  const auto out = std::back_inserter(text);
  for (auto& [path, latencies] : counts.latencies) {
    std::vector<float>& last = latencies.last;
    std::ranges::sort(last);
    for (const double quantile : {0.5, 0.95, 0.99}) {
      const auto rank = static_cast<std::size_t>(quantile * static_cast<double>(last.size() - 1));
      fmt::format_to(out, "mneme_request_seconds{{path=\"{}\",quantile=\"{}\"}} {:.6g}\n", path,
                     quantile, last[rank]);
    }
    fmt::format_to(out, "mneme_request_seconds_sum{{path=\"{}\"}} {:.6g}\n", path, latencies.sum_s);
    fmt::format_to(out, "mneme_request_seconds_count{{path=\"{}\"}} {}\n", path, latencies.count);
  }
}

void add_plans(std::string& text, const ServiceCounts& counts, const QueuedRows& queued) {
  add_counts(text, "mneme_plans_total", "status", "Plans by status.", counts.plans);
  add_single(text, "mneme_memory_hits_total", "counter",
             "Plans for which memory had local samplers.", counts.hits);
  add_single(text, "mneme_retrieved_total", "counter", "Local samplers from memory.",
             counts.retrieved);
  add_single(text, "mneme_remembered_total", "counter",
             "Rows of plans that are stored: they survive a killed process.", queued.stored);
  add_single(text, "mneme_remembered_lost_total", "counter",
             "Rows of plans that could not be stored.", queued.lost);
}

void add_gauges(std::string& text, const ServiceGauges& gauges) {
  add_single(text, "mneme_memory_rows", "gauge", "Rows of the memory.", gauges.memory_rows);
  add_single(text, "mneme_remembered_waiting", "gauge", "Rows of plans that wait to be stored.",
             gauges.queued.waiting);
  add_single(text, "mneme_studied_total", "counter",
             "Problems that were studied while no request was at work.", gauges.studied);
  add_single(text, "mneme_threads", "gauge", "Plans that can run at a time.", gauges.threads);
  add_single(text, "mneme_waiting", "gauge", "Requests that wait for a thread.", gauges.waiting);
  add_single(text, "mneme_connections", "gauge", "Open connections.", gauges.connections);
  add_single(text, "mneme_scenes", "gauge", "Uploaded scenes.", gauges.scenes);
}

}  // namespace

void ServiceCounts::Latencies::add(double seconds) {
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
  ++counts_.requests[{std::string(endpoint), status}];
  counts_.latencies[std::string(endpoint)].add(seconds);
}

void Metrics::add_plan(std::string_view status, std::size_t retrieved) {
  const std::lock_guard lock(mutex_);
  ++counts_.plans[std::string(status)];
  counts_.hits += retrieved > 0 ? 1 : 0;
  counts_.retrieved += retrieved;
}

void Metrics::add_cell_answer(std::string_view tier) {
  const std::lock_guard lock(mutex_);
  ++counts_.cell_answers[std::string(tier)];
}

std::string Metrics::text(const ServiceGauges& gauges) const {
  // A copy, so that requests do not wait for sorting and printing.
  ServiceCounts counts = [&] {
    const std::lock_guard lock(mutex_);
    return counts_;
  }();
  std::string text;
  add_requests(text, counts);
  add_latencies(text, counts);
  add_plans(text, counts, gauges.queued);
  if (!counts.cell_answers.empty()) {
    add_counts(text, "mneme_cell_answers_total", "tier", "Plans that cells answered, by tier.",
               counts.cell_answers);
  }
  add_gauges(text, gauges);
  return text;
}

}  // namespace mneme::internal
