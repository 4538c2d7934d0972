// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "service/service_fixture.h"

namespace mneme::test {
namespace {

/// Where the tip of the arm is at the goal of the question, with any rotation.
Json pose_of_goal() {
  const auto problem = load_problem(source_file("scenes/planar/scenario1.yaml"));
  const Vec3 at = problem->robot.link_poses(problem->goals.front()).back().translation;
  return {{"link", "link_8"}, {"position", {at.x(), at.y(), at.z()}}};
}

Json ik_question() {
  Json body = question();
  body["near"] = body["start"];
  for (const char* key : {"start", "goals"}) body.erase(key);
  body["goal"] = pose_of_goal();
  return body;
}

TEST_SUITE("flow") {
  TEST_CASE("inverse kinematics over HTTP finds what it finds in this process") {
    const RunningService running;
    const auto client = running.client();
    Json body = ik_question();
    body["settings"] = {{"seed", 3}, {"ik-solutions", 5}};
    const Reply reply = post(*client, "/v1/ik", body);
    REQUIRE_MESSAGE(reply.status == 200, reply.body.dump());

    const auto problem = load_problem(source_file("scenes/planar/scenario1.yaml"));
    const auto checker = CollisionChecker::make(problem->robot, problem->scene);
    PoseGoal goal;
    goal.link = "link_8";
    goal.pose.translation = problem->robot.link_poses(problem->goals.front()).back().translation;
    goal.cone = goal.turn = kPi;
    auto source = PoseGoalSource::make(*checker, {{goal}}, problem->start,
                                       {.solutions = 5, .seed = 3}, kVerificationMargin);
    const auto expected = source->more();
    REQUIRE(!expected.empty());
    REQUIRE(reply.body["solutions"].size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CHECK(reply.body["solutions"][i]["q"].get<Configuration>() == expected[i]);
      CHECK(reply.body["solutions"][i]["distance"].get<double>() ==
            problem->robot.distance(problem->start, expected[i]));
    }
    CHECK(reply.body["message"].is_null());
  }

  TEST_CASE("poses without a solution are an answer that says why") {
    const RunningService running;
    Json body = ik_question();
    body["goal"]["position"] = {90, 0, 0};
    const Reply reply = post(*running.client(), "/v1/ik", body);
    CHECK(reply.status == 200);
    CHECK(reply.body["solutions"].empty());
    CHECK(reply.body["message"].get<std::string>().find("out of reach") != std::string::npos);
  }

  TEST_CASE("inverse kinematics keeps away from obstacles, its own scene's and uploaded ones") {
    const RunningService running;
    const auto client = running.client();
    Json body = ik_question();
    const Json at = body["goal"]["position"];
    // All of the tip's surroundings.
    const Json blocked = {{at[0], at[1], 0.5}};
    body["circles"] = blocked;
    body.erase("obstacles");
    body["margin"] = 0.01;
    Reply reply = post(*client, "/v1/ik", body);
    CHECK(reply.body["solutions"].empty());
    CHECK(reply.body["message"].get<std::string>().find("only in contact with") !=
          std::string::npos);
    body["allow"] = Json::parse(R"([["link_8", "circle_1"], ["link_7", "circle_1"]])");
    CHECK_FALSE(post(*client, "/v1/ik", body).body["solutions"].empty());

    const Json upload = {{"circles", blocked}};
    CHECK(reply_of(client->Put("/v1/scenes/cell", upload.dump(), "application/json")).status ==
          200);
    for (const char* key : {"circles", "allow"}) body.erase(key);
    body["scene"] = "cell";
    CHECK(post(*client, "/v1/ik", body).body["solutions"].empty());
  }

  TEST_CASE("a plan's goal may be a pose, beside configurations") {
    const RunningService running;
    const auto client = running.client();
    Json body = question();
    body.erase("goals");
    body["goal"] = pose_of_goal();
    Reply reply = post(*client, "/v1/plan", body);
    REQUIRE_MESSAGE(reply.status == 200, reply.body.dump());
    REQUIRE(reply.body["solved"] == true);
    const auto problem = load_problem(source_file("scenes/planar/scenario1.yaml"));
    const auto end = reply.body["path"].get<Path>().back();
    const Vec3 at = problem->robot.link_poses(end).back().translation;
    const auto wanted = pose_of_goal()["position"].get<std::vector<double>>();
    CHECK((at - Vec3(wanted[0], wanted[1], wanted[2])).norm() < 2e-4);

    body.erase("goal");
    body["goals"] = {pose_of_goal(), question()["goals"][0]};
    CHECK(post(*client, "/v1/plan", body).body["solved"] == true);
  }

  TEST_CASE("what a robot carries is a part of the question") {
    const RunningService running;
    const auto client = running.client();
    Json body = {{"configurations", Json::array()}, {"start", std::vector<double>(8, 0.0)}};
    body.erase("configurations");
    body["goal"] = std::vector<double>(8, 0.0);
    body["goal"][0] = 0.5;
    body["circles"] = {{14, 0, 0.2}};
    CHECK(post(*client, "/v1/plan", body).body["solved"] == true);
    body["attached"] = {{{"name", "rod"},
                         {"link", "link_8"},
                         {"type", "sphere"},
                         {"p", {4, 0, 0}},
                         {"radius", 0.5}}};
    const Reply reply = post(*client, "/v1/plan", body);
    CHECK(reply.body["status"] == "invalid_start");
    CHECK(reply.body["message"].get<std::string>().find("rod") != std::string::npos);
    const std::vector<double> triangles = {3, 0, -1, 5, 0,  -1, 4, 1,  1,  3, 0,  -1,
                                           4, 1, 1,  4, -1, 0,  5, 0,  -1, 4, -1, 0,
                                           4, 1, 1,  3, 0,  -1, 4, -1, 0,  5, 0,  -1};
    body["attached"] = {
        {{"name", "rod"}, {"link", "link_8"}, {"type", "mesh"}, {"triangles", triangles}}};
    CHECK(post(*client, "/v1/plan", body).body["status"] == "invalid_start");
  }

  TEST_CASE("several threads for one plan find what one process finds with as many") {
    ServiceSettings two;
    two.threads = 2;
    const RunningService running(two);
    const auto client = running.client();
    Json body = question("threaded_b4");
    body["settings"] = {{"seed", 3}, {"threads", 2}, {"max-iterations", 400000}};
    const Reply reply = post(*client, "/v1/plan", body);
    REQUIRE_MESSAGE(reply.status == 200, reply.body.dump());
    const auto problem = load_problem(source_file("scenes/planar/threaded_b4.yaml"));
    SolveSettings settings;
    settings.sampler = "uniform";
    settings.threads = 2;
    settings.plan.seed = 3;
    settings.plan.max_iterations = 400000;
    CHECK(reply.body["path"].get<Path>() == solve(*problem, nullptr, settings)->plan.path);
  }
}

}  // namespace
}  // namespace mneme::test
