// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// What a service does where there is too much of something, and when memory fails.
#include "service/endpoints.h"
#include "service/service_fixture.h"

#include <sqlite3.h>

namespace mneme::test {
namespace {

void run_sql(const std::string& file, const char* sql) {
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &database) == SQLITE_OK);
  REQUIRE(sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(database);
}

std::shared_ptr<Database> open_paths(const std::string& file) {
  auto opened = Database::open(file, make_space(planar8()), OpenMode::create);
  REQUIRE(opened.has_value());
  return std::make_shared<Database>(*std::move(opened));
}

Json answer_of(const internal::Answer& answer) { return Json::parse(answer.body); }

TEST_SUITE("flow") {
  TEST_CASE("a check has an end, and so has its answer") {
    ServiceSettings settings;
    settings.longest_plan_s = 60;
    std::vector<Configuration> zeros(500, Configuration(8, 0.0));
    Json circles = Json::array();
    for (int i = 0; i < 60; ++i) circles.push_back({4, 0, 3});
    const auto refusal = [](const ServiceSettings& limits, const Json& body) {
      const RunningService running(limits);
      const Reply reply = post(*running.client(), "/v1/check", body);
      CHECK(reply.status == 400);
      return reply.body["error"]["message"].get<std::string>();
    };
    CHECK(refusal(settings, {{"circles", circles}, {"configurations", zeros}}) ==
          "there are more than 100000 contacts: ask for fewer configurations at a time");
    settings.longest_plan_s = 0.001;
    zeros.resize(100000, Configuration(8, 0.0));
    CHECK(refusal(settings, {{"configurations", zeros}}) ==
          "it takes more than 0.001 s: ask for fewer configurations at a time");
  }

  TEST_CASE("memory that cannot be written is told until it can be, to those who may plan") {
    const TemporaryDirectory files;
    const std::string file = files / "m.db";
    const auto database = open_paths(file);
    ServiceSettings settings;
    settings.threads = 1;
    settings.remember_after = 0;
    internal::Endpoints endpoints(planar8(), database, settings);
    Json body = question();
    body["settings"] = {{"kind", "paths"}};
    const auto plan = [&] {
      body["settings"]["seed"] = body["settings"].value("seed", 0) + 1;
      return answer_of(endpoints.plan(body.dump(), -1));
    };
    run_sql(file, "CREATE TRIGGER full BEFORE INSERT ON experience BEGIN "
                  "SELECT RAISE(ABORT, 'no space left'); END");
    CHECK(plan()["remembered"] == 0);
    const Json degraded = answer_of(endpoints.health(true));
    CHECK(degraded["status"] == "degraded");
    CHECK_MESSAGE(degraded["memory"]["failure"].get<std::string>().find("no space left") !=
                      std::string::npos,
                  degraded.dump());
    // That it can be read says nothing of writing.
    endpoints.refresh_memory();
    CHECK(answer_of(endpoints.health(true))["status"] == "degraded");
    CHECK(answer_of(endpoints.health(false))["status"] == "degraded");
    CHECK_FALSE(answer_of(endpoints.health(false))["memory"].contains("failure"));
    run_sql(file, "DROP TRIGGER full");
    CHECK(plan()["remembered"].get<int>() > 0);
    CHECK(answer_of(endpoints.health(true))["status"] == "ok");
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a scene that is removed while it is edited stays removed") {
    internal::SceneStore scenes(2);
    REQUIRE(scenes.put("a", {}).has_value());
    const auto edited = scenes.change("a", [&](const Scene& scene) -> Result<Scene> {
      CHECK(scenes.remove("a"));
      return scene;
    });
    REQUIRE(edited.has_value());
    CHECK(*edited == nullptr);
    CHECK(scenes.count() == 0);
  }
}

}  // namespace
}  // namespace mneme::test
