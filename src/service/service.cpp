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
#include <cstring>
#include <functional>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

namespace mneme {
namespace {

using httplib::Request;
using httplib::Response;
using internal::Answer;
using internal::Endpoints;
using internal::HttpServer;
using internal::refusal;

constexpr double kGrace = 0.5;    ///< seconds for what runs when the service stops
constexpr double kGoodbye = 0.3;  ///< seconds for the answers to what was cancelled then
constexpr const char* kNames = "([A-Za-z0-9_.-]{1,64})";
constexpr std::string_view kScenes = "/v1/scenes/";

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

bool knows(const std::string& token, const Request& request) {
  return token.empty() ||
         is_same_secret(request.get_header_value("Authorization"), "Bearer " + token);
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

bool takes_body(const Request& request) {
  return request.method == "POST" || request.method == "PUT" || request.method == "PATCH";
}

bool is_count(std::string_view text) {
  return !text.empty() && text.size() <= 18 &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Why it is not certain where a request ends: a proxy before the service may see another end, and
/// what one client sends as a body would be a request of the next (RFC 9112, 6.3 and 11.2).
std::optional<Answer> refuse_framing(const Request& request) {
  const auto refuse = [](std::string_view message) { return refusal(400, "invalid", message); };
  for (const auto& [name, value] : request.headers) {
    if (name.find_first_of(" \t") != std::string::npos) {
      return refuse("expected headers as NAME: VALUE, without blanks in the name");
    }
  }
  const std::size_t lengths = request.get_header_value_count("Content-Length");
  const std::size_t encodings = request.get_header_value_count("Transfer-Encoding");
  if (lengths + encodings > 1) return refuse("expected one Content-Length or Transfer-Encoding");
  const std::string length = request.get_header_value("Content-Length");
  if (lengths > 0 && !is_count(length)) return refuse("Content-Length: expected a whole number");
  const std::string encoding = request.get_header_value("Transfer-Encoding");
  if (encodings > 0 && strcasecmp(encoding.c_str(), "chunked") != 0) {
    return refuse("Transfer-Encoding: expected chunked");
  }
  const bool has_none = encodings == 0 && (lengths == 0 || length == "0");
  // httplib reads a body of known length after DELETE, and leaves it unread after other methods.
  const bool is_read = takes_body(request) || (request.method == "DELETE" && encodings == 0);
  if (!is_read && !has_none) return refuse("expected no body");
  if (takes_body(request) && lengths + encodings == 0) {
    return refusal(411, "invalid", "expected the header Content-Length");
  }
  return std::nullopt;
}

/// What is not served. A scene that is called so is a mistake of whoever uploads it.
Answer refuse_path(const Request& request) {
  const bool is_scene = request.path.starts_with(kScenes);
  const std::string message =
      fmt::format("there is no {} {}{}", request.method, request.path,
                  is_scene ? ": ids of scenes are 1 to 64 letters, digits, '_', '.' and '-'" : "");
  return is_scene && request.method == "PUT" ? refusal(400, "invalid", message)
                                             : refusal(404, "not_found", message);
}

bool is_json(const std::string& type) {
  const std::string essence = type.substr(0, type.find_first_of("; \t"));
  return strcasecmp(essence.c_str(), "application/json") == 0;
}

/// Why a request to the service at `address` is not even looked at.
std::optional<Answer> refuse_head(const Request& request, const ServiceSettings& settings,
                                  const std::string& address) {
  if (auto refused = refuse_framing(request)) return refused;
  if (request.path != "/healthz" && !knows(settings.token, request)) {
    return refusal(401, "unauthorized", "expected the header Authorization: Bearer TOKEN");
  }
  const bool is_open =
      settings.token.empty() && address.starts_with("http:") && request.has_header("Host");
  if (is_open && !internal::is_own_host(request.get_header_value("Host"), address)) {
    return refusal(403, "forbidden",
                   fmt::format("expected the header Host to name this machine, as in {}: without a "
                               "token only its own programs are answered",
                               address));
  }
  const std::string length = request.get_header_value("Content-Length");
  if (!length.empty() && std::stoull(length) > settings.body_bytes) {
    return refusal(413, "refused",
                   fmt::format("expected a body of at most {} bytes", settings.body_bytes));
  }
  if (request.has_header("Content-Encoding")) {
    return refusal(415, "unsupported", "expected a body that is not compressed");
  }
  // Pages of other origins can send forms and plain text without being asked, but no JSON.
  if (takes_body(request) && !is_json(request.get_header_value("Content-Type"))) {
    return refusal(415, "unsupported", "expected the header Content-Type: application/json");
  }
  return std::nullopt;
}

Result<void> check(const ServiceSettings& settings, bool has_memory) {
  if (settings.remember_after && !has_memory) {
    return fail(ErrorCode::invalid, "to remember paths takes a database");
  }
  const struct {
    const char* name;
    double value, least;
  } bounds[] = {{"threads", static_cast<double>(settings.threads), 0},
                {"queue", static_cast<double>(settings.queue), 0},
                {"connections", static_cast<double>(settings.connections), 1},
                {"longest_plan_s", settings.longest_plan_s, 1e-3},
                {"request_timeout_s", settings.request_timeout_s, 1e-3},
                {"idle_timeout_s", settings.idle_timeout_s, 1e-3},
                {"obstacles", static_cast<double>(settings.obstacles), 0},
                {"scenes", static_cast<double>(settings.scenes), 0},
                {"traces", static_cast<double>(settings.traces), 1},
                {"refresh_s", settings.refresh_s, 1e-3}};
  for (const auto& [name, value, least] : bounds) {
    // Longer times than clocks can tell; written so that a NaN is out of range.
    if (value >= least && value <= 1e9) continue;
    return fail(ErrorCode::invalid,
                fmt::format("{}: expected a number of {} or more, got {}", name, least, value));
  }
  return {};
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
                {.request_timeout_s = settings.request_timeout_s,
                 .idle_timeout_s = settings.idle_timeout_s,
                 .body_bytes = settings.body_bytes},
                settings.connections) {
    add_routes();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { stop(); }

  [[nodiscard]] const std::string& address() const { return server_.address(); }

  Result<void> start(bool has_memory) {
    const auto kept = endpoints_.keep_scene_of_page();
    if (!kept) return kept;
    if (has_memory) refresher_ = std::thread([this] { refresh(); });
    return server_.start();
  }

  /// Whoever calls it while another one does returns with that one.
  void stop() {
    std::call_once(stopped_, [this] { stop_once(); });
  }

 private:
  void stop_once() {
    {
      const std::lock_guard lock(mutex_);
      is_stopping_ = true;
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

  using Handler = std::function<Answer(const Request&)>;

  /// `endpoint` as metrics name it.
  [[nodiscard]] HttpServer::Handler timed(const std::string& endpoint, Handler handler) {
    return
        [this, endpoint, handler = std::move(handler)](const Request& request, Response& response) {
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
    server_.Post("/v1/ik", timed("/v1/ik", [this](const Request& request) {
                   return endpoints_.inverse_kinematics(request.body, socket());
                 }));
    server_.Post("/v1/check", timed("/v1/check", [this](const Request& request) {
                   return endpoints_.check(request.body, socket());
                 }));
    server_.Get(std::string("/v1/plans/") + kNames + "/trace",
                timed("/v1/plans/{id}/trace", [this](const Request& request) {
                  return endpoints_.trace(request.matches[1], socket());
                }));
    server_.Get("/healthz", timed("/healthz", [this](const Request& request) {
                  return endpoints_.health(knows(settings_.token, request));
                }));
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
    const std::string pattern = std::string(kScenes) + kNames;
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
      auto refused = refuse_head(request, settings_, address());
      if (!refused) {
        HttpServer::connection().expect_body();
        return HttpServer::HandlerResponse::Unhandled;
      }
      endpoints_.metrics().add_request("refused", refused->status, 0);
      respond_and_close(response, *std::move(refused));
      return HttpServer::HandlerResponse::Handled;
    });
    // What httplib refuses by itself has no body yet.
    server_.set_error_handler([this](const Request& request, Response& response) {
      if (!response.body.empty()) return;
      Answer refused = response.status == 404
                           ? refuse_path(request)
                           : refusal(response.status, "refused",
                                     "the request cannot be read, or is beyond a limit");
      endpoints_.metrics().add_request("refused", refused.status, 0);
      if (response.status == 416) {
        // It would still be sent once per range: nothing is not.
        HttpServer::connection().close_after_answer();
        return;
      }
      respond_and_close(response, std::move(refused));
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
  std::once_flag stopped_;
};

Result<Service> Service::start(const Robot& robot, std::shared_ptr<Database> database,
                               const ServiceSettings& settings) {
  if (const auto checked = check(settings, database != nullptr); !checked) {
    return tl::unexpected(checked.error());
  }
  auto listener = internal::listen_at(settings.listen, !settings.token.empty());
  if (!listener) return tl::unexpected(listener.error());
  auto page = internal::make_live_page(robot, database != nullptr, settings);
  if (!page) return tl::unexpected(page.error());
  try {
    const bool has_memory = database != nullptr;
    auto state = std::make_unique<State>(*std::move(listener), robot, std::move(database), settings,
                                         *std::move(page));
    if (const auto started = state->start(has_memory); !started) {
      return tl::unexpected(started.error());
    }
    return Service(std::move(state));
  } catch (const std::system_error& error) {
    return fail(ErrorCode::io, std::string("cannot serve: no thread to be had: ") + error.what());
  }
}

Service::Service(std::unique_ptr<State> state) : state_(std::move(state)) {}
Service::Service(Service&&) noexcept = default;
Service& Service::operator=(Service&&) noexcept = default;
Service::~Service() = default;

const std::string& Service::address() const { return state_->address(); }

void Service::stop() { state_->stop(); }

}  // namespace mneme
