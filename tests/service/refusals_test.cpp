// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "service/raw_client.h"
#include "service/service_fixture.h"

namespace mneme::test {
namespace {

void check_refused(const Reply& reply, int status, const std::string& part) {
  INFO(reply.body.dump());
  CHECK(reply.status == status);
  REQUIRE(reply.body.contains("error"));
  CHECK_MESSAGE(reply.body["error"]["message"].get<std::string>().find(part) != std::string::npos,
                part);
}

Json with(const std::string& key, const Json& value) {
  Json body = question();
  body[key] = value;
  return body;
}

TEST_SUITE("flow") {
  TEST_CASE("what is wrong with a request is said in words") {
    const RunningService running;
    const auto client = running.client();
    const auto refused = [&](const Json& body, const std::string& part) {
      check_refused(post(*client, "/v1/plan", body), 400, part);
    };
    refused(with("robot", "/etc/passwd"), "expected planar8, the robot of this service");
    refused(with("joints", {"a"}), "expected the joints that this service plans for");
    refused(with("scene", "x"), "there is no scene \"x\"");
    refused({{"start", {0}}, {"goal", {0}}, {"scene", "x"}, {"frame", "link_1"}},
            "expected no frame beside scene");
    refused({{"start", {0}}, {"goal", {0}}, {"scene", "../x"}}, "there is no scene");
    refused(with("gaol", 1), "did you mean 'goal'?");
    refused(with("goal", {0}), "expected either goal or goals");
    refused(with("frame", "moon"), "expected a link of robot planar8");
    refused(with("settings", {{"lamda", 1}}), "did you mean 'lambda'?");
    refused(with("settings", {{"lambda", 2}}), "expected a number from 0 to 1");
    refused(with("settings", {{"planner", "RRTConnect"}}), "did you mean 'rrt_connect'?");
    refused(with("settings", {{"timeout", 1e5}}), "timeout and improve of at most 60 s together");
    refused(with("settings", {{"max-nodes", 1e9}}), "expected at most 1000000");
    refused(with("settings", {{"improve", 1e5}}), "timeout and improve of at most 60 s together");
    refused(with("settings", {{"timeout", 40}, {"improve", 21}}), "at most 60 s together");
    refused(with("settings", {{"starts-per-link", 2}}), "unknown key");
    refused(with("settings", {{"threads", 64}}), "threads, the limit of this service");
    refused(with("goal", {{"link", "moon"}, {"position", {1, 0, 0}}}), "expected either goal or");
    refused(with("attached", {{{"name", "a"}, {"link", "moon"}}}), "expected a link of robot");
    const Json ball = {{"type", "sphere"}, {"p", {0.1, 0, 0}}, {"radius", 0.01}};
    const Json balls = {{"name", "a"}, {"link", "link_8"}, {"shapes", Json(257, ball)}};
    refused(with("attached", Json::array({balls})),
            "expected at most 256 shapes, the limit of this service");
    refused(with("settings", {{"remember-after", 1}}), "unknown key");
    refused(with("circles", {{1, 2}}), "x, y, radius");
    refused(with("trace", 1), "key trace");
    refused(Json::array(), "expected a map");
    check_refused(reply_of(client->Post("/v1/plan", "{\n\"start\": [0,\n", "application/json")),
                  400, "request:");
    check_refused(post(*client, "/v1/check", {{"configurations", {"a"}}}), 400,
                  "key configurations");
    const auto ik_refused = [&](Json body, const std::string& part) {
      body["circles"] = question().value("circles", Json::array());
      check_refused(post(*client, "/v1/ik", body), 400, part);
    };
    const Json pose = {{"link", "link_8"}, {"position", {1, 0, 0}}};
    ik_refused({{"near", {0}}}, "8 joints in its group");
    ik_refused(Json::object(), "key goal");
    ik_refused({{"goal", std::vector<double>(8, 0.0)}}, "expected poses of links");
    ik_refused({{"goals", {pose, std::vector<double>(8, 0.0)}}}, "expected poses of links");
    ik_refused({{"goal", {{"link", "moon"}, {"position", {1, 0, 0}}}}}, "expected a link of robot");
    ik_refused({{"goal", pose}, {"near", {0}}}, "near");
    ik_refused({{"goal", pose}, {"margin", -1}}, "0 or more");
    ik_refused({{"goal", pose}, {"settings", {{"lambda", 0.5}}}}, "settings.lambda: unknown key");
    ik_refused({{"goal", pose}, {"settings", {{"seed", -1}}}}, "expected a whole number");
    ik_refused({{"goal", pose}, {"start", {0}}}, "key start");
    check_refused(post(*client, "/v1/check", {{"configurations", Json::array()}, {"margin", -1}}),
                  400, "0 or more");
    // Start and goal that are in contact are an answer, not a refusal.
    const Reply reply = post(*client, "/v1/plan", with("start", {0.0}));
    CHECK(reply.status == 200);
    CHECK(reply.body["status"] == "invalid_start");
  }

  TEST_CASE("there is nothing but what is documented, and no file of the machine") {
    const RunningService running;
    const auto client = running.client();
    for (const char* path :
         {"/v1", "/v1/plans/1/trace", "/v1/scenes/none", "/etc/passwd",
          "/v1/scenes/../../etc/passwd", "/v1/scenes/%2e%2e%2fetc", "//etc/passwd"}) {
      INFO(path);
      CHECK(reply_of(client->Get(path)).status == 404);
    }
    CHECK(reply_of(client->Delete("/v1/plan")).status == 404);
  }

  TEST_CASE("ids of scenes that are none are refused with what ids are") {
    const RunningService running;
    const auto client = running.client();
    const std::string ids = "a scene id has 1 to 64 letters, digits, '_', '.' and '-'";
    for (const std::string& id : {std::string("a%20b"), std::string("a%2Fb"), std::string("%C3%A4"),
                                  std::string(), std::string(65, 'a')}) {
      INFO(id);
      check_refused(reply_of(client->Put("/v1/scenes/" + id, "{}", "application/json")), 400, ids);
      check_refused(reply_of(client->Patch("/v1/scenes/" + id, "{}", "application/json")), 404,
                    ids);
      check_refused(reply_of(client->Delete("/v1/scenes/" + id)), 404, ids);
    }
    CHECK(reply_of(client->Put("/v1/scenes/" + std::string(64, '.'), "{}", "application/json"))
              .status == 200);
  }

  TEST_CASE("bodies and scenes have limits") {
    ServiceSettings settings;
    settings.body_bytes = 20000;
    settings.obstacles = 3;
    settings.scenes = 1;
    const RunningService running(settings);
    const RawClient longwinded(running.port());
    longwinded.say(
        "POST /v1/plan HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        "Content-Length: 30000\r\n\r\n");
    const std::string heard = longwinded.hear();
    CHECK_MESSAGE(heard.starts_with("HTTP/1.1 413"), heard);
    CHECK(contains(heard, "expected a body of at most 20000 bytes"));
    const auto client = running.client();
    Json circles = {{20, 0, 1}, {20, 3, 1}, {20, 6, 1}};
    CHECK(
        reply_of(client->Put("/v1/scenes/a", Json{{"circles", circles}}.dump(), "application/json"))
            .status == 200);
    check_refused(reply_of(client->Put("/v1/scenes/b", "{}", "application/json")), 400,
                  "there are 1 scenes already");
    check_refused(reply_of(client->Patch("/v1/scenes/a", R"({"circles": {"d": [20, 9, 1]}})",
                                         "application/json")),
                  400, "expected at most 3 obstacles, got 4");
    circles.push_back({20, 9, 1});
    check_refused(
        post(*client, "/v1/check", {{"circles", circles}, {"configurations", Json::array()}}), 400,
        "expected at most 3 obstacles, got 4");
  }

  TEST_CASE("only JSON is taken, so that no page of another origin can send it unasked") {
    const RunningService running;
    for (const char* type : {"text/plain", "application/x-www-form-urlencoded"}) {
      check_refused(reply_of(running.client()->Post("/v1/plan", question().dump(), type)), 415,
                    "application/json");
    }
    check_refused(reply_of(running.client()->Post("/v1/plan", {{"Content-Encoding", "gzip"}}, "x",
                                                  "application/json")),
                  415, "uncompressed");
  }

  TEST_CASE("with a token only those who know it are answered, but for the health") {
    ServiceSettings settings;
    settings.token = "secret";
    const RunningService running(settings);
    const auto get = [&](const std::string& value) {
      const httplib::Headers headers = {{"Authorization", value}};
      return running.client()->Get("/metrics", headers)->status;
    };
    for (const char* wrong : {"", "secret", "Bearer", "Bearer secre", "Bearer secret2"}) {
      CHECK_MESSAGE(get(wrong) == 401, wrong);
    }
    CHECK(get("Bearer secret") == 200);
    CHECK(reply_of(running.client()->Get("/healthz")).body["status"] == "ok");
  }

  TEST_CASE("addresses that cannot be listened at are refused") {
    const auto failure = [](const std::string& where, const std::string& token = "") {
      ServiceSettings settings;
      settings.listen = where;
      settings.token = token;
      const auto started = Service::start(planar8(), nullptr, settings);
      return started ? "" : started.error().message;
    };
    for (const char* where : {"", "7890", "localhost", "127.0.0.1:", "127.0.0.1:x", "h:123456"}) {
      CHECK_MESSAGE(contains(failure(where), "expected HOST:PORT"), where);
    }
    CHECK(contains(failure("0.0.0.0:0"), "other machines reach"));
    CHECK(failure("0.0.0.0:0", "secret").empty());
    CHECK(contains(failure("unix:"), "expected unix:PATH"));
    CHECK(contains(failure("unix:/no/such/folder/socket"), "cannot listen"));
    const TemporaryDirectory files;
    write_file(files / "kept", "text");
    CHECK(contains(failure("unix:" + files / "kept"), "not a socket"));
    CHECK(read_file(files / "kept") == "text");

    const RunningService running;
    CHECK(contains(failure(fmt::format("127.0.0.1:{}", running.port())), "cannot listen"));
    ServiceSettings settings;
    settings.remember_after = 1;
    CHECK_FALSE(Service::start(planar8(), nullptr, settings).has_value());
  }
}

}  // namespace
}  // namespace mneme::test
