// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/client.h"

#include "client/request_body.h"
#include "service/service_fixture.h"

#include <algorithm>
#include <cstdlib>

namespace mneme::test {
namespace {

Problem scenario() {
  auto problem = load_problem(source_file("scenes/planar/scenario1.yaml"));
  REQUIRE(problem.has_value());
  return *std::move(problem);
}

Client client_of(const std::string& address, const std::string& token = "") {
  ClientSettings settings;
  settings.address = address;
  settings.token = token;
  settings.patience_s = 0;
  auto client = Client::make(settings);
  REQUIRE_MESSAGE(client.has_value(), (client ? "" : client.error().message));
  return *std::move(client);
}

SolveSettings seeded(std::uint64_t seed) {
  SolveSettings settings;
  settings.plan.seed = seed;
  settings.plan.max_iterations = 100000;
  return settings;
}

Path plan_here(const Problem& problem, SolveSettings settings) {
  settings.sampler = "uniform";
  const auto result = solve(problem, nullptr, settings);
  REQUIRE(result.has_value());
  return result->plan.path;
}

/// The message of what must be refused.
template <class T>
std::string refused(const Result<T>& result, ErrorCode code) {
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().code == code);
  return result.error().message;
}

bool has(const std::string& text, const std::string& part) {
  INFO(text);
  return text.find(part) != std::string::npos;
}

TEST_SUITE("flow") {
  TEST_CASE("a plan by a client is the plan of this process, over TCP and over a socket file") {
    const TemporaryDirectory files;
    ServiceSettings at_file;
    at_file.listen = "unix:" + files / "socket";
    const RunningService tcp;
    const auto file = Service::start(planar8(), nullptr, at_file);
    REQUIRE(file.has_value());
    const Problem problem = scenario();
    for (const std::string& address : {tcp.service.address(), file->address()}) {
      Client client = client_of(address);
      // Neither of the last two is exact as a double, or below 2^63.
      for (const std::uint64_t seed : {1UL, 2UL, 9007199254740993UL, 18446744073709551615UL}) {
        const auto plan = client.plan(problem, seeded(seed));
        REQUIRE_MESSAGE(plan.has_value(), (plan ? "" : plan.error().message));
        CHECK(plan->is_solved());
        CHECK(plan->message.empty());
        CHECK(plan->path == plan_here(problem, seeded(seed)));
        CHECK(plan->path_length == doctest::Approx(path_length(problem.robot, plan->path)));
        CHECK(plan->total_time_s > 0);
        CHECK(has(plan->json, "\"isa\""));
      }
    }
  }

  TEST_CASE("problems with poses, attached objects and points arrive whole") {
    const RunningService running;
    Client client = client_of(running.service.address());
    Problem problem = scenario();
    const Transform tip = problem.robot.link_poses(problem.goals.front()).back();
    PoseGoal goal;
    goal.link = "link_8";
    goal.pose = tip;
    goal.position_tolerance = Vec3(0.2, 0.1, 0);
    goal.axis = Axis::x;
    goal.cone = 0.4;
    goal.turn = kPi;
    problem.pose_goals = {goal};
    problem.goals.clear();
    const auto robot = attach(problem.robot, {{"rod", "link_8", {Sphere{{0.3, 0, 0}, 0.05}}}});
    REQUIRE(robot.has_value());
    problem.robot = *robot;
    const std::vector<CloudPoint> points = {{20, 0, 0}, {20, 1, 0}};
    problem.scene.obstacles.push_back(
        {"cloud", {PointCloud{{}, std::make_shared<Parts<CloudPoint>>(points), 0.1}}, {"rod"}});
    const auto plan = client.plan(problem, seeded(2));
    REQUIRE_MESSAGE(plan.has_value(), (plan ? "" : plan.error().message));
    // The file has the same digits as the request.
    const TemporaryDirectory files;
    write_file(files / "p.json", to_compact_json(problem, source_file("robots/planar8.urdf")));
    const auto read = load_problem(files / "p.json" + "#scenario1");
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    CHECK(read->robot.attached().size() == 1);
    CHECK(read->pose_goals.size() == 1);
    CHECK(plan->path == plan_here(*read, seeded(2)));
  }

  TEST_CASE("scenes stay with the service until they are deleted") {
    const RunningService running;
    Client client = client_of(running.service.address());
    const Problem problem = scenario();
    REQUIRE(client.put_scene("cell", problem.scene).has_value());
    const auto plan = client.plan(problem, "cell", seeded(1));
    REQUIRE(plan.has_value());
    CHECK(plan->path == plan_here(problem, seeded(1)));
    CHECK(has(client.ask("GET", "/v1/scenes/cell", "").value(), problem.scene.obstacles[0].name));
    REQUIRE(client.delete_scene("cell").has_value());
    CHECK(has(refused(client.plan(problem, "cell"), ErrorCode::invalid), "there is no scene"));
    CHECK(has(refused(client.delete_scene("cell"), ErrorCode::invalid), "there is no scene"));
  }

  TEST_CASE("inverse kinematics by a client is that of this process") {
    const RunningService running;
    Client client = client_of(running.service.address());
    const Problem problem = scenario();
    PoseGoal goal;
    goal.link = "link_8";
    goal.pose.translation = {9, 3, 0};
    goal.cone = goal.turn = kPi;
    IkSettings settings;
    settings.solutions = 3;
    settings.seed = 9;
    const auto found = client.inverse_kinematics({{goal}}, problem.start, problem.scene, settings);
    REQUIRE_MESSAGE(found.has_value(), (found ? "" : found.error().message));
    const auto checker = CollisionChecker::make(problem.robot, problem.scene);
    auto source =
        PoseGoalSource::make(*checker, {{goal}}, problem.start, settings, kVerificationMargin);
    CHECK(*found == source->more());
    goal.pose.translation.x() = 90;
    CHECK(client.inverse_kinematics({{goal}}, problem.start)->empty());
  }

  TEST_CASE("what a service refuses is told in its words, and what is no service too") {
    ServiceSettings settings;
    settings.token = "secret";
    const RunningService running(settings);
    const Problem problem = scenario();
    Client stranger = client_of(running.service.address());
    CHECK(has(refused(stranger.plan(problem), ErrorCode::invalid), "Authorization"));
    Client client = client_of(running.service.address(), "secret");
    SolveSettings wrong;
    wrong.planner = "RRTConnect";
    CHECK(has(refused(client.plan(problem, wrong), ErrorCode::invalid), "rrt_connect"));
    wrong = {};
    wrong.plan.timeout_s = 1e5;
    CHECK(has(refused(client.plan(problem, wrong), ErrorCode::invalid), "at most 60 together"));
    const auto none = client.plan(problem, [] {
      SolveSettings hopeless;
      hopeless.plan.max_iterations = 1;
      return hopeless;
    }());
    REQUIRE(none.has_value());
    CHECK(none->status == PlanStatus::iteration_limit);
    CHECK_FALSE(none->message.empty());
    CHECK(none->path.empty());
    const Robot other =
        *load_approximated_robot(*find_robot("ur5")).map([](const ApproximatedRobot& loaded) {
          return loaded.robot;
        });
    const Configuration zero(6, 0.0);
    CHECK(has(refused(client.plan({"", other, "", {}, zero, {zero}, {}}), ErrorCode::invalid),
              "expected the joints"));
    Client lost = client_of("http://127.0.0.1:1");
    CHECK(has(refused(lost.plan(problem), ErrorCode::io),
              "no answer: cannot connect; is `mneme serve` running there?"));
  }

  TEST_CASE("a busy service is waited for as long as the client likes") {
    ServiceSettings settings;
    settings.connections = 1;
    const RunningService running(settings);
    Client first = client_of(running.service.address());
    CHECK(first.ask("GET", "/healthz", "").has_value());
    Client second = client_of(running.service.address());
    CHECK(has(refused(second.ask("GET", "/healthz", ""), ErrorCode::io), "too many connections"));
  }

  TEST_CASE("the example plans three times in a scene that it uploads") {
    const RunningService running;
    const TemporaryDirectory files;
    const std::string problem = source_file("scenes/planar/scenario1.yaml");
    const std::string command = "'" MNEME_EXAMPLE "' " + running.service.address() + " '" +
                                problem + "' > '" + files / "out" + "'";
    REQUIRE(std::system(command.c_str()) == 0);
    const std::string text = read_file(files / "out");
    CHECK(std::ranges::count(text, '\n') == 3);
    CHECK(has(text, "configurations"));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("addresses of another form are refused") {
    for (const char* address :
         {"", "127.0.0.1:7890", "https://a:1", "http://a", "http://:1", "http://a:", "http://a:0",
          "http://a:65536", "http://a:1x", "unix:", "ftp://a:1", "http://[]:1"}) {
      ClientSettings settings;
      settings.address = address;
      CHECK_MESSAGE(has(refused(Client::make(settings), ErrorCode::invalid), "expected http://"),
                    address);
    }
    ClientSettings settings;
    settings.address = "http://[::1]:7890";
    CHECK(Client::make(settings).has_value());
  }

  TEST_CASE("settings travel that differ from the defaults, by their names") {
    const Problem problem = scenario();
    CHECK(internal::plan_body(problem, "", {})["settings"].empty());
    SolveSettings settings;
    settings.planner = "prm";
    settings.memory.kind = "paths";
    settings.lambda = 0.25;
    settings.threads = 2;
    settings.plan.simplify = false;
    settings.plan.max_iterations = 7;
    settings.ik.solutions = 3;
    CHECK(internal::plan_body(problem, "", settings)["settings"] == Json{{"planner", "prm"},
                                                                         {"kind", "paths"},
                                                                         {"lambda", 0.25},
                                                                         {"threads", 2},
                                                                         {"simplify", false},
                                                                         {"max-iterations", 7},
                                                                         {"ik-solutions", 3}});
    const Json body = internal::plan_body(problem, "cell", {});
    CHECK(body["scene"] == "cell");
    CHECK_FALSE(body.contains("obstacles"));
  }
}

}  // namespace
}  // namespace mneme::test
