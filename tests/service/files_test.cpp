// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "service/service_fixture.h"

namespace mneme::test {
namespace {

/// Names of files: of the machine, of this process's directory and of packages.
std::vector<std::string> file_names(const std::string& real) {
  return {real,
          "/etc/passwd",
          "../../../../etc/passwd",
          "..",
          "cloud.ply",
          "package://fetch_description/meshes/torso.stl",
          "package://../../etc/passwd",
          "file:///etc/passwd",
          "file://" + real,
          "FILE:///etc/passwd",
          "http://127.0.0.1/cloud.ply",
          "~/cloud.ply",
          ""};
}

void check_no_file_is_read(const Reply& reply, const std::string& name) {
  INFO(name, ": ", reply.body.dump());
  CHECK(reply.status == 400);
  const std::string message = reply.body["error"]["message"];
  CHECK(contains(message, "no files are read for a request"));
  // Messages do not tell either whether there is such a file: all are the same.
  CHECK(!contains(message, "passwd"));
}

Reply put(httplib::Client& client, const std::string& path, const Json& body) {
  return reply_of(client.Put(path, body.dump(), "application/json"));
}

/// The corners of a square around a point of the plane.
Json points_around(double x, double y) {
  return {x + 0.1, y + 0.1, 0, x - 0.1, y + 0.1, 0, x + 0.1, y - 0.1, 0, x - 0.1, y - 0.1, 0};
}

TEST_SUITE("flow") {
  TEST_CASE("no key of any request has a file read") {
    const TemporaryDirectory files;
    write_file(files / "real.pcd",
               "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
               "POINTS 1\nDATA ascii\n1 2 3\n");
    const RunningService running;
    const auto client = running.client();
    CHECK(put(*client, "/v1/scenes/cell", Json::object()).status == 200);
    for (const std::string& name : file_names(files / "real.pcd")) {
      for (const char* type : {"points", "mesh", "octree"}) {
        const Json shape = {{"name", "a"}, {"type", type}, {"radius", 0.1}, {"file", name}};
        const Json scene = {{"obstacles", {shape}}};
        check_no_file_is_read(put(*client, "/v1/scenes/cell", scene), name);
        check_no_file_is_read(
            reply_of(client->Patch("/v1/scenes/cell", scene.dump(), "application/json")), name);
        Json body = question();
        body["obstacles"] = {shape};
        check_no_file_is_read(post(*client, "/v1/plan", body), name);
        Json check = scene;
        check["configurations"] = {body["start"]};
        check_no_file_is_read(post(*client, "/v1/check", check), name);
        Json ik = scene;
        ik["goal"] = {{"link", "link_8"}, {"position", {1, 0, 0}}};
        check_no_file_is_read(post(*client, "/v1/ik", ik), name);
      }
      for (const bool is_list : {false, true}) {
        Json body = question();
        Json object = {{"name", "cup"}, {"link", "link_8"}};
        const Json mesh = {{"type", "mesh"}, {"file", name}};
        if (is_list) {
          object["shapes"] = {mesh};
        } else {
          object.update(mesh);
        }
        body["attached"] = {object};
        check_no_file_is_read(post(*client, "/v1/plan", body), name);
      }
    }
  }

  TEST_CASE("keys of problem files that name files are no keys of requests") {
    const RunningService running;
    const auto client = running.client();
    for (const char* key : {"srdf", "group", "fixed_joints", "file", "package_path", "db"}) {
      Json body = question();
      body[key] = "/etc/passwd";
      const Reply reply = post(*client, "/v1/plan", body);
      CHECK(reply.status == 400);
      CHECK(reply.body["error"]["message"].get<std::string>().find(key) != std::string::npos);
    }
    Json body = question();
    body["robot"] = "../robots/fetch.urdf";
    CHECK(post(*client, "/v1/plan", body).status == 400);
    body.erase("robot");
    body["allow"] = Json::parse(R"([["link_1", "link_3"]])");
    const Reply reply = post(*client, "/v1/plan", body);
    CHECK(reply.status == 400);
    CHECK(reply.body["error"]["message"].get<std::string>().find("the robot is given") !=
          std::string::npos);
  }

  TEST_CASE("points, triangles and cubes come as numbers, and count") {
    ServiceSettings settings;
    settings.points = 8;
    const RunningService running(settings);
    const auto client = running.client();
    const std::vector<double> stretched(8, 0.0);
    const auto touches = [&](const Json& shape) {
      const Json body = {{"obstacles", {shape}}, {"configurations", {stretched}}};
      const Reply reply = post(*client, "/v1/check", body);
      REQUIRE_MESSAGE(reply.status == 200, reply.body.dump());
      const Json& state = reply.body["states"][0];
      return state["valid"] == false && state["contacts"][0]["other"] == "a";
    };
    Json cloud = {
        {"name", "a"}, {"type", "points"}, {"radius", 0.11}, {"points", points_around(4, 0)}};
    CHECK(touches(cloud));
    cloud["points"] = points_around(4, 1);
    CHECK_FALSE(touches(cloud));
    CHECK(
        touches({{"name", "a"}, {"type", "mesh"}, {"triangles", {4, -1, -1, 4, 1, -1, 4, 0, 1}}}));
    CHECK(touches({{"name", "a"}, {"type", "octree"}, {"cubes", {4, 0, 0, 0.5}}}));

    CHECK(put(*client, "/v1/scenes/cell", {{"obstacles", {cloud}}}).status == 200);
    Json more = cloud;
    more["name"] = "b";
    more["points"].insert(more["points"].end(), {9, 9, 9});
    const Reply reply = reply_of(
        client->Patch("/v1/scenes/cell", Json{{"obstacles", {more}}}.dump(), "application/json"));
    CHECK(reply.status == 400);
    CHECK(reply.body["error"]["message"].get<std::string>().find(
              "expected at most 8 points, triangles and cubes, got 9") != std::string::npos);
    // A newer cloud takes the place of the one of the same name.
    more["name"] = "a";
    CHECK(reply_of(client->Patch("/v1/scenes/cell", Json{{"obstacles", {more}}}.dump(),
                                 "application/json"))
              .status == 200);
  }
}

}  // namespace
}  // namespace mneme::test
