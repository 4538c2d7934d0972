// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/client.h"

#include "client/request_body.h"

#include <fmt/format.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include <charconv>
#include <chrono>
#include <cmath>
#include <string_view>
#include <thread>
#include <utility>
#include <sys/socket.h>

namespace mneme {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kUnix = "unix:";
constexpr std::string_view kHttp = "http://";

/// HOST and PORT of "http://HOST:PORT", of "http://[HOST]:PORT" too.
Result<std::pair<std::string, int>> split_address(const std::string& address) {
  const auto refused = [&] {
    return fail(ErrorCode::invalid,
                fmt::format("'{}': expected http://HOST:PORT or unix:PATH", address));
  };
  if (!address.starts_with(kHttp)) return refused();
  const std::string_view rest = std::string_view(address).substr(kHttp.size());
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return refused();
  std::string_view host = rest.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  int port = 0;
  const char* end = rest.data() + rest.size();
  const auto read = std::from_chars(rest.data() + colon + 1, end, port);
  const bool is_port = read.ec == std::errc() && read.ptr == end && port > 0 && port < 65536;
  if (!is_port || host.empty()) return refused();
  return std::pair(std::string(host), port);
}

ErrorCode code_of(const std::string& name) {
  for (const ErrorCode code : {ErrorCode::parse, ErrorCode::unsupported, ErrorCode::wrong_robot,
                               ErrorCode::corrupt, ErrorCode::io}) {
    if (to_string(code) == name) return code;
  }
  return name == "busy" || name == "internal" ? ErrorCode::io : ErrorCode::invalid;
}

tl::unexpected<Error> unreadable(const std::string& path) {
  return fail(ErrorCode::io,
              fmt::format("{}: expected an answer of mneme serve, got something else", path));
}

/// Why there is no answer; the library's own words are names of its enumerators.
std::string describe(httplib::Error error, double timeout_s) {
  switch (error) {
    case httplib::Error::Connection:
    case httplib::Error::BindIPAddress:
      return "cannot connect; is `mneme serve` running there?";
    case httplib::Error::ConnectionTimeout:
      return "cannot connect in time";
    case httplib::Error::Read:
      return fmt::format("it went away, or took longer than {:g} s", timeout_s);
    case httplib::Error::Write:
      return "it went away while it was being asked";
    default:
      return "the connection failed";
  }
}

/// What a service refused, in its words.
tl::unexpected<Error> refusal_of(const std::string& path, const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  const bool is_refusal = json.is_object() && json.contains("error") && json["error"].is_object() &&
                          json["error"].contains("code") && json["error"].contains("message") &&
                          json["error"]["code"].is_string() && json["error"]["message"].is_string();
  if (!is_refusal) return unreadable(path);
  return fail(code_of(json["error"]["code"]), json["error"]["message"].get<std::string>());
}

PlanStatus status_of(const std::string& name) {
  for (const PlanStatus status :
       {PlanStatus::solved, PlanStatus::iteration_limit, PlanStatus::node_limit,
        PlanStatus::cancelled, PlanStatus::invalid_start, PlanStatus::invalid_goal}) {
    if (to_string(status) == name) return status;
  }
  return PlanStatus::timeout;
}

}  // namespace

class Client::State {
 public:
  State(std::unique_ptr<httplib::Client> http, const ClientSettings& settings)
      : http_(std::move(http)), settings_(settings) {
    http_->set_keep_alive(true);
    http_->set_tcp_nodelay(true);
    const auto timeout = std::chrono::duration<double>(settings.timeout_s);
    http_->set_read_timeout(std::chrono::duration_cast<std::chrono::microseconds>(timeout));
    if (!settings.token.empty()) http_->set_bearer_token_auth(settings.token);
  }

