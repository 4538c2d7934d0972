// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "service/endpoints.h"
#include "goal/posed_robots.h"
#include "service/service_fixture.h"

#include <doctest/doctest.h>

#include <atomic>
#include <string>

namespace mneme::test {
namespace {

const std::vector<double> kHome = {0, -0.785, 0, -2.356, 0, 1.571, 0.785};

Json box(const std::string& name, const std::vector<double>& p, const std::vector<double>& size) {
  return {{"name", name}, {"type", "box"}, {"p", p}, {"size", size}};
}

/// Takes a cup from a table by one of 20 grasps.
Json task_question() {
  const Json grasps = {
      {"frame", "cup"},
      {"position", {-0.115, 0, 0}},
      {"quat_xyzw", {0, 0.70710678, 0, 0.70710678}},
      {"vary", {{{"turn", "z"}, {"from", -3}, {"to", 3}, {"count", 20}}}},
  };
  const Json approach = {
      {"direction", {0, 0, 1}}, {"along", "panda_hand"}, {"distance", 0.08}, {"to", grasps}};
  Json cup = {{"name", "cup"}, {"type", "cylinder"}, {"p", {0.5, -0.1, 0.2505}}};
  cup["radius"] = 0.035;
  cup["length"] = 0.1;
  return {{"obstacles", {box("table", {0.5, 0, 0.1}, {0.6, 0.8, 0.2}), cup}},
          {"start", kHome},
          {"settings", {{"seed", 3}, {"branches", 4}}},
          {"stages",
           {{{"name", "reach"}, {"move", "next"}},
            {{"name", "approach"}, {"line", approach}},
            {{"name", "grasp"}, {"attach", "cup"}},
            {{"name", "lift"}, {"line", {{"direction", {0, 0, 1}}, {"distance", 0.1}}}}}}};
}

TEST_SUITE("flow") {
  TEST_CASE("a service plans tasks, and times them") {
    auto service = require(Service::start(shipped_robot("panda"), nullptr, loopback()));
    httplib::Client client(service.address());
    client.set_read_timeout(100);
    Json body = task_question();
    const Reply plain = post(client, "/v1/tasks", body);
    REQUIRE_MESSAGE(plain.status == 200, plain.body.dump());
    REQUIRE(plain.body["status"] == "solved");
    REQUIRE(plain.body["stages"].size() == 4);
    CHECK(plain.body["stages"][1]["alternatives"] == 20);
    CHECK_FALSE(plain.body.contains("trajectory"));
    CHECK(plain.body["plans"] == 1);
    Json better = body;
    better["settings"].update({{"timeout", 30}, {"improve", 30}, {"improve-rounds", 2}});
    CHECK(post(client, "/v1/tasks", better).body["plans"] == 2);
    body["trajectory"] = {{"dt", 0.05}};
    const Reply timed = post(client, "/v1/tasks", body);
    REQUIRE(timed.status == 200);
    CHECK(timed.body["stages"][3]["path"] == plain.body["stages"][3]["path"]);
    const Json& trajectory = timed.body["trajectory"];
    CHECK(trajectory["duration_s"] == timed.body["duration_s"]);
    CHECK(trajectory["stages"][2]["name"] == "grasp");
    CHECK(trajectory["stages"][3]["begin_s"] == timed.body["stages"][3]["begin_s"]);
    CHECK(contains(client.Get("/metrics")->body, "mneme_plans_total{status=\"solved\"} 3\n"));
  }

  TEST_CASE("a task without a plan is an answer, a wrong one is refused with its stage") {
    auto service = require(Service::start(shipped_robot("panda"), nullptr, loopback()));
    httplib::Client client(service.address());
    client.set_read_timeout(100);
    Json far = task_question();
    far["obstacles"][1]["p"][0] = 2.5;
    const Reply answer = post(client, "/v1/tasks", far);
    CHECK(answer.status == 200);
    CHECK(answer.body["status"] == "invalid_goal");
    CHECK(answer.body["message"] ==
          "stage 'approach' of 20 alternatives: 20 times out of reach (link 'panda_hand')");
    const auto refused = [&](const Json& body, const std::string& expected) {
      const Reply reply = post(client, "/v1/tasks", body);
      CHECK(reply.status == 400);
      const std::string message = reply.body["error"]["message"];
      CHECK_MESSAGE(contains(message, expected), message);
    };
    const Reply elsewhere = post(client, "/v1/plan", task_question());
    const std::string told = elsewhere.body["error"]["message"];
    CHECK_MESSAGE(contains(told, "stages are for POST /v1/tasks"), told);
    Json wrong = task_question();
    wrong["stages"][2] = {{"attach", "cop"}};
    refused(wrong, "expected an obstacle of the scene to attach, got 'cop'; did you mean 'cup'");
    wrong = task_question();
    wrong["goal"] = kHome;
    refused(wrong, "key goal: unknown key");
    wrong = task_question();
    wrong["settings"]["brunches"] = 1;
    refused(wrong, "brunches");
    wrong = task_question();
    wrong["stages"][1]["line"]["to"]["vary"][0]["count"] = 100001;
    refused(wrong, "a whole number from 1 to 100000");
    wrong = task_question();
    wrong["settings"]["timeout"] = 1e5;
    refused(wrong, "the limit of this service");
    wrong = task_question();
    wrong["trajectory"] = {{"dd", 0.1}};
    refused(wrong, "key trajectory.dd: unknown key");
  }

  TEST_CASE("a task that is cancelled ends") {
    ServiceSettings settings;
    settings.threads = 1;
    internal::Endpoints endpoints(shipped_robot("panda"), nullptr, settings, {});
    const std::atomic<bool> is_cancelled = true;
    const std::string body = task_question().dump();
    const internal::Answer answer = endpoints.task({"", body, is_cancelled});
    CHECK(contains(answer.body, "cancelled"));
  }
}

}  // namespace
}  // namespace mneme::test
