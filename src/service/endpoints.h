// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What the service answers, without HTTP: from the body of a request to that of its answer.
#pragma once

#include "mneme/report.h"
#include "mneme/service.h"

#include "service/client_watch.h"
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

/// All of it is safe from any thread.
class Endpoints {
 public:
  /// The settings are complete: `threads` is above 0.
  Endpoints(const Robot& robot, std::shared_ptr<Database> database,
            const ServiceSettings& settings);

  /// `socket` is that of the client, who may go away.
  [[nodiscard]] Answer plan(const std::string& body, int socket);
  [[nodiscard]] Answer inverse_kinematics(const std::string& body, int socket);
  [[nodiscard]] Answer check(const std::string& body, int socket);
  [[nodiscard]] Answer put_scene(const std::string& id, const std::string& body);
  [[nodiscard]] Answer patch_scene(const std::string& id, const std::string& body);
  [[nodiscard]] Answer delete_scene(const std::string& id);
  [[nodiscard]] Answer scene(const std::string& id) const;
  [[nodiscard]] Answer trace(const std::string& id, int socket);
  /// What is wrong with memory is told to those who may plan, only that something is to others.
  [[nodiscard]] Answer health(bool may_plan) const;
  [[nodiscard]] Answer metrics_text(int connections) const;

  /// Error: no room for it.
  [[nodiscard]] Result<void> keep_scene_of_page();
  [[nodiscard]] Metrics& metrics() { return metrics_; }
  /// Looks for rows of other processes.
  void refresh_memory();
  /// Health says so from now on.
  void set_stopping() { is_stopping_ = true; }
  void cancel_all() { watch_.cancel_all(); }

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
  /// Not locked if the planner is not exclusive, or once `is_cancelled`.
  [[nodiscard]] std::unique_lock<std::timed_mutex> wait_alone(
      const std::string& planner, const std::atomic<bool>& is_cancelled);
  [[nodiscard]] Result<Outcome> solve_remembering(const PlanRequest& request);
  [[nodiscard]] std::string keep_trace(TracedPlan plan);
  void set_failure(std::string Endpoints::*failure, const std::string& message);

  Robot robot_;
  std::shared_ptr<Database> database_;
  ServiceSettings settings_;
  SceneStore scenes_;
  PlanQueue queue_;
  ClientWatch watch_;
  Metrics metrics_;
  Stopwatch uptime_;
  std::atomic<bool> is_stopping_ = false;
  std::timed_mutex exclusive_;  ///< of planners that run one at a time in a process
  mutable std::mutex mutex_;
  std::string read_failure_;   ///< the last one, until memory answers again
  std::string write_failure_;  ///< the last one, until a plan has been remembered again
  std::map<std::uint64_t, std::shared_ptr<const TracedPlan>> traces_;
  std::uint64_t last_trace_ = 0;
};

}  // namespace mneme::internal
