// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/trace.h"
#include "report/traced_plan.h"

#include <nlohmann/json.hpp>

namespace mneme {
namespace {

using test::contains;
using test::require;
using test::require_error;

using Json = nlohmann::json;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

std::string page_of(const std::string& json) { return require(to_page(json, "t.json")); }

/// The trace that stands in a page.
Json trace_in(const std::string& page) {
  const std::string opening = "<script type=\"application/json\" id=\"trace\">";
  const std::size_t begin = page.find(opening) + opening.size();
  return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

TEST_SUITE("unit") {
  TEST_CASE("A page is the viewer with the trace in it, and loads nothing from anywhere") {
    const std::string json = to_json(test::TracedPlan().trace());
    const std::string page = page_of(json);
    CHECK(trace_in(page) == Json::parse(json));
    CHECK(count(page, "<title>gap, unit_arm - mneme</title>") == 1);
    CHECK(count(page, "<script") == 2);
    CHECK(count(page, "<!--mneme-") == 0);
    for (const char* link : {"src=\"http", "href=\"http", "@import", "url(http"})
      CHECK(count(page, link) == 0);
    CHECK(count(page, "MIT license") == 1);
  }

  TEST_CASE("A trace beside another stands in it, without what both have in common") {
    test::TracedPlan plan;
    const std::string json = to_json(plan.trace());
    plan.result.sampler = "uniform";
    plan.problem.scene.obstacles[0].name = "other";
    const auto page = require(to_page(json, "t.json", to_json(plan.trace())));
    const Json trace = trace_in(page);
    CHECK(trace["plan"]["sampler"] == "gl");
    CHECK(trace["beside"]["plan"]["sampler"] == "uniform");
    CHECK(trace["beside"]["links"].empty());
    CHECK(trace["beside"]["obstacles"].size() == 2);
  }

  TEST_CASE("A trace beside another that is none, or of another robot, is refused") {
    test::TracedPlan plan;
    const std::string json = to_json(plan.trace());
    CHECK(
        require_error(to_page(json, "t.json", "{}")).message.find("t.json, beside: not a trace") ==
        0);
    Json other = Json::parse(json);
    other["robot"] = "another";
    CHECK(require_error(to_page(json, "t.json", other.dump())).message ==
          "t.json: the trace beside it is of another robot");
  }

  TEST_CASE("The viewer itself leaves most of a page's two megabytes to the trace") {
    CHECK(internal::viewer_page().size() < 700000);
    CHECK(internal::viewer_page().size() > 100000);
  }

  TEST_CASE("Names that look like markup stay names") {
    test::TracedPlan plan;
    plan.problem.name = "</script><script>alert(1)</script><!--mneme-trace-->";
    plan.problem.scene.obstacles[0].name = "<!-- <script>";
    const std::string page = page_of(to_json(plan.trace()));
    CHECK(count(page, "<script") == 2);
    CHECK(count(page, "alert(1)") == 2);
    CHECK(trace_in(page).at("problem") == plan.problem.name);
    CHECK(trace_in(page).at("obstacles")[0].at("name") == "<!-- <script>");
  }

  TEST_CASE("Deep nesting is refused, brackets in texts are not") {
    const auto with = [](const std::string& problem) {
      Json trace = Json::parse(to_json(test::TracedPlan().trace()));
      trace["problem"] = "PLACE";
      std::string text = trace.dump();
      return to_page(text.replace(text.find("\"PLACE\""), 7, problem), "t.json");
    };
    for (const std::string bracket : {"[", "{\"a\":"}) {
      std::string nested;
      for (int i = 0; i < 1'000'000; ++i) nested += bracket;
      REQUIRE_FALSE(with(nested).has_value());
      CHECK(with(nested).error().message == "t.json: expected a trace nested at most 64 deep");
    }
    CHECK(with("\"" + std::string(1000, '[') + "\\\"" + std::string(1000, '{') + "\"").has_value());
    const auto lists = [&](std::size_t depth) {
      return with(std::string(depth, '[') + std::string(depth, ']')).error().message;
    };
    CHECK(contains(lists(64), "nested"));
    CHECK(!contains(lists(63), "nested"));
  }

  TEST_CASE("A file that is too long is refused") {
    const Error error = require_error(to_page(std::string(kMaxTraceBytes + 1, ' '), "t.json"));
    CHECK(error.message == "t.json: expected a trace of at most 268435456 bytes");
  }

  TEST_CASE("What is no trace is refused with its name and what was expected") {
    const auto error = [](const std::string& text) {
      const Error refused = require_error(to_page(text, "t.json"));
      CHECK(refused.message.starts_with("t.json: "));
      return refused;
    };
    CHECK(error("").code == ErrorCode::parse);
    CHECK(error("{\"format\": \"mneme-trace\"").code == ErrorCode::parse);
    CHECK(contains(error("[1]").message, "expected \"format\""));
    CHECK(error("{\"format\": 3}").code == ErrorCode::parse);
    CHECK(error("{\"format\": \"mneme-trace\", \"version\": 2}").code == ErrorCode::unsupported);
    const Json whole = Json::parse(to_json(test::TracedPlan().trace()));
    for (const char* member : {"waypoints", "links", "plan", "edges"}) {
      Json part = whole;
      part.erase(member);
      CHECK(contains(error(part.dump()).message, member));
      part[member] = 1;
      CHECK(contains(error(part.dump()).message, member));
    }
  }
}

}  // namespace
}  // namespace mneme
