// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/service.h"

#include "base/check_ranges.h"
#include "service/endpoints.h"
#include "service/http_server.h"

#include <boost/beast/core/string.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

namespace mneme {
namespace {

using internal::Answer;
using internal::Call;
using internal::Endpoints;
using internal::HttpRequest;
using internal::HttpServer;
using internal::refusal;
using internal::takes_body;
namespace http = internal::http;
namespace beast = boost::beast;

constexpr double kGrace = 0.4;    ///< seconds for running requests when the service stops
constexpr double kGoodbye = 0.2;  ///< seconds to answer requests that were cancelled then
/// Seconds from the request to stop until queued rows are given up, and at least those for them.
constexpr double kLastRow = 0.65, kLeastFlush = 0.05;
constexpr std::string_view kScenes = "/v1/scenes/";
constexpr std::string_view kId = "{id}";
constexpr std::size_t kMostIdBytes = 64;
constexpr std::string_view kIdBytes =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";

ServiceSettings completed(ServiceSettings settings) {
  if (settings.threads <= 0) {
    settings.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }
  return settings;
}

struct Route {
  http::verb method;
  std::string_view path;  ///< as in documents and metrics
  Answer (Endpoints::*answer)(const Call&);
};

constexpr Route kRoutes[] = {
    {http::verb::post, "/v1/plan", &Endpoints::plan},
    {http::verb::post, "/v1/tasks", &Endpoints::task},
    {http::verb::post, "/v1/ik", &Endpoints::inverse_kinematics},
    {http::verb::post, "/v1/check", &Endpoints::check},
    {http::verb::get, "/v1/plans/{id}/trace", &Endpoints::trace},
    {http::verb::get, "/v1/scenes/{id}", &Endpoints::scene},
    {http::verb::put, "/v1/scenes/{id}", &Endpoints::put_scene},
    {http::verb::patch, "/v1/scenes/{id}", &Endpoints::patch_scene},
    {http::verb::delete_, "/v1/scenes/{id}", &Endpoints::delete_scene},
    {http::verb::get, "/healthz", &Endpoints::health},
    {http::verb::get, "/metrics", &Endpoints::metrics_text},
    {http::verb::get, "/", &Endpoints::page},
};

std::string_view path_of(const HttpRequest& request) {
  const std::string_view target(request.target().data(), request.target().size());
  return target.substr(0, target.find('?'));
}

std::string_view query_of(const HttpRequest& request) {
  const std::string_view target(request.target().data(), request.target().size());
  return target.substr(std::min(target.size(), path_of(request).size() + 1));
}

/// Returns the part of `path` that matches {id}, or an empty string if `pattern` has none. Empty if
/// they do not match.
std::optional<std::string> match(std::string_view pattern, std::string_view path) {
  const std::size_t at = pattern.find(kId);
  if (at == std::string_view::npos) return pattern == path ? std::optional("") : std::nullopt;
  const std::string_view before = pattern.substr(0, at), after = pattern.substr(at + kId.size());
  if (!path.starts_with(before) || !path.ends_with(after)) return std::nullopt;
  if (path.size() <= before.size() + after.size()) return std::nullopt;
  path = path.substr(at, path.size() - before.size() - after.size());
  const bool is_id =
      path.size() <= kMostIdBytes && path.find_first_not_of(kIdBytes) == std::string_view::npos;
  return is_id ? std::optional(std::string(path)) : std::nullopt;
}

/// Returns the route of a request, or null, and its id.
std::pair<const Route*, std::string> find_route(const HttpRequest& request) {
  const bool is_head = request.method() == http::verb::head;
  const http::verb method = is_head ? http::verb::get : request.method();
  for (const Route& route : kRoutes) {
    if (route.method != method) continue;
    if (auto id = match(route.path, path_of(request))) return {&route, *std::move(id)};
  }
  return {nullptr, ""};
}

std::string header(const HttpRequest& request, http::field name) {
  const auto value = request[name];
  return {value.data(), value.size()};
}

/// Compares in a time that does not depend on the position of a difference.
bool is_same_secret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference |= static_cast<unsigned>(a[i] ^ b[i]);
  }
  return difference == 0;
}

bool knows(const std::string& token, const HttpRequest& request) {
  constexpr beast::string_view kScheme = "Bearer ";
  if (token.empty()) return true;
  const std::string given = header(request, http::field::authorization);
  return beast::iequals(given.substr(0, kScheme.size()), kScheme) &&
         is_same_secret(std::string_view(given).substr(kScheme.size()), token);
}

/// Refuses unknown paths, with 400 for an invalid scene id.
std::optional<Answer> refuse_path(const HttpRequest& request) {
  if (find_route(request).first != nullptr) return std::nullopt;
  const bool is_scene = path_of(request).starts_with(kScenes);
  const std::string message =
      fmt::format("there is no {} {}{}", std::string(request.method_string()), path_of(request),
                  is_scene ? ": a scene id has 1 to 64 letters, digits, '_', '.' and '-'" : "");
  return is_scene && request.method() == http::verb::put ? refusal(400, "invalid", message)
                                                         : refusal(404, "not_found", message);
}

bool is_json(const std::string& type) {
  return beast::iequals(type.substr(0, type.find_first_of("; \t")), "application/json");
}