  Result<std::string> ask(const std::string& method, const std::string& path,
                          const std::string& body) {
    const Stopwatch stopwatch;
    while (true) {
      const httplib::Result answer = send(method, path, body);
      if (!answer) {
        return fail(ErrorCode::io, fmt::format("{}{}: no answer: {}", settings_.address, path,
                                               describe(answer.error(), settings_.timeout_s)));
      }
      if (answer->status < 400) return answer->body;
      const std::string wait = answer->get_header_value("Retry-After");
      const double wait_s = wait.empty() ? 0 : std::atof(wait.c_str());
      if (wait.empty() || stopwatch.elapsed_s() + wait_s > settings_.patience_s) {
        return refusal_of(path, answer->body);
      }
      std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
    }
  }

  Result<Json> ask_json(const std::string& method, const std::string& path, const Json& body) {
    const std::string text = body.dump(-1, ' ', false, Json::error_handler_t::replace);
    auto answer = ask(method, path, text);
    if (!answer) return tl::unexpected(answer.error());
    Json json = Json::parse(*answer, nullptr, false);
    if (!json.is_object()) return unreadable(path);
    return json;
  }

 private:
  httplib::Result send(const std::string& method, const std::string& path,
                       const std::string& body) {
    httplib::Request request;
    request.method = method;
    request.path = path;
    request.body = body;
    if (!body.empty()) request.set_header("Content-Type", "application/json");
    return http_->send(request);
  }

  std::unique_ptr<httplib::Client> http_;
  ClientSettings settings_;
};

Result<Client> Client::make(const ClientSettings& settings) {
  std::unique_ptr<httplib::Client> http;
  if (settings.address.starts_with(kUnix) && settings.address.size() > kUnix.size()) {
    http = std::make_unique<httplib::Client>(settings.address.substr(kUnix.size()), 1);
    http->set_address_family(AF_UNIX);
  } else {
    const auto address = split_address(settings.address);
    if (!address) return tl::unexpected(address.error());
    http = std::make_unique<httplib::Client>(address->first, address->second);
  }
  return Client(std::make_unique<State>(std::move(http), settings));
}

Client::Client(std::unique_ptr<State> state) : state_(std::move(state)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

Result<RemotePlan> Client::plan(const Problem& problem, const SolveSettings& settings) {
  return plan(problem, "", settings);
}

Result<RemotePlan> Client::plan(const Problem& problem, const std::string& scene_id,
                                const SolveSettings& settings) {
  const std::string path = "/v1/plan";
  const auto json =
      state_->ask_json("POST", path, internal::plan_body(problem, scene_id, settings));
  if (!json) return tl::unexpected(json.error());
  try {
    RemotePlan plan;
    plan.status = status_of(json->at("status"));
    plan.message = json->value("message", "");
    plan.path = json->at("path").get<Path>();
    plan.path_length = json->at("path_length");
    plan.total_time_s = json->at("total_time_s");
    plan.iterations = json->at("iterations");
    plan.remembered = json->at("remembered");
    plan.json = json->dump();
    return plan;
  } catch (const Json::exception&) {
    return unreadable(path);
  }
}

Result<std::vector<Configuration>> Client::inverse_kinematics(std::span<const PoseGoal> goals,
                                                              const Configuration& near,
                                                              const Scene& scene,
                                                              const IkSettings& settings) {
  const std::string path = "/v1/ik";
  const auto json = state_->ask_json("POST", path, internal::ik_body(goals, near, scene, settings));
  if (!json) return tl::unexpected(json.error());
  try {
    std::vector<Configuration> found;
    for (const Json& solution : json->at("solutions")) found.push_back(solution.at("q"));
    return found;
  } catch (const Json::exception&) {
    return unreadable(path);
  }
}

Result<void> Client::put_scene(const std::string& id, const Scene& scene) {
  return state_->ask_json("PUT", "/v1/scenes/" + id, internal::scene_body(scene))
      .map([](const Json&) {});
}

Result<void> Client::delete_scene(const std::string& id) {
  return ask("DELETE", "/v1/scenes/" + id, "").map([](const std::string&) {});
}

Result<std::string> Client::ask(const std::string& method, const std::string& path,
                                const std::string& json_body) {
  return state_->ask(method, path, json_body);
}

}  // namespace mneme
