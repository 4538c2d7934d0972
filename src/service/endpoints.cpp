// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/endpoints.h"

#include "mneme/task_file.h"

#include "base/fail.h"
#include "base/text.h"
#include "base/threads.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <optional>
#include <utility>

namespace mneme::internal {
namespace {

using Json = nlohmann::ordered_json;

/// Contacts in one answer, about 10 MB.
constexpr std::size_t kMostContacts = 100000;

Answer answer(const Json& json, int status = 200) {
  // Names come from clients and files and may hold any bytes; JSON must be UTF-8.
  return {status, json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"};
}

bool is_of_client(ErrorCode code) {
  return code == ErrorCode::parse || code == ErrorCode::unsupported || code == ErrorCode::invalid;
}

Answer no_scene(const std::string& id) {
  return refusal(404, "not_found", fmt::format("there is no scene \"{}\"", id));
}

/// The answer without a turn: the queue is full, or the request was cancelled.
Answer no_turn(bool is_cancelled) {
  if (is_cancelled)
    return refusal(503, "cancelled", "cancelled: the service stops, or the client disconnected");
  Answer busy = refusal(503, "busy", "too many requests are waiting: try again soon");
  busy.may_retry = true;
  return busy;
}

Json scene_json(const std::string& id, const Scene& scene) {
  Json names = Json::array();
  for (const Obstacle& obstacle : scene.obstacles) names.push_back(obstacle.name);
  Json json = {{"id", id}, {"obstacles", names}};
  if (!scene.warnings.empty()) json["warnings"] = scene.warnings;
  return json;
}

/// Notes of an answer begin with what was said of its request.
void add_warnings(std::vector<std::string>& notes, const std::vector<std::string>& warnings) {
  notes.insert(notes.begin(), warnings.begin(), warnings.end());
}

Json contacts_json(const std::vector<Contact>& contacts) {
  Json list = Json::array();
  for (const Contact& contact : contacts) {
    list.push_back({{"link", contact.link},
                    {"other", contact.other},
                    {"is_self", contact.is_self},
                    {"distance", contact.distance},
                    {"may_be_deeper", contact.may_be_deeper}});
  }
  return list;
}

Json state_json(const CollisionChecker& checker, const Configuration& q) {
  if (const auto violation = checker.robot().describe_violation(q, "configuration")) {
    return {{"valid", false}, {"message", *violation}, {"contacts", Json::array()}};
  }
  const bool is_valid = checker.is_valid(std::span<const double>(q));
  Json json = {{"valid", is_valid}};
  json["contacts"] = is_valid ? Json::array() : contacts_json(checker.contacts(q));
  return json;
}

/// Nothing if no trajectory is wanted, or there is no path.
Result<TimedPath> time_path(const PlanRequest& request, const SolveResult& result,
                            std::optional<Trajectory> motion) {
  if (!request.timing || !result.plan.is_solved()) return TimedPath{};
  const RateLimits& limits = *request.settings.plan.limits;
  if (!motion) {
    motion = MNEME_TRY(make_trajectory(request.problem, request.settings, result.plan.path, limits,
                                       *request.timing));
  }
  const auto points = MNEME_TRY(motion->sample(request.timing->dt));
  return TimedPath{measure_motion(*motion, limits), to_json(request.problem.robot, points)};
}

}  // namespace

Answer refusal(int status, std::string_view code, std::string_view message) {
  return answer({{"error", {{"code", code}, {"message", message}}}}, status);
}

Answer refusal(const Error& error) {
  return refusal(is_of_client(error.code) ? 400 : 500, to_string(error.code), error.message);
}

Endpoints::Endpoints(const Robot& robot, std::shared_ptr<Database> database,
                     const ServiceSettings& settings, LivePage page)
    : robot_(robot),
      database_(std::move(database)),
      settings_(settings),
      page_(std::move(page)),
      scenes_(settings.scenes),
      queue_(settings.threads, settings.queue) {
  // Fills the caches of the robot, so that the first client does not wait for them.
  static_cast<void>(CollisionChecker::make(robot_, {}));
  for (const std::shared_ptr<const Cell>& cell : settings.cells) {
    cell->prepare();
    motions_.emplace_back(*cell);
  }
  if (settings_.learn_idle) learner_ = std::make_unique<IdleLearner>(database_);
}

void Endpoints::set_stopping() {
  is_stopping_ = true;
  if (learner_ != nullptr) learner_->stop();
}

Result<void> Endpoints::keep_scene_of_page() {
  if (page_.kept.obstacles.empty()) return {};
  return scenes_.put(kLivePageScene, page_.kept).map([](const auto&) {});
}

RequestContext Endpoints::context() const {
  return {robot_, scenes_, settings_, database_ != nullptr};
}

void Endpoints::set_failure(std::string Endpoints::*failure, const std::string& message) {
  const std::lock_guard lock(mutex_);
  this->*failure = message;
}

void Endpoints::leave_memory(double patience_s) {
  if (database_ == nullptr) return;
  (void)database_->flush(patience_s);
  database_->stop_waiting();
}

void Endpoints::refresh_memory() {
  if (database_ == nullptr) return;
  const auto refreshed = internal::without_ending([&] { return database_->refresh(); });
  set_failure(&Endpoints::read_failure_, refreshed ? "" : refreshed.error().message);
}

std::optional<Endpoints::Outcome> Endpoints::ask_cells(const PlanRequest& request) {
  const SolveSettings& settings = request.settings;
  if (request.wants_trace || settings.plan.improve > 0) return std::nullopt;
  const Stopwatch stopwatch;
  for (std::size_t i = 0; i < settings_.cells.size(); ++i) {
    const Cell& cell = *settings_.cells[i];
    if (settings.margin > cell.margin()) continue;
    auto found = answer_from(cell, request.problem);
    if (!found) continue;
    Outcome outcome;
    SolveResult& result = outcome.result;
    result.plan.status = PlanStatus::solved;
    result.plan.path = found->path;
    result.goals = {found->path.back()};
    result.planner = "cell";
    result.sampler = to_string(found->tier);
    result.planning_time_s = result.total_time_s = stopwatch.elapsed_s();
    result.seed = settings.plan.seed;
    result.isa = default_isa();
    metrics_.add_cell_answer(to_string(found->tier));
    if (request.timing) {
      auto timed = motions_[i].time(*found, *settings.plan.limits, *request.timing);
      if (timed) outcome.motion = std::move(timed->motion);
    }
    outcome.cell = std::move(found);
    return outcome;
  }
  return std::nullopt;
}

void Endpoints::note_near_starts(const Problem& problem, SolveResult& result) const {
  for (const auto& cell : settings_.cells) {
    if (auto note = describe_near_start(*cell, problem)) result.notes.push_back(*std::move(note));
  }
}

Result<Endpoints::Outcome> Endpoints::solve_remembering(const PlanRequest& request) {
  if (auto answered = ask_cells(request)) return *std::move(answered);
  const Stopwatch stopwatch;
  Result<SolveResult> result = solve(request.problem, database_.get(), request.settings);
  if (result) note_near_starts(request.problem, *result);
  if (result) return Outcome{*std::move(result), ""};
  const Error error = result.error();
  if (database_ == nullptr || is_of_client(error.code)) return tl::unexpected(error);
  set_failure(&Endpoints::read_failure_, error.message);
  SolveSettings settings = request.settings;
  settings.plan.timeout_s = std::max(0.0, settings.plan.timeout_s - stopwatch.elapsed_s());
  return solve(request.problem, nullptr, settings).map([&](SolveResult without) {
    return Outcome{std::move(without), error.message};
  });
}

/// A request that has its turn. Interrupts work that takes longer than a plan may, or whose client
/// is gone.
class Endpoints::Work {
 public:
  Work(const Call& call, PlanQueue& queue, double longest_s)
      : call_(call),
        queue_(queue),
        scope_(
            [this, longest_s] { return call_.is_cancelled || stopwatch_.elapsed_s() > longest_s; }),
        turn_(queue.wait_for_turn(call.is_cancelled, {.bytes = call.body.size()})) {
    stopwatch_ = {};
  }

