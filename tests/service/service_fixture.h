// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A service of the planar arm on a free port, its clients, and questions for it.
#pragma once

#include "mneme/service.h"

#include "support/planar_circles.h"
#include "support/support.h"

#include <fmt/format.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <vector>

namespace mneme::test {

using Json = nlohmann::json;

/// The keys of a compact file for a problem of the planar arm.
inline Json question(const std::string& name = "scenario1") {
  const auto problem = require(load_problem(source_file("scenes/planar/" + name + ".yaml")));
  const Json file = Json::parse(to_compact_json({problem.scene, ""}));
  Json body = {{"start", problem.start}, {"goals", problem.goals}};
  for (const char* key : {"obstacles", "circles"}) {
    if (file["problems"][0].contains(key)) body[key] = file["problems"][0][key];
  }
  return body;
}

/// There is no way: it is planned until somebody ends it.
inline Json endless_question() {
  const Json file = Json::parse(to_compact_json({ring_with_two_windows(), ""}));
  std::vector<double> start(8, 0.0), goal(8, 0.0);
  goal[0] = kPi / 2;
  return {{"obstacles", file["problems"][0]["obstacles"]},
          {"start", start},
          {"goal", goal},
          {"settings", {{"planner", "prm"}, {"timeout", 50}}}};
}

inline ServiceSettings loopback(ServiceSettings settings = {}) {
  settings.listen = "127.0.0.1:0";
  return settings;
}

struct RunningService {
  explicit RunningService(const ServiceSettings& settings = {},
                          std::shared_ptr<Database> database = nullptr)
      : service(start(loopback(settings), std::move(database))) {}

  static Service start(const ServiceSettings& settings, std::shared_ptr<Database> database) {
    return require(Service::start(planar8(), std::move(database), settings));
  }
  [[nodiscard]] int port() const {
    return std::stoi(service.address().substr(service.address().rfind(':') + 1));
  }
  [[nodiscard]] std::unique_ptr<httplib::Client> client() const {
    auto client = std::make_unique<httplib::Client>("127.0.0.1", port());
    client->set_keep_alive(true);
    client->set_tcp_nodelay(true);
    client->set_read_timeout(100);
    return client;
  }

  Service service;
};

struct Reply {
  int status = 0;
  Json body;
  httplib::Headers headers;
};

inline Reply reply_of(const httplib::Result& result) {
  REQUIRE(bool(result));
  return {result->status, Json::parse(result->body, nullptr, false), result->headers};
}

inline Reply post(httplib::Client& client, const std::string& path, const Json& body) {
  return reply_of(client.Post(path, body.dump(), "application/json"));
}

}  // namespace mneme::test
