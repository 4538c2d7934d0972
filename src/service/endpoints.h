// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the service answers, without HTTP: from the body of a request to that of its answer.
#pragma once

#include "mneme/report.h"
#include "mneme/service.h"

#include "service/metrics.h"
#include "service/plan_queue.h"
#include "service/requests.h"
#include "service/scene_store.h"

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace mneme::internal {

struct Answer {
  int status = 200;
  std::string body;
  const char* type = "application/json";
  bool may_retry = false;  ///< soon, because it is busy
};
/// {"error": {"code": ..., "message": ...}}
[[nodiscard]] Answer refusal(int status, std::string_view code, std::string_view message);
[[nodiscard]] Answer refusal(const Error& error);

/// A request, as the endpoints take it.
struct Call {
  std::string id;  ///< that its path names, if it does
  const std::string& body;
  const std::atomic<bool>& is_cancelled;  ///< set once the client goes away or the service stops
  bool knows_token = true;
  int connections = 0;  ///< of the service, by now
};

/// All of it is safe from any thread.
class Endpoints {
 public:
  /// The settings are complete: `threads` is above 0.
  Endpoints(const Robot& robot, std::shared_ptr<Database> database, const ServiceSettings& settings,
            LivePage page);

  [[nodiscard]] Answer plan(const Call& call);
  [[nodiscard]] Answer inverse_kinematics(const Call& call);
  [[nodiscard]] Answer check(const Call& call);
  [[nodiscard]] Answer put_scene(const Call& call);
  [[nodiscard]] Answer patch_scene(const Call& call);
  [[nodiscard]] Answer delete_scene(const Call& call);
  [[nodiscard]] Answer scene(const Call& call);
  [[nodiscard]] Answer trace(const Call& call);
  /// What is wrong with memory is told to those who know the token, only that something is to
  /// others.
  [[nodiscard]] Answer health(const Call& call);
  [[nodiscard]] Answer metrics_text(const Call& call);
  [[nodiscard]] Answer page(const Call&) { return {200, page_.html, "text/html; charset=utf-8"}; }

  /// Error: no room for it.
  [[nodiscard]] Result<void> keep_scene_of_page();
  [[nodiscard]] Metrics& metrics() { return metrics_; }
  /// Looks for rows of other processes.
  void refresh_memory();
  /// Health says so from now on.
  void set_stopping() { is_stopping_ = true; }

 private:
  /// A plan that may be asked for its trace.
  struct TracedPlan {
    Problem problem;
    SolveResult result;
    PlanRecorder recorder;
  };
  struct Outcome {
    SolveResult result;
    std::string memory_failure;  ///< why it planned without memory
  };
  [[nodiscard]] RequestContext context() const;
  [[nodiscard]] Result<Outcome> solve_remembering(const PlanRequest& request);
  [[nodiscard]] std::string keep_trace(TracedPlan plan);
  void set_failure(std::string Endpoints::*failure, const std::string& message);

  Robot robot_;
  std::shared_ptr<Database> database_;
  ServiceSettings settings_;
  LivePage page_;
  SceneStore scenes_;
  PlanQueue queue_;
  Metrics metrics_;
  Stopwatch uptime_;
  std::atomic<bool> is_stopping_ = false;
  mutable std::mutex mutex_;
  std::string read_failure_;   ///< the last one, until memory answers again
  std::string write_failure_;  ///< the last one, until a plan has been remembered again
  std::map<std::uint64_t, std::shared_ptr<const TracedPlan>> traces_;
  std::uint64_t last_trace_ = 0;
};

}  // namespace mneme::internal
