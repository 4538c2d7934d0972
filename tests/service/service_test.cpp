// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "robot/kinematics.h"
#include "service/service_fixture.h"

#include <atomic>
#include <thread>
#include <vector>

namespace mneme::test {
namespace {

/// The trace that a page holds.
Json trace_in(const std::string& page) {
  const std::string opening = "id=\"trace\">";
  const std::size_t begin = page.find(opening) + opening.size();
  return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

TEST_SUITE("flow") {
  TEST_CASE("a plan over HTTP is the plan of the same problem in this process") {
    const RunningService running;
    const auto client = running.client();
    Json body = question();
    body["settings"] = {{"seed", 7}, {"max-iterations", 100000}};
    const Reply reply = post(*client, "/v1/plan", body);
    REQUIRE_MESSAGE(reply.status == 200, reply.body.dump());

    const auto problem = load_problem(source_file("scenes/planar/scenario1.yaml"));
    SolveSettings settings;
    settings.sampler = "uniform";
    settings.plan.seed = 7;
    settings.plan.max_iterations = 100000;
    const auto result = solve(*problem, nullptr, settings);
    CHECK(reply.body["path"].get<Path>() == result->plan.path);
    Json keys = Json::parse(to_json(*problem, *result, 0));
    for (const auto& item : keys.items()) {
      CHECK_MESSAGE(reply.body.contains(item.key()), item.key());
    }
    CHECK(reply.body.size() == keys.size());
  }

  TEST_CASE("a plan with a trajectory is timed, with velocities at its ends") {
    const RunningService running;
    const auto client = running.client();
    Json body = question();
    CHECK_FALSE(post(*client, "/v1/plan", body).body.contains("trajectory"));
    const Json timed = post(*client, "/v1/plan?trajectory=true&dt=0.05", body).body;
    REQUIRE_MESSAGE(timed.contains("trajectory"), timed.dump());
    CHECK(timed["trajectory"]["times"][1].get<double>() == doctest::Approx(0.05));
    CHECK(timed["trajectory"]["duration_s"] == timed["duration_s"]);
    CHECK(timed["trajectory"]["positions"][0].size() == 8);
    CHECK(timed["motion"]["velocity_use"].size() == 8);

    body["trajectory"] = {{"dt", 0.05}, {"acceleration-limit", 4}};
    const Json faster = post(*client, "/v1/plan", body).body;
    CHECK(faster["duration_s"].get<double>() < timed["duration_s"].get<double>());
    body["start_velocity"] = std::vector<double>{-0.1, 0, 0, 0, 0, 0, 0, 0};
    const Json moving = post(*client, "/v1/plan", body).body;
    REQUIRE_MESSAGE(moving.contains("trajectory"), moving.dump());
    CHECK(moving["trajectory"]["velocities"][0][0].get<double>() == doctest::Approx(-0.1));
    body["end_velocity"] = std::vector<double>{0, 0.1, 0, 0, 0, 0, 0, 0};
    const Json ending = post(*client, "/v1/plan", body).body;
    REQUIRE_MESSAGE(ending.contains("trajectory"), ending.dump());
    CHECK(ending["trajectory"]["velocities"].back()[1].get<double>() == doctest::Approx(0.1));

    body["trajectory"] = {{"dt", 0}};
    CHECK(post(*client, "/v1/plan", body).status == 400);
    body["trajectory"] = false;
    CHECK_FALSE(post(*client, "/v1/plan", body).body.contains("trajectory"));
  }

  TEST_CASE("parameters of a URL are decoded, and refused with name and expectation") {
    const RunningService running;
    const auto client = running.client();
    const Json body = question();
    const auto fails = [&](const std::string& query, const std::string& expected) {
      CAPTURE(query);
      const auto reply = post(*client, "/v1/plan?" + query, body);
      CHECK(reply.status == 400);
      const std::string text = reply.body.dump();
      CHECK_MESSAGE(contains(text, expected), text);
    };
    fails("trajectory=maybe", "query of the URL: key trajectory: expected true or false, got");
    fails("trajectory=1", "key trajectory: expected true or false");
    fails("trajectory", "key trajectory: expected true or false");
    fails("foo=1", "foo");
    fails("dt=0.1", "key dt: no trajectory is wanted; add trajectory=true");
    fails("trajectory=false&dt=0.1", "add trajectory=true");
    fails("trajectory=true&dt=abc", "key dt: expected a number, got");
    fails("trajectory=true&dt=nan", "key dt: expected a number");
    fails("trajectory=true&dt=0", "key dt: expected a number from");
    fails("trajectory=true&dt=0.5,%22velocity-scale%22:0.1", "key dt: expected a number");
    fails("trajectory=true&trajectory=false", "key trajectory: expected the key once");
    const Json timed = post(*client, "/v1/plan?traj%65ctory=true&dt=0%2E05", body).body;
    REQUIRE_MESSAGE(timed.contains("trajectory"), timed.dump());
    CHECK(timed["trajectory"]["times"][1].get<double>() == doctest::Approx(0.05));
    CHECK(post(*client, "/v1/plan?", body).status == 200);
  }

  TEST_CASE("a scene that was uploaded is planned in, edited and removed") {
    const RunningService running;
    const auto client = running.client();
    const Json body = question();
    Json upload = body;
    for (const char* key : {"start", "goals"}) upload.erase(key);
    const Reply put = reply_of(client->Put("/v1/scenes/cell", upload.dump(), "application/json"));
    REQUIRE_MESSAGE(put.status == 200, put.body.dump());
    const std::size_t count = put.body["obstacles"].size();
    CHECK(count > 0);

    const Json inside = {
        {"start", body.at("start")}, {"goals", body.at("goals")}, {"scene", "cell"}};
    const Json path = post(*client, "/v1/plan", inside).body["path"];
    CHECK(path == post(*client, "/v1/plan", body).body["path"]);

    const Json edit = {
        {"remove", {put.body["obstacles"][0]}},
        {"obstacles", {{{"name", "new"}, {"type", "sphere"}, {"p", {20, 0, 0}}, {"radius", 0.1}}}}};
    const Reply patched =
        reply_of(client->Patch("/v1/scenes/cell", edit.dump(), "application/json"));
    REQUIRE_MESSAGE(patched.status == 200, patched.body.dump());
    CHECK(patched.body["obstacles"].size() == count);
    CHECK(patched.body["obstacles"].back() == "new");
    CHECK(reply_of(client->Get("/v1/scenes/cell")).body == patched.body);

    const auto cloud_of = [](std::vector<double> points) {
      return Json{{"obstacles",
                   {{{"name", "new"},
                     {"type", "points"},
                     {"radius", 0.1},
                     {"points", std::move(points)}}}}};
    };
    for (const std::size_t points : {3, 0}) {
      const Json scan = cloud_of(std::vector<double>(points, 20));
      const Reply seen =
          reply_of(client->Patch("/v1/scenes/cell", scan.dump(), "application/json"));
      CHECK_MESSAGE(seen.body["obstacles"].size() == count - (points == 0 ? 1 : 0),
                    seen.body.dump());
    }

    CHECK(reply_of(client->Delete("/v1/scenes/cell")).status == 200);
    CHECK(reply_of(client->Delete("/v1/scenes/cell")).status == 404);
    CHECK(post(*client, "/v1/plan", inside).status == 400);
  }

  TEST_CASE("configurations are checked, and contacts named") {
    const RunningService running;
    const auto client = running.client();
    Json body = {
        {"circles", {{4, 0, 0.5}}},
        {"configurations",
         {std::vector<double>(8, 0.0), {1.5, 0, 0, 0, 0, 0, 0, 0}, {0, 9, 0, 0, 0, 0, 0, 0}}}};
    const Reply reply = post(*client, "/v1/check", body);
    REQUIRE_MESSAGE(reply.status == 200, reply.body.dump());
    const Json& states = reply.body["states"];
    REQUIRE(states.size() == 3);
    CHECK(states[0]["valid"] == false);
    CHECK(states[0]["contacts"][0]["other"] == "circle_1");
    CHECK(states[1]["valid"] == true);
    CHECK(states[2]["valid"] == false);
    CHECK(states[2].contains("message"));
  }

  TEST_CASE("attached objects are checked as those of plans") {
    const RunningService running;
    const auto client = running.client();
    const std::vector<double> straight(8, 0.0);
    Json body = {{"circles", {{14, 0, 0.2}}}, {"configurations", Json::array({straight})}};
    CHECK(post(*client, "/v1/check", body).body["states"][0]["valid"] == true);
    body["attached"] = {{{"name", "rod"},
                         {"link", "link_8"},
                         {"type", "sphere"},
                         {"p", {4, 0, 0}},
                         {"radius", 0.5}}};
    const Reply reply = post(*client, "/v1/check", body);
    REQUIRE_MESSAGE(reply.status == 200, reply.body.dump());
    const Json& state = reply.body["states"][0];
    CHECK(state["valid"] == false);
    CHECK(state["contacts"][0]["link"] == "rod");
    body["allow"] = Json::array({Json::array({"rod", "circle_1"})});
    CHECK(post(*client, "/v1/check", body).body["states"][0]["valid"] == true);
  }

  TEST_CASE("a trace is kept for whoever asks for one") {
    ServiceSettings settings;
    settings.traces = 1;
    const RunningService running(settings);
    const auto client = running.client();
    Json body = question();
    CHECK_FALSE(post(*client, "/v1/plan", body).body.contains("id"));
    body["trace"] = true;
    body["clearance"] = true;
    const Reply plan = post(*client, "/v1/plan", body);
    CHECK(plan.body.contains("least_clearance"));
    const std::string path = "/v1/plans/" + plan.body["id"].get<std::string>() + "/trace";
    CHECK(reply_of(client->Get(path)).body["format"] == "mneme-trace");
    for (const char* id : {"1abc", "01x", "-1", "1.0", "99999999999999999999999"}) {
      const auto other = fmt::format("/v1/plans/{}/trace", id);
      CHECK_MESSAGE(reply_of(client->Get(other)).status == 404, id);
    }
    post(*client, "/v1/plan", body);
    CHECK(reply_of(client->Get(path)).status == 404);
  }

  TEST_CASE("The page begins with the problem that it is given, or with the robot at rest") {
    const auto page_of = [](const ServiceSettings& settings) {
      const test::RunningService running(settings);
      const auto answer = running.client()->Get("/", {{"Accept-Encoding", "gzip, deflate, br"}});
      CHECK(answer->status == 200);
      CHECK_FALSE(answer->has_header("Content-Encoding"));
      CHECK(answer->get_header_value("Content-Type") == "text/html; charset=utf-8");
      return trace_in(answer->body);
    };
    const test::Json rest = page_of({});
    CHECK(rest["obstacles"].empty());
    CHECK(rest["live"]["start"] == std::vector<double>(8, 0.0));
    CHECK_FALSE(rest["live"]["has_memory"]);
    REQUIRE(rest["live"]["tips"].size() == 1);
    CHECK(rest["live"]["tips"][0]["link"] == "link_8");
    CHECK(rest["live"]["tips"][0]["carries"][0]["link"] == 7);

    ServiceSettings settings;
    settings.shown = std::make_shared<const Problem>(
        *load_problem(test::source_file("scenes/planar/scenario1.yaml")));
    const test::Json shown = page_of(settings);
    CHECK(shown["problem"] == settings.shown->name);
    CHECK(shown["obstacles"].size() == settings.shown->scene.obstacles.size());
    CHECK(shown["live"]["start"] == settings.shown->start);
    CHECK(shown["goals"].size() == settings.shown->goals.size());
  }

  TEST_CASE("A robot rests in the middle of its limits, from where its hand reaches to all sides") {
    const auto panda = require(load_robot(test::source_file("robots/panda.urdf")));
    const auto service = require(Service::start(panda, nullptr, test::loopback()));
    httplib::Client client(service.address());
    const test::Json start = trace_in(client.Get("/")->body)["live"]["start"];
    for (int i = 0; i < panda.joint_count(); ++i) {
      const Joint& joint = panda.group_joint(i);
      CHECK(start[static_cast<std::size_t>(i)].get<double>() ==
            doctest::Approx((joint.lower + joint.upper) / 2));
    }
  }

  TEST_CASE("What a page's requests cannot hold the service keeps as a scene beside them") {
    ServiceSettings settings = test::loopback();
    Problem problem = *load_problem(test::source_file("scenes/planar/scenario1.yaml"));
    auto points = std::make_shared<Parts<CloudPoint>>(std::vector<CloudPoint>{{20, 0, 0}});
    problem.scene.obstacles.insert(problem.scene.obstacles.begin(),
                                   {"scan", {PointCloud{{}, points, 0.1}}});
    problem.scene.obstacles.back().may_touch = {"link_1"};
    settings.shown = std::make_shared<const Problem>(problem);
    const auto service = require(Service::start(problem.robot, nullptr, settings));
    httplib::Client client(service.address());
    const test::Json shown = trace_in(client.Get("/")->body);
    CHECK(shown["obstacles"].back()["name"] == "scan");
    CHECK(shown["live"]["scene"] == "page");
    const Json allowed =
        Json::array({Json::array({"link_1", problem.scene.obstacles.back().name})});
    CHECK(shown["live"]["allow"] == allowed);
    CHECK(reply_of(client.Get("/v1/scenes/page")).body["obstacles"] == Json({"scan"}));

    settings.scenes = 0;
    CHECK_FALSE(Service::start(problem.robot, nullptr, settings).has_value());
  }

  TEST_CASE("a request that says nothing of obstacles is in the scene of the service's problem") {
    ServiceSettings settings;
    settings.shown = std::make_shared<const Problem>(
        *load_problem(test::source_file("scenes/planar/scenario1.yaml")));
    const RunningService running(settings);
    const auto client = running.client();
    const Json body = question();
    const Json ends = {{"start", body.at("start")}, {"goals", body.at("goals")}};
    const Json path = post(*client, "/v1/plan", ends).body["path"];
    CHECK(path == post(*client, "/v1/plan", body).body["path"]);
    Json nowhere = ends;
    nowhere["obstacles"] = Json::array();
    CHECK(post(*client, "/v1/plan", nowhere).body["path"].size() == 2);
    CHECK(path.size() > 2);
    const Json check = {{"configurations", body.at("goals")}};
    CHECK(post(*client, "/v1/check", check).status == 200);
    Json framed = ends;
    framed["frame"] = "base";
    const Reply refusal = post(*client, "/v1/plan", framed);
    CHECK(refusal.status == 400);
    const std::string message = refusal.body["error"]["message"];
    CHECK_MESSAGE(contains(message, "the scene of the service's problem"), message);
    CHECK_MESSAGE(contains(message, "give obstacles, [] for none"), message);
    framed["obstacles"] = Json::array();
    CHECK(post(*client, "/v1/plan", framed).status == 200);
  }

  TEST_CASE("obstacles beside a scene are added to it, in the place of those of the same names") {
    const RunningService running;
    const auto client = running.client();
    const auto ball = [](const std::string& name, double x, double radius) {
      return Json{{"name", name}, {"type", "sphere"}, {"p", {x, 0, 0}}, {"radius", radius}};
    };
    const Json upload = {{"obstacles", Json::array({ball("a", 4, 0.5)})}};
    CHECK(reply_of(client->Put("/v1/scenes/cell", upload.dump(), "application/json")).status ==
          200);
    Json body = {{"scene", "cell"}, {"configurations", Json::array({std::vector<double>(8, 0.0)})}};
    const auto is_free = [&] {
      return post(*client, "/v1/check", body).body["states"][0]["valid"];
    };
    CHECK(is_free() == false);
    body["obstacles"] = Json::array({ball("a", 40, 0.5)});
    CHECK(is_free() == true);
    body["obstacles"] = Json::array({ball("b", 4, 0.5), ball("a", 40, 0.5)});
    CHECK(is_free() == false);
    body["obstacles"] = {
        {{"name", "a"}, {"type", "points"}, {"radius", 0.1}, {"points", Json::array()}}};
    CHECK(is_free() == true);
  }

  TEST_CASE("plans that were hard are remembered, and metrics count them") {
    const TemporaryDirectory files;
    auto opened =
        require(Database::open(files / "m.db", make_signature(planar8()), OpenMode::create));
    const auto database = std::make_shared<Database>(std::move(opened));
    ServiceSettings settings;
    settings.remember_after = 0;
    const RunningService running(settings, database);
    const auto client = running.client();
    Json body = question();
    body["settings"] = {{"kind", "paths"}};
    const Reply reply = post(*client, "/v1/plan", body);
    CHECK(reply.body["remembered"] == "queued");
    REQUIRE(database->flush());
    CHECK(database->size() == 1);
    CHECK(reply_of(client->Get("/healthz")).body["memory"]["rows"] == database->size());
    body["remember"] = false;
    CHECK(post(*client, "/v1/plan", body).body["remembered"] == 0);

    const std::string text = client->Get("/metrics")->body;
    for (const std::string& line :
         {std::string("mneme_requests_total{path=\"/v1/plan\",status=\"200\"} 2"),
          std::string("mneme_plans_total{status=\"solved\"} 2"),
          fmt::format("mneme_memory_rows {}", database->size()),
          std::string("mneme_request_seconds_count{path=\"/v1/plan\"} 2"),
          std::string("mneme_request_seconds{path=\"/v1/plan\",quantile=\"0.99\"}")}) {
      CHECK_MESSAGE(contains(text, line), text);
    }
  }

  TEST_CASE("a known task is replayed, and a miss says which one was near and what blocked it") {
    const TemporaryDirectory files;
    auto opened =
        require(Database::open(files / "m.db", make_signature(planar8()), OpenMode::create));
    ServiceSettings settings;
    settings.remember_after = 0;
    const auto database = std::make_shared<Database>(std::move(opened));
    const RunningService running(settings, database);
    const auto client = running.client();
    Json body = question();
    body["settings"] = {{"kind", "paths"}, {"replay", 0.5}};
    const auto ask = [&] { return post(*client, "/v1/plan", body).body; };
    CHECK(ask()["replay"]["explanation"] == "not replayed: no task is known");
    REQUIRE(database->flush());
    body["remember"] = false;
    const Json again = ask();
    CHECK(again["replayed"] == true);
    CHECK(again["replay"]["row"] == 1);

    const Path path = again["path"];
    const Robot robot = planar8();
    Path longest(2, path.front());
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (robot.distance(path[i - 1], path[i]) > robot.distance(longest[0], longest[1])) {
        longest = {path[i - 1], path[i]};
      }
    }
    const Configuration middle = internal::interpolate(robot, longest[0], longest[1], 0.5);
    const Vec3 tip = robot.link_poses(middle).back().translation;
    body["obstacles"].push_back({{"name", "in_the_way"},
                                 {"type", "sphere"},
                                 {"p", {tip.x(), tip.y(), 0}},
                                 {"radius", 0.05}});
    const Json blocked = ask()["replay"]["blocked"][0];
    CHECK(blocked["row"] == 1);
    CHECK(blocked["obstacle"] == "in_the_way");
    CHECK(blocked["fraction"] > 0);
    CHECK(blocked["fraction"] < 1);

    body = question();
    body["settings"] = {{"kind", "paths"}, {"replay", 0.5}};
    body["goals"] = {body["start"]};
    body["goals"][0][7] = body["start"][7].get<double>() + 0.1;
    const Json far = ask();
    CHECK(far["replayed"] == false);
    CHECK(far["replay"]["nearest"] > 0.5);
  }

  TEST_CASE("many clients at once get the answers that each would get alone") {
    const RunningService running;
    std::vector<Json> expected;
    for (int seed = 0; seed < 4; ++seed) {
      Json body = question();
      body["settings"] = {{"seed", seed}, {"max-iterations", 100000}};
      expected.push_back(post(*running.client(), "/v1/plan", body).body["path"]);
    }
    std::atomic<int> wrong = 0;
    std::vector<std::thread> clients;
    for (int i = 0; i < 8; ++i) {
      clients.emplace_back([&, i, body = question()]() mutable {
        const auto client = running.client();
        for (int k = 0; k < 10; ++k) {
          const int seed = (i + k) % 4;
          body["settings"] = {{"seed", seed}, {"max-iterations", 100000}};
          const auto reply = client->Post("/v1/plan", body.dump(), "application/json");
          const bool is_right =
              reply && reply->status == 200 &&
              Json::parse(reply->body)["path"] == expected[static_cast<std::size_t>(seed)];
          wrong += is_right ? 0 : 1;
        }
      });
    }
    for (std::thread& client : clients) client.join();
    CHECK(wrong == 0);
  }
}

}  // namespace
}  // namespace mneme::test
