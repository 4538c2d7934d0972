// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/service.h"

#include "service/endpoints.h"
#include "service/http_server.h"
#include "service/live_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

namespace mneme {
namespace {

using internal::Answer;
using internal::Endpoints;
using internal::HttpServer;
using internal::refusal;
using httplib::Request;
using httplib::Response;

constexpr std::size_t kHeadBytes = std::size_t{64} << 10;
constexpr double kGrace = 0.5;    ///< seconds for what runs when the service stops
constexpr double kGoodbye = 0.3;  ///< seconds for the answers to what was cancelled then
constexpr const char* kNames = "([A-Za-z0-9_.-]{1,64})";

ServiceSettings completed(ServiceSettings settings) {
  if (settings.threads <= 0) {
    settings.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }
  return settings;
}

/// Equal or not, in a time that does not tell where they differ.
bool is_same_secret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference |= static_cast<unsigned>(a[i] ^ b[i]);
  }
  return difference == 0;
}

void respond(Response& response, Answer answer) {
  response.status = answer.status;
  if (answer.may_retry) response.set_header("Retry-After", "1");
  response.set_content(std::move(answer.body), answer.type);
}

/// The body of the request was not read: what comes after the head is no next request.
void respond_and_close(Response& response, Answer answer) {
  HttpServer::connection().close_after_answer();
  response.set_header("Connection", "close");
  respond(response, std::move(answer));
}

/// Why a request is not even looked at.
std::optional<Answer> refuse_head(const Request& request, const std::string& token) {
  const bool is_free = token.empty() || request.path == "/healthz";
  if (!is_free && !is_same_secret(request.get_header_value("Authorization"), "Bearer " + token)) {
    return refusal(401, "unauthorized", "expected the header Authorization: Bearer TOKEN");
  }
  if (request.has_header("Content-Encoding")) {
    return refusal(415, "unsupported", "expected a body that is not compressed");
  }
  const bool has_body =
      request.method == "POST" || request.method == "PUT" || request.method == "PATCH";
  // Pages of other origins can send forms and plain text without being asked, but no JSON.
  if (has_body && !request.get_header_value("Content-Type").starts_with("application/json")) {
    return refusal(415, "unsupported", "expected the header Content-Type: application/json");
  }
  return std::nullopt;
}

}  // namespace

