// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Meshes that no robot meets, and a server of the database that stops.
#include "service/endpoints.h"
#include "service/service_fixture.h"
#ifdef MNEME_HAS_POSTGRESQL
#include "engines/postgres_server.h"
#endif

#include <atomic>
#include <csignal>
#include <map>
#include <string>
#include <vector>

namespace mneme::test {
namespace {

using internal::Answer;
using internal::Endpoints;

/// Numbers of triangles by what is wrong with them.
std::map<std::string, Json> hostile_triangles() {
  std::vector<double> points, slivers;
  for (int i = 0; i < 3000; ++i) points.insert(points.end(), {0.1, 0.2, 0.3});
  for (int i = 0; i < 20000; ++i) {
    slivers.insert(slivers.end(), {0, 0, 0, 1, 0, 0, 0.5, 1e-12 * i, i % 2 == 0 ? 0.0 : 1e-300});
  }
  Json deep = 1;
  for (int i = 0; i < 100; ++i) deep = Json::array({deep});
  return {{"none", Json::array()},
          {"points", points},
          {"huge", {1e308, -1e308, 1e308, 0, 1, 0, 0, 0, 1}},
          {"far", {1e30, 0, 0, 0, 1e30, 0, 0, 0, 1e30}},
          {"tiny", {1e-300, 0, 0, 0, 1e-300, 0, 0, 0, 1e-300}},
          {"slivers", slivers},
          {"no number", {nullptr, 0, 0, 0, 1, 0, 0, 0, 1}},
          {"text", {"0", 0, 0, 0, 1, 0, 0, 0, 1}},
          {"too few", {0, 0, 0, 0, 1, 0, 0, 0}},
          {"nested", deep},
          {"no list", 7}};
}

Json body_of(const Answer& answer) { return Json::parse(answer.body); }

TEST_SUITE("flow") {
  TEST_CASE("hostile meshes are answered, as obstacles and attached, and the service goes on") {
    ServiceSettings settings;
    settings.longest_plan_s = 2;  // spheres for slivers take longer
    const RunningService running(settings);
    for (const auto& [key, triangles] : hostile_triangles()) {
      const std::string name = key;
      CAPTURE(name);
      const bool has_numbers = name == "points" || name == "tiny" || name == "slivers";
      for (const bool is_attached : {false, true}) {
        CAPTURE(is_attached);
        Json body = question();
        Json mesh = {{"name", "m"}, {"type", "mesh"}, {"triangles", triangles}};
        if (is_attached) mesh["link"] = "link_8";
        Json& list = body[is_attached ? "attached" : "obstacles"];
        if (!list.is_array()) list = Json::array();
        list.push_back(mesh);
        const Reply reply = post(*running.client(), "/v1/plan", body);
        CAPTURE(reply.body.dump());
        CHECK((reply.status == 400 || (has_numbers && reply.status == 200)));
        if (reply.status == 400) CHECK(!reply.body["error"]["message"].get<std::string>().empty());
      }
    }
    CHECK(post(*running.client(), "/v1/plan", question()).body["solved"] == true);
  }

#ifdef MNEME_HAS_POSTGRESQL
  TEST_CASE("one refresh without an answer of the server makes the service degraded") {
    PostgresServer* server = PostgresServer::instance();
    if (server == nullptr) return;
    auto opened = Database::open(server->new_url(), make_signature(planar8()), OpenMode::create,
                                 {.answer_timeout_s = 0.3});
    REQUIRE_MESSAGE(opened.has_value(), (opened ? "" : opened.error().message));
    ServiceSettings settings;
    settings.threads = 1;
    Endpoints endpoints(planar8(), std::make_shared<Database>(*std::move(opened)), settings, {});
    const std::atomic<bool> never = false;
    const auto status = [&] { return body_of(endpoints.health({"", "", never, true}))["status"]; };
    endpoints.refresh_memory();
    CHECK(status() == "ok");
    server->signal(SIGSTOP);
    endpoints.refresh_memory();
    const Json while_stopped = status();
    const Json plan = body_of(endpoints.plan({"", question().dump(), never}));
    server->signal(SIGCONT);
    CHECK(while_stopped == "degraded");
    CHECK(plan["solved"] == true);
    for (int i = 0; i < 20 && status() != "ok"; ++i) endpoints.refresh_memory();
    CHECK(status() == "ok");
  }
#endif
}

}  // namespace
}  // namespace mneme::test