/// Refuses a request to the service at `address` by its head.
std::optional<Answer> refuse_head(const HttpRequest& request, const ServiceSettings& settings,
                                  const std::string& address) {
  if (path_of(request) != "/healthz" && !knows(settings.token, request)) {
    return refusal(401, "unauthorized", "expected the header Authorization: Bearer TOKEN");
  }
  const bool is_open = settings.token.empty() && address.starts_with("http:");
  if (is_open && !internal::is_own_host(header(request, http::field::host), address)) {
    return refusal(403, "forbidden",
                   fmt::format("expected the header Host to name this machine, as in {}: a service "
                               "without a token answers local programs only",
                               address));
  }
  if (auto refused = refuse_path(request)) return refused;
  if (request.count(http::field::content_encoding) > 0) {
    return refusal(415, "unsupported", "expected an uncompressed body");
  }
  // Pages of other origins can send forms and plain text without a preflight request, but no JSON.
  if (takes_body(request) && !is_json(header(request, http::field::content_type))) {
    return refusal(415, "unsupported", "expected the header Content-Type: application/json");
  }
  return std::nullopt;
}

Result<void> check(const ServiceSettings& settings, bool has_memory) {
  if (settings.remember_after && !has_memory) {
    return fail(ErrorCode::invalid, "remember-after needs a database");
  }
  if (settings.learn_idle && !settings.remember_after) {
    return fail(ErrorCode::invalid, "learn-idle needs remember-after");
  }
  return internal::check_ranges(settings);
}

}  // namespace

class Service::State {
 public:
  State(const Robot& robot, std::shared_ptr<Database> database, const ServiceSettings& settings,
        LivePage page)
      : settings_(completed(settings)),
        has_memory_(database != nullptr),
        endpoints_(robot, std::move(database), settings_, std::move(page)),
        server_({[this](const HttpRequest& request) {
                   return refuse_head(request, settings_, address());
                 },
                 [this](const HttpRequest& request, const std::atomic<bool>& is_cancelled) {
                   return answer(request, is_cancelled);
                 },
                 [this](int status) { endpoints_.metrics().add_request("refused", status, 0); }},
                {.request_timeout_s = settings.request_timeout_s,
                 .idle_timeout_s = settings.idle_timeout_s,
                 .request = {.body_bytes = settings.body_bytes},
                 .connections = settings.connections,
                 .busy_requests = settings_.threads + 1 + settings.queue}) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { stop(); }

  [[nodiscard]] const std::string& address() const { return server_.address(); }

  Result<void> start() {
    MNEME_TRY(endpoints_.keep_scene_of_page());
    MNEME_TRY(server_.start(settings_.listen, !settings_.token.empty()));
    if (has_memory_) refresher_ = std::thread([this] { refresh(); });
    return {};
  }

  /// Concurrent calls return together.
  void stop() {
    std::call_once(stopped_, [this] { stop_once(); });
  }

 private:
  void stop_once() {
    const Stopwatch stopwatch;
    {
      const std::lock_guard lock(mutex_);
      is_stopping_ = true;
    }
    wake_.notify_one();
    endpoints_.set_stopping();
    server_.stop_accepting();
    server_.wait(kGrace);
    server_.cancel_all();
    server_.wait(kGoodbye);
    // Before join(), which waits for requests that do not notice that they are cancelled.
    endpoints_.leave_memory(std::max(kLeastFlush, kLastRow - stopwatch.elapsed_s()));
    server_.join();
    if (refresher_.joinable()) refresher_.join();
  }

  Answer answer(const HttpRequest& request, const std::atomic<bool>& is_cancelled) {
    const Stopwatch stopwatch;
    const auto [route, id] = find_route(request);
    Answer answer = (endpoints_.*route->answer)({id, request.body(), is_cancelled,
                                                 knows(settings_.token, request),
                                                 server_.connection_count(), query_of(request)});
    endpoints_.metrics().add_request(route->path, answer.status, stopwatch.elapsed_s());
    return answer;
  }

  void refresh() {
    std::unique_lock lock(mutex_);
    const std::chrono::duration<double> period(settings_.refresh_s);
    while (!wake_.wait_for(lock, period, [&] { return is_stopping_; })) {
      lock.unlock();
      endpoints_.refresh_memory();
      lock.lock();
    }
  }

  ServiceSettings settings_;
  bool has_memory_;
  Endpoints endpoints_;
  HttpServer server_;  ///< after the members that its threads use
  std::thread refresher_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool is_stopping_ = false;
  std::once_flag stopped_;
};

Result<Service> Service::start(const Robot& robot, std::shared_ptr<Database> database,
                               const ServiceSettings& settings) {
  MNEME_TRY(check(settings, database != nullptr));
  TraceSettings looks;
  looks.package_paths = settings.package_paths;
  LivePage page = MNEME_TRY(
      make_live_page(settings.shown ? *settings.shown : resting_problem(robot, settings.robot_path),
                     database != nullptr, looks));
  try {
    auto state = std::make_unique<State>(robot, std::move(database), settings, std::move(page));
    MNEME_TRY(state->start());
    return Service(std::move(state));
  } catch (const std::system_error& error) {
    return fail(ErrorCode::io, std::string("cannot serve: no thread is left: ") + error.what());
  } catch (const boost::system::system_error& error) {
    return fail(ErrorCode::io, std::string("cannot listen: ") + error.what());
  }
}

Service::Service(std::unique_ptr<State> state) : state_(std::move(state)) {}
Service::Service(Service&&) noexcept = default;
Service& Service::operator=(Service&&) noexcept = default;
Service::~Service() = default;

const std::string& Service::address() const { return state_->address(); }

void Service::stop() { state_->stop(); }

}  // namespace mneme