  [[nodiscard]] bool has_turn() const { return turn_.has_value(); }
  /// Gives the turn back and waits for one of `threads` threads.
  void wait_again(int threads, bool is_alone) {
    turn_.reset();
    if (auto turn =
            queue_.wait_for_turn(call_.is_cancelled, {threads, is_alone, call_.body.size()})) {
      turn_.emplace(*std::move(turn));
    }
    stopwatch_ = {};
  }
  /// Begins another part of the work, which may take as long again.
  void go_on() { stopwatch_ = {}; }
  void end_turn() { turn_.reset(); }

 private:
  const Call& call_;
  PlanQueue& queue_;
  Stopwatch stopwatch_;
  InterruptScope scope_;
  std::optional<PlanQueue::Turn> turn_;
};

Answer Endpoints::in_turn(const Call& call, const std::function<Result<Answer>(Work&)>& work) {
  const IdleLearner::Request request(learner_.get());
  Work granted(call, queue_, settings_.longest_plan_s);
  if (!granted.has_turn()) return no_turn(call.is_cancelled);
  try {
    Result<Answer> answered = work(granted);
    return answered ? *std::move(answered) : refusal(answered.error());
  } catch (const Interrupted&) {
    if (call.is_cancelled) return no_turn(true);
    return refusal(400, "invalid",
                   fmt::format("the request takes more than {} s, the limit of this service "
                               "(--longest-plan)",
                               settings_.longest_plan_s));
  }
}

std::string Endpoints::keep_trace(TracedPlan plan) {
  auto kept = std::make_shared<const TracedPlan>(std::move(plan));
  const std::lock_guard lock(mutex_);
  traces_[++last_trace_] = std::move(kept);
  while (traces_.size() > static_cast<std::size_t>(settings_.traces)) {
    traces_.erase(traces_.begin());
  }
  return std::to_string(last_trace_);
}

Answer Endpoints::plan(const Call& call) {
  return in_turn(call, [&](Work& work) { return plan_in_turn(call, work); });
}

bool Endpoints::wait_for_threads(const SolveSettings& settings, Work& work) const {
  const auto planner = find_planner(settings.planner);
  const bool is_alone = planner && (*planner)->is_exclusive;
  if (settings.threads > 1 || is_alone) work.wait_again(settings.threads, is_alone);
  return work.has_turn();
}

Result<Answer> Endpoints::plan_in_turn(const Call& call, Work& work) {
  PlanRequest request = MNEME_TRY(read_plan_request(call.body, call.query, context()));
  SolveSettings& settings = request.settings;
  if (!wait_for_threads(settings, work)) return no_turn(call.is_cancelled);

  settings.plan.cancel = &call.is_cancelled;
  if (request.may_remember) settings.remember_after = settings_.remember_after;
  if (request.timing) {
    RateLimits limits = MNEME_TRY(find_rate_limits(request.problem.robot, *request.timing));
    settings.plan.limits = std::make_shared<const RateLimits>(std::move(limits));
  }
  PlanRecorder recorder;
  if (request.wants_trace) settings.plan.observer = &recorder;

  work.go_on();
  Outcome outcome = MNEME_TRY(solve_remembering(request));
  const SolveResult& result = outcome.result;
  work.go_on();
  std::optional<PathMeasures> measures;
  if (request.wants_clearance)
    measures = measure_path(request.problem.robot, checked_scene(request.problem, result),
                            result.plan.path);
  const TimedPath timed = MNEME_TRY(time_path(request, result, std::move(outcome.motion)));
  work.end_turn();
  if (learner_ != nullptr && request.may_remember && !outcome.cell) {
    learner_->offer(request.problem, settings, result.plan);
  }
  return answer_plan(std::move(request), std::move(outcome), std::move(recorder),
                     measures ? &*measures : nullptr, timed);
}

Answer Endpoints::answer_plan(PlanRequest request, Outcome outcome, PlanRecorder recorder,
                              const PathMeasures* measures, const TimedPath& timed) {
  SolveResult& result = outcome.result;
  add_warnings(result.notes, request.problem.warnings);
  const Remembered& remembered = result.remembered;
  metrics_.add_plan(to_string(result.plan.status), result.gl.retrieved_count());
  if (remembered.is_queued || !remembered.failure.empty()) {
    set_failure(&Endpoints::write_failure_, remembered.failure);
  }
  std::string text =
      to_json(request.problem, result, 0, measures, timed.measures ? &*timed.measures : nullptr);
  const bool is_plain =
      !request.wants_trace && outcome.memory_failure.empty() && !outcome.cell && timed.json.empty();
  if (is_plain) return {200, std::move(text)};
  Json json = Json::parse(text);
  if (outcome.cell) {
    json["cell"] = {{"tier", to_string(outcome.cell->tier)}, {"box", outcome.cell->box}};
  }
  if (!outcome.memory_failure.empty()) json["memory_failure"] = outcome.memory_failure;
  if (!timed.json.empty()) json["trajectory"] = Json::parse(timed.json);
  if (request.wants_trace) {
    json["id"] = keep_trace({std::move(request.problem), result, std::move(recorder)});
  }
  return answer(json);
}

Answer Endpoints::task(const Call& call) {
  return in_turn(call, [&](Work& work) { return task_in_turn(call, work); });
}

Result<TaskResult> Endpoints::solve_remembering(const TaskRequest& request) {
  const Stopwatch stopwatch;
  Result<TaskResult> result = solve_task(request.task, database_.get(), request.settings);
  if (result || database_ == nullptr || is_of_client(result.error().code)) return result;
  set_failure(&Endpoints::read_failure_, result.error().message);
  TaskSettings settings = request.settings;
  double& timeout_s = settings.solve.plan.timeout_s;
  timeout_s = std::max(0.0, timeout_s - stopwatch.elapsed_s());
  return solve_task(request.task, nullptr, settings).map([&](TaskResult without) {
    without.notes.push_back("planned without memory: " + result.error().message);
    return without;
  });
}

Result<Answer> Endpoints::task_in_turn(const Call& call, Work& work) {
  TaskRequest request = MNEME_TRY(read_task_request(call.body, call.query, context()));
  SolveSettings& settings = request.settings.solve;
  if (!wait_for_threads(settings, work)) return no_turn(call.is_cancelled);
  settings.plan.cancel = &call.is_cancelled;
  if (request.may_remember) settings.remember_after = settings_.remember_after;
  const auto limits =
      find_rate_limits(request.task.robot, request.timing.value_or(TrajectorySettings()));
  if (request.timing && !limits) return tl::unexpected(limits.error());
  if (limits && !request.task.start_velocity.empty()) {
    settings.plan.limits = std::make_shared<const RateLimits>(*limits);
  }
  work.go_on();
  TaskResult result = MNEME_TRY(solve_remembering(request));
  add_warnings(result.notes, request.task.warnings);
  metrics_.add_plan(to_string(result.status), 0);
  const Task& task = request.task;
  if (!request.timing || !result.is_solved()) return Answer{200, to_json(task, result) + "\n"};
  work.go_on();
  const TaskMotion motion = MNEME_TRY(time_task(task, result, settings, *limits, *request.timing));
  const auto points = MNEME_TRY(motion.trajectory.sample(request.timing->dt));
  Json json = Json::parse(to_json(task, result, &motion));
  json["trajectory"] = Json::parse(to_json(task.robot, points, stage_begins(result, motion)));
  return answer(json);
}

Answer Endpoints::inverse_kinematics(const Call& call) {
  return in_turn(call, [&](Work&) { return inverse_kinematics_in_turn(call); });
}

Result<Answer> Endpoints::inverse_kinematics_in_turn(const Call& call) {
  IkRequest request = MNEME_TRY(read_ik_request(call.body, context()));
  const Problem& problem = request.problem;
  const auto checker = MNEME_TRY(
      CollisionChecker::make(problem.robot, problem.scene, {std::nullopt, request.margin}));
  const Stopwatch stopwatch;
  request.settings.is_over = [&] {
    return call.is_cancelled || stopwatch.elapsed_s() > settings_.longest_plan_s;
  };
  auto source = MNEME_TRY(PoseGoalSource::make(checker, problem.pose_goals, problem.start,
                                               request.settings, kVerificationMargin));
  Json solutions = Json::array();
  for (const Configuration& q : source.find_all()) {
    solutions.push_back({{"q", q}, {"distance", problem.robot.distance(problem.start, q)}});
  }
  if (call.is_cancelled) return no_turn(true);
  Json message;
  if (solutions.empty()) message = source.describe_failure();
  return answer({{"solutions", std::move(solutions)}, {"message", std::move(message)}});
}

Answer Endpoints::check(const Call& call) {
  return in_turn(call, [&](Work&) { return check_in_turn(call); });
}

Result<Answer> Endpoints::check_in_turn(const Call& call) {
  const CheckRequest request = MNEME_TRY(read_check_request(call.body, context()));
  const auto checker = MNEME_TRY(CollisionChecker::make(
      request.problem.robot, request.problem.scene, {std::nullopt, request.margin}));
  Json states = Json::array();
  std::size_t contacts = 0;
  for (const Configuration& q : request.configurations) {
    poll_interrupt();
    states.push_back(state_json(checker, q));
    contacts += states.back()["contacts"].size();
    if (contacts > kMostContacts) {
      return fail(ErrorCode::invalid,
                  "there are more than {} contacts: send fewer configurations per request",
                  kMostContacts);
    }
  }
  return answer({{"states", states}});
}

Answer Endpoints::put_scene(const Call& call) {
  return in_turn(call, [&](Work&) -> Result<Answer> {
    Scene scene = MNEME_TRY(read_scene_request(call.body, call.id, context()));
    const auto kept = MNEME_TRY(scenes_.put(call.id, std::move(scene)));
    return answer(scene_json(call.id, *kept));
  });
}

Answer Endpoints::patch_scene(const Call& call) {
  return in_turn(call, [&](Work&) -> Result<Answer> {
    const auto kept = MNEME_TRY(scenes_.change(
        call.id, [&](const Scene& scene) { return edit_scene(call.body, scene, context()); }));
    return kept == nullptr ? no_scene(call.id) : answer(scene_json(call.id, *kept));
  });
}

Answer Endpoints::delete_scene(const Call& call) {
  if (!scenes_.remove(call.id)) return no_scene(call.id);
  return answer({{"id", call.id}});
}

Answer Endpoints::scene(const Call& call) {
  const SceneStore::Kept scene = scenes_.find(call.id);
  return scene == nullptr ? no_scene(call.id) : answer(scene_json(call.id, *scene));
}

Answer Endpoints::trace(const Call& call) {
  const auto number = parse_number<std::uint64_t>(call.id);
  std::shared_ptr<const TracedPlan> plan;
  {
    const std::lock_guard lock(mutex_);
    const auto found = number ? traces_.find(*number) : traces_.end();
    if (found != traces_.end()) plan = found->second;
  }
  if (plan == nullptr) {
    return refusal(404, "not_found",
                   fmt::format("there is no trace {}: only the last {} traces are kept", call.id,
                               settings_.traces));
  }
  return in_turn(call, [&](Work&) -> Result<Answer> {
    const PlanTrace trace = MNEME_TRY(make_trace(plan->problem, plan->result, &plan->recorder, 0));
    return Answer{200, to_json(trace)};
  });
}

Answer Endpoints::health(const Call& call) {
  std::string failure;
  {
    const std::lock_guard lock(mutex_);
    failure = !read_failure_.empty() ? read_failure_ : write_failure_;
  }
  if (failure.empty() && database_ != nullptr) failure = database_->queued_rows().failure;
  Json json = {{"status", is_stopping_      ? "stopping"
                          : failure.empty() ? "ok"
                                            : "degraded"},
               {"version", version()},
               {"robot", robot_.name()},
               {"joints", robot_.joint_names()},
               {"uptime_s", uptime_.elapsed_s()},
               {"memory", nullptr}};
  if (database_ != nullptr) {
    json["memory"] = {{"rows", database_->size()}};
    if (call.knows_token && !failure.empty()) json["memory"]["failure"] = failure;
  }
  return answer(json);
}

Answer Endpoints::metrics_text(const Call& call) {
  const std::string text =
      metrics_.text({database_ == nullptr ? 0 : database_->size(),
                     database_ == nullptr ? QueuedRows() : database_->queued_rows(),
                     settings_.threads, queue_.waiting(), call.connections, scenes_.count(),
                     learner_ == nullptr ? 0 : learner_->finished()});
  return {200, text, "text/plain; version=0.0.4"};
}

}  // namespace mneme::internal