class Service::State {
 public:
  State(internal::Listener listener, const Robot& robot, std::shared_ptr<Database> database,
        const ServiceSettings& settings, std::string page)
      : settings_(completed(settings)),
        page_(std::move(page)),
        endpoints_(robot, database, settings_),
        server_(std::move(listener),
                {settings.request_timeout_s, settings.idle_timeout_s,
                 settings.body_bytes + kHeadBytes},
                settings.connections) {
    add_routes();
    server_.start();
    if (database != nullptr) refresher_ = std::thread([this] { refresh(); });
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { stop(); }

  [[nodiscard]] const std::string& address() const { return server_.address(); }

  void stop() {
    {
      const std::lock_guard lock(mutex_);
      if (std::exchange(is_stopping_, true)) return;
    }
    wake_.notify_one();
    endpoints_.set_stopping();
    server_.stop_accepting();
    server_.wait(kGrace);
    endpoints_.cancel_all();
    server_.wait(kGoodbye);
    server_.join();
    if (refresher_.joinable()) refresher_.join();
  }

 private:
  using Handler = std::function<Answer(const Request&)>;

  /// `endpoint` as metrics name it.
  [[nodiscard]] HttpServer::Handler timed(const std::string& endpoint, Handler handler) {
    return [this, endpoint, handler = std::move(handler)](const Request& request,
                                                          Response& response) {
      const Stopwatch stopwatch;
      respond(response, handler(request));
      endpoints_.metrics().add_request(endpoint, response.status, stopwatch.elapsed_s());
    };
  }

  static int socket() { return HttpServer::connection().socket(); }

  void add_routes() {
    server_.set_payload_max_length(settings_.body_bytes);
    server_.Post("/v1/plan", timed("/v1/plan", [this](const Request& request) {
                   return endpoints_.plan(request.body, socket());
                 }));
    server_.Post("/v1/check", timed("/v1/check", [this](const Request& request) {
                   return endpoints_.check(request.body, socket());
                 }));
    server_.Get(std::string("/v1/plans/") + kNames + "/trace",
                timed("/v1/plans/{id}/trace", [this](const Request& request) {
                  return endpoints_.trace(request.matches[1], socket());
                }));
    server_.Get("/healthz",
                timed("/healthz", [this](const Request&) { return endpoints_.health(); }));
    server_.Get("/metrics", timed("/metrics", [this](const Request&) {
                  return endpoints_.metrics_text(server_.connection_count());
                }));
    server_.Get("/", timed("/", [this](const Request&) {
                  return Answer{200, page_, "text/html; charset=utf-8"};
                }));
    add_scene_routes();
    add_refusals();
  }

  void add_scene_routes() {
    const std::string pattern = std::string("/v1/scenes/") + kNames;
    const std::string endpoint = "/v1/scenes/{id}";
    server_.Get(pattern, timed(endpoint, [this](const Request& request) {
                  return endpoints_.scene(request.matches[1]);
                }));
    server_.Put(pattern, timed(endpoint, [this](const Request& request) {
                  return endpoints_.put_scene(request.matches[1], request.body);
                }));
    server_.Patch(pattern, timed(endpoint, [this](const Request& request) {
                    return endpoints_.patch_scene(request.matches[1], request.body);
                  }));
    server_.Delete(pattern, timed(endpoint, [this](const Request& request) {
                     return endpoints_.delete_scene(request.matches[1]);
                   }));
  }

  void add_refusals() {
    server_.set_pre_routing_handler([this](const Request& request, Response& response) {
      auto refused = refuse_head(request, settings_.token);
      if (!refused) return HttpServer::HandlerResponse::Unhandled;
      endpoints_.metrics().add_request("refused", refused->status, 0);
      respond_and_close(response, *std::move(refused));
      return HttpServer::HandlerResponse::Handled;
    });
    // What httplib refuses by itself has no body yet.
    server_.set_error_handler([this](const Request& request, Response& response) {
      if (!response.body.empty()) return;
      endpoints_.metrics().add_request("refused", response.status, 0);
      const bool is_missing = response.status == 404;
      const std::string message =
          is_missing ? fmt::format("there is no {} {}", request.method, request.path)
                     : "the request cannot be read, or is beyond a limit";
      respond_and_close(response, refusal(response.status, is_missing ? "not_found" : "refused",
                                          message));
    });
    server_.set_exception_handler(
        [](const Request&, Response& response, const std::exception_ptr&) {
          respond(response, refusal(500, "internal", "the request could not be answered"));
        });
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
  std::string page_;
  Endpoints endpoints_;
  HttpServer server_;  ///< after what its threads use
  std::thread refresher_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool is_stopping_ = false;
};

Result<Service> Service::start(const Robot& robot, std::shared_ptr<Database> database,
                               const ServiceSettings& settings) {
  if (settings.remember_after && database == nullptr) {
    return fail(ErrorCode::invalid, "to remember paths takes a database");
  }
  auto listener = internal::listen_at(settings.listen, !settings.token.empty());
  if (!listener) return tl::unexpected(listener.error());
  auto page = internal::make_live_page(robot, database != nullptr, settings);
  if (!page) return tl::unexpected(page.error());
  return Service(std::make_unique<State>(*std::move(listener), robot, std::move(database),
                                         settings, *std::move(page)));
}

Service::Service(std::unique_ptr<State> state) : state_(std::move(state)) {}
Service::Service(Service&&) noexcept = default;
Service& Service::operator=(Service&&) noexcept = default;
Service::~Service() = default;

const std::string& Service::address() const { return state_->address(); }

void Service::stop() { state_->stop(); }

}  // namespace mneme
