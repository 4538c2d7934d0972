// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell/cells.h"
#include "service/service_fixture.h"

#include <doctest/doctest.h>

namespace mneme::test {

TEST_SUITE("flow") {
  TEST_CASE("a service asks its cells first, and plans what is none of their tasks") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text("{x: 0.04, y: 0.04}"));
    ServiceSettings settings = loopback();
    settings.cells = {std::make_shared<const Cell>(require_cell(region, 20))};
    settings.shown = std::make_shared<const Problem>(region.problem);
    auto service = require(Service::start(region.problem.robot, nullptr, settings));
    httplib::Client client(service.address());
    client.set_read_timeout(100);
    Json body = {
        {"start", region.problem.start},
        {"goal",
         {{"link", "panda_hand"}, {"position", {0.51, -0.02, 0.35}}, {"quat_xyzw", {1, 0, 0, 0}}}}};
    const Reply certified = post(client, "/v1/plan", body);
    CHECK(certified.status == 200);
    CHECK(certified.body["status"] == "solved");
    REQUIRE(certified.body.contains("cell"));
    CHECK(certified.body["cell"]["tier"] == "certified");
    CHECK(certified.body["planner"] == "cell");
    CHECK(
        contains(client.Get("/metrics")->body, "mneme_cell_answers_total{tier=\"certified\"} 1\n"));
    const Reply timed = post(client, "/v1/plan?trajectory=true", body);
    REQUIRE(timed.body.contains("trajectory"));
    CHECK(timed.body["cell"]["tier"] == "certified");
    // All tasks of a box take equally long.
    Json near = body;
    near["goal"]["position"] = {0.511, -0.021, 0.35};
    const Reply second = post(client, "/v1/plan?trajectory=true", near);
    REQUIRE(second.body["cell"] == timed.body["cell"]);
    const auto duration_of = [](const Reply& reply) {
      return reply.body["trajectory"]["duration_s"].get<double>();
    };
    CHECK(duration_of(second) == duration_of(timed));
    // Another start, another scene and a pose beyond the region are planned.
    Json other = body;
    other["start"][0] = 0.1;
    CHECK_FALSE(post(client, "/v1/plan", other).body.contains("cell"));
    // A start that is hardly another is planned, too, and a note says so.
    other["start"][0] = 1e-9;
    const Reply hardly = post(client, "/v1/plan", other);
    CHECK_FALSE(hardly.body.contains("cell"));
    CHECK(contains(hardly.body["notes"].dump(), "from start 'start' of the cell"));
    other = body;
    other["obstacles"] = {{{"name", "box"},
                           {"type", "box"},
                           {"p", {0.5, -0.6, 0.5}},
                           {"q", {1, 0, 0, 0}},
                           {"size", {0.1, 0.1, 0.1}}}};
    const Reply planned = post(client, "/v1/plan", other);
    CHECK(planned.body["status"] == "solved");
    CHECK_FALSE(planned.body.contains("cell"));
    other = body;
    other["goal"]["position"][2] = 0.36;
    CHECK_FALSE(post(client, "/v1/plan", other).body.contains("cell"));
  }
}

}  // namespace mneme::test
