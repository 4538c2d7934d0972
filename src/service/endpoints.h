// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The endpoints without HTTP: from the body of a request to the body of its answer.
#pragma once

#include "mneme/cell_motion.h"
#include "mneme/live.h"
#include "mneme/report.h"
#include "mneme/service.h"

#include "service/answer.h"
#include "service/idle_learner.h"
#include "service/metrics.h"
#include "service/plan_queue.h"
#include "service/requests.h"
#include "service/scene_store.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace mneme::internal {

/// A request to an endpoint.
struct Call {
  std::string id;  ///< from the path; may be empty
  const std::string& body;
  const std::atomic<bool>& is_cancelled;  ///< set when the client disconnects or the service stops
  bool knows_token = true;
  int connections = 0;          ///< open connections of the service
  std::string_view query = {};  ///< of the URL, after the question mark
};

/// The trajectory of a path, if one was requested.
struct TimedPath {
  std::optional<MotionMeasures> measures;
  std::string json;  ///< as of `mneme plan --trajectory FILE.json`; empty without
};

/// Thread-safe.
class Endpoints {
 public:
  /// `settings.threads` must be above 0.
  Endpoints(const Robot& robot, std::shared_ptr<Database> database, const ServiceSettings& settings,
            LivePage page);

  [[nodiscard]] Answer plan(const Call& call);
  [[nodiscard]] Answer task(const Call& call);
  [[nodiscard]] Answer inverse_kinematics(const Call& call);
  [[nodiscard]] Answer check(const Call& call);
  [[nodiscard]] Answer put_scene(const Call& call);
  [[nodiscard]] Answer patch_scene(const Call& call);
  [[nodiscard]] Answer delete_scene(const Call& call);
  [[nodiscard]] Answer scene(const Call& call);
  [[nodiscard]] Answer trace(const Call& call);
  /// Reports the state of the service. Only clients with the token get the cause of a failure of
  /// the database.
  [[nodiscard]] Answer health(const Call& call);
  [[nodiscard]] Answer metrics_text(const Call& call);
  [[nodiscard]] Answer page(const Call&) { return {200, page_.html, "text/html; charset=utf-8"}; }

  /// Keeps the scene of the page at `/`. Error: the store of scenes is full.
  [[nodiscard]] Result<void> keep_scene_of_page();
  [[nodiscard]] Metrics& metrics() { return metrics_; }
  /// Loads new rows of other processes from the database.
  void refresh_memory();
  /// Stores queued rows as far as `patience_s` allows, ends calls that wait for a server, and
  /// refuses later rows.
  void leave_memory(double patience_s);
  /// Makes health() report "stopping" and ends learning in idle time.
  void set_stopping();

 private:
  /// A plan whose trace can be requested.
  struct TracedPlan {
    Problem problem;
    SolveResult result;
    PlanRecorder recorder;
  };
  struct Outcome {
    SolveResult result;
    std::string memory_failure;  ///< the reason why it planned without memory, or empty
    std::optional<CellAnswer> cell = std::nullopt;    ///< the answer of a cell, if it has one
    std::optional<Trajectory> motion = std::nullopt;  ///< of the cell's answer
  };
  class Work;
  /// Waits for a planning thread of the service and returns the answer that `work` makes on it,
  /// or refuses the request with its error.
  /// `work` and all functions that it calls may throw Interrupted.
  [[nodiscard]] Answer in_turn(const Call& call, const std::function<Result<Answer>(Work&)>& work);
  [[nodiscard]] Result<Answer> plan_in_turn(const Call& call, Work& work);
  [[nodiscard]] Result<Answer> task_in_turn(const Call& call, Work& work);
  [[nodiscard]] Result<Answer> inverse_kinematics_in_turn(const Call& call);
  [[nodiscard]] Result<Answer> check_in_turn(const Call& call);
  [[nodiscard]] RequestContext context() const;
  /// Returns the answer of a cell, if the request is a task of one.
  [[nodiscard]] std::optional<Outcome> ask_cells(const PlanRequest& request);
  /// Adds a note for each cell one of whose starts the problem's start is near, but not the same.
  void note_near_starts(const Problem& problem, SolveResult& result) const;
  [[nodiscard]] Result<Outcome> solve_remembering(const PlanRequest& request);
  /// Plans without memory, and says why, if the database does not answer.
  [[nodiscard]] Result<TaskResult> solve_remembering(const TaskRequest& request);
  /// Waits for the threads that the settings need. Returns false if the turn was lost.
  [[nodiscard]] bool wait_for_threads(const SolveSettings& settings, Work& work) const;
  [[nodiscard]] Answer answer_plan(PlanRequest request, Outcome outcome, PlanRecorder recorder,
                                   const PathMeasures* measures, const TimedPath& timed);
  [[nodiscard]] std::string keep_trace(TracedPlan plan);
  void set_failure(std::string Endpoints::*failure, const std::string& message);

  Robot robot_;
  std::shared_ptr<Database> database_;
  ServiceSettings settings_;
  std::vector<CellMotions> motions_;  ///< of the settings' cells
  LivePage page_;
  SceneStore scenes_;
  PlanQueue queue_;
  Metrics metrics_;
  Stopwatch uptime_;
  std::atomic<bool> is_stopping_ = false;
  mutable std::mutex mutex_;
  std::string read_failure_;   ///< empty after a successful refresh
  std::string write_failure_;  ///< empty after a successful insertion
  std::map<std::uint64_t, std::shared_ptr<const TracedPlan>> traces_;
  std::uint64_t last_trace_ = 0;
  std::unique_ptr<IdleLearner> learner_;  ///< null: learns from requests alone
};

}  // namespace mneme::internal
