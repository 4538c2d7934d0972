// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The service beyond its limits, and without memory.
#include "service/endpoints.h"
#include "service/service_fixture.h"

#include <atomic>
#include <csignal>
#include <sys/resource.h>

namespace mneme::test {
namespace {

/// As long as it lives, no file of this process can be written.
class FullDisk {
 public:
  FullDisk() : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before_) == 0);
    const rlimit none{0, before_.rlim_max};
    REQUIRE(setrlimit(RLIMIT_FSIZE, &none) == 0);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

std::shared_ptr<Database> open_paths(const std::string& file) {
  auto opened = require(Database::open(file, make_signature(planar8()), OpenMode::create));
  return std::make_shared<Database>(std::move(opened));
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
          "there are more than 100000 contacts: send fewer configurations per request");
    settings.longest_plan_s = 0.001;
    zeros.resize(100000, Configuration(8, 0.0));
    CHECK(refusal(settings, {{"configurations", zeros}}) ==
          "the request takes more than 0.001 s, the limit of this service (--longest-plan)");
  }

  TEST_CASE("reading a scene has an end, too, and is not begun for a client that is gone") {
    ServiceSettings settings;
    settings.threads = 1;
    settings.longest_plan_s = 0.001;
    internal::Endpoints endpoints(planar8(), nullptr, settings, {});
    const Json cloud = {{"name", "a"},
                        {"type", "points"},
                        {"radius", 0.01},
                        {"points", std::vector<double>(300000, 0.5)}};
    const std::string body = Json{{"obstacles", {cloud}}}.dump();
    const std::atomic<bool> never = false, gone = true;
    const internal::Answer late = endpoints.put_scene({"a", body, never});
    CHECK(late.status == 400);
    CHECK_MESSAGE(contains(late.body, "takes more than 0.001 s"), late.body);
    const internal::Answer cancelled = endpoints.put_scene({"a", body, gone});
    CHECK(cancelled.status == 503);
    CHECK(answer_of(cancelled)["error"]["code"] == "cancelled");
  }

  TEST_CASE("inverse kinematics has an end, too") {
    ServiceSettings settings;
    settings.longest_plan_s = 0.001;
    const RunningService running(settings);
    const Json body = {{"goal", {{"link", "link_8"}, {"position", {90, 0, 0}}}},
                       {"settings", {{"ik-seeds", 100000000}}}};
    const Reply reply = post(*running.client(), "/v1/ik", body);
    REQUIRE_MESSAGE(reply.status == 200, reply.body.dump());
    CHECK(reply.body["solutions"].empty());
    CHECK(reply.body["message"].get<std::string>().find("the search for link 'link_8' ended") !=
          std::string::npos);
  }

  TEST_CASE("memory that cannot be written is told until it can be, to those who may plan") {
    const TemporaryDirectory files;
    const std::string file = files / "m.db";
    const auto database = open_paths(file);
    ServiceSettings settings;
    settings.threads = 1;
    settings.remember_after = 0;
    internal::Endpoints endpoints(planar8(), database, settings, {});
    const std::atomic<bool> never = false;
    Json body = question();
    body["settings"] = {{"kind", "paths"}};
    const auto plan = [&] {
      body["settings"]["seed"] = body["settings"].value("seed", 0) + 1;
      return answer_of(endpoints.plan({"", body.dump(), never}));
    };
    {
      const FullDisk full;
      CHECK(plan()["remembered"] == "queued");
      while (database->queued_rows().failure.empty()) std::this_thread::yield();
      const Json degraded = answer_of(endpoints.health({"", "", never, true}));
      CHECK(degraded["status"] == "degraded");
      CHECK_MESSAGE(degraded["memory"].contains("failure"), degraded.dump());
      // That it can be read says nothing of writing.
      endpoints.refresh_memory();
      CHECK(answer_of(endpoints.health({"", "", never, true}))["status"] == "degraded");
      const Json of_stranger = answer_of(endpoints.health({"", "", never, false}));
      CHECK(of_stranger["status"] == "degraded");
      CHECK_FALSE(of_stranger["memory"].contains("failure"));
    }
    REQUIRE(database->flush());
    CHECK(database->size() == 1);
    endpoints.refresh_memory();
    CHECK(answer_of(endpoints.health({"", "", never, true}))["status"] == "ok");
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a scene that is removed while it is edited stays removed") {
    internal::SceneStore scenes(2);
    require(scenes.put("a", {}));
    const auto edited = require(scenes.change("a", [&](const Scene& scene) -> Result<Scene> {
      CHECK(scenes.remove("a"));
      return scene;
    }));
    CHECK(edited == nullptr);
    CHECK(scenes.count() == 0);
  }
}

}  // namespace
}  // namespace mneme::test
