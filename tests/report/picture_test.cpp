// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "report/picture.h"
#include "report/report_support.h"

#include <set>

namespace mneme::internal {
namespace {

const PlanarView kView({0, 10, 0, 10}, {0, 0}, 152);  // 10 pixels per metre

TEST_SUITE("unit") {
  TEST_CASE("Neighbouring primitives differ in colour, and uniform samples are of none of them") {
    std::set<std::string> colors;
    for (int i = -1; i < 10; ++i) colors.insert(primitive_color(i));
    CHECK(colors.size() == 11);
    CHECK(primitive_color(10) == primitive_color(0));
  }

  TEST_CASE("Discs are circles of their true radius, polygons have all corners") {
    SvgWriter svg;
    PictureWriter(svg, kView).write_obstacles({Disc{{5, 5}, 2}, Polygon{{0, 0}, {1, 0}, {1, 1}}});
    const test::SvgReader reader(svg.str());
    REQUIRE(reader.count("obstacles", "circle") == 1);
    CHECK(reader.find("obstacles", "circle")[0]->DoubleAttribute("r") == doctest::Approx(20));
    CHECK(reader.count("obstacles", "polygon") == 1);
  }

  TEST_CASE("Thick links are drawn at their true width, thin ones so that they are seen") {
    SvgWriter svg;
    const Arm arm = {{{{0, 0}, {1, 0}}, 0.001}, {{{2, 2}}, 0.5}};
    PictureWriter(svg, kView).write_fan({arm});
    const auto lines = test::SvgReader(svg.str()).count("path", "polyline");
    CHECK(lines == 2);
    const test::SvgReader reader(svg.str());
    CHECK(reader.find("path", "polyline")[0]->DoubleAttribute("stroke-width") ==
          doctest::Approx(1.1));
    CHECK(reader.find("path", "polyline")[1]->DoubleAttribute("stroke-width") ==
          doctest::Approx(10));
  }

  TEST_CASE("A bold arm has a dot at every joint") {
    SvgWriter svg;
    PictureWriter(svg, kView).write_bold_arm({{{{0, 0}, {1, 0}, {1, 1}}, 0}}, "goal", "#123456");
    const test::SvgReader reader(svg.str());
    CHECK(reader.count("goal", "circle") == 3);
    CHECK(reader.count("goal", "polyline") == 2);
  }

  TEST_CASE("The trace of the tip is whole: every piece begins where the one before it ended") {
    std::vector<Point> trace;
    for (int i = 0; i < 20; ++i) trace.push_back({0.5 * i, 1});
    SvgWriter svg;
    PictureWriter(svg, kView).write_tip_trace(trace);
    const test::SvgReader reader(svg.str());
    std::string last;
    for (const auto* piece : reader.find("tip-trace", "polyline")) {
      const std::string points = piece->Attribute("points");
      const std::string first = points.substr(0, points.find(' '));
      if (!last.empty()) CHECK(first == last);
      last = points.substr(points.rfind(' ') + 1);
    }
    CHECK(last == short_points(std::vector<Point>{kView.pixel(trace.back())}));
  }

  TEST_CASE("Frames and labels of a primitive share its colour") {
    const std::vector<FramedPrimitive> primitives(2,
                                                  {{{1, 1}, {2, 1}, {2, 2}, {1, 2}}, "3 matches"});
    SvgWriter svg;
    PictureWriter writer(svg, kView);
    svg.open("svg");
    writer.write_frames(primitives, "fill", {{"class", "primitive-fills"}});
    writer.write_frames(primitives, "stroke", {{"class", "primitives"}});
    writer.write_labels(primitives, LabelPlacer({0, 0, 152, 152}));
    svg.close();
    const test::SvgReader reader(svg.str());
    REQUIRE(reader.count("primitives", "polygon") == 2);
    REQUIRE(reader.count("labels", "text") == 2);
    const auto* label = reader.find("labels", "text")[1];
    CHECK(std::string(label->GetText()) == "3 matches");
    CHECK(std::string(label->Attribute("fill")) == primitive_color(1));
    CHECK(std::string(reader.find("primitives", "polygon")[1]->Attribute("stroke")) ==
          primitive_color(1));
    CHECK(std::string(reader.find("primitive-fills", "polygon")[1]->Attribute("fill")) ==
          primitive_color(1));
  }
}

}  // namespace

}  // namespace mneme::internal

namespace mneme {
namespace {

using test::require;
using test::require_error;

std::string svg_of(const PlanarPicture& picture) { return require(to_svg(picture)); }

/// True if a number in `text` has more than three digits after its point.
bool has_long_number(const std::string& text) {
  int decimals = -1;
  for (const char c : text) {
    if (c == '.') {
      decimals = 0;
    } else if (decimals >= 0 && c >= '0' && c <= '9') {
      if (++decimals > 3) return true;
    } else {
      decimals = -1;
    }
  }
  return false;
}

TEST_SUITE("unit") {
  TEST_CASE("A picture shows obstacles, primitives, remembered arms, path and ends") {
    const Problem problem = test::gap_problem();
    const GlSampler gl = test::gap_memory(100);
    PlanarPicture picture = test::picture_of(problem);
    picture.gl = &gl;
    picture.path = {problem.start, problem.goals[0]};
    picture.title = "Through the gap";
    picture.max_arms = 30;
    const test::SvgReader svg(svg_of(picture));
    CHECK(std::string(svg.root()->Attribute("xmlns")) == "http://www.w3.org/2000/svg");
    CHECK(svg.count("obstacles", "circle") == 2);
    CHECK(svg.count("primitives", "polygon") == 1);
    CHECK(svg.count("labels", "text") == 1);
    CHECK(svg.count("memories", "polyline") == 30);
    CHECK(svg.count("path", "polyline") == 5);
    CHECK(svg.count("start", "circle") == 4);
    CHECK(svg.count("goal", "circle") == 4);
    CHECK(svg.count("base", "rect") == 1);
    CHECK(svg.count("legend", "text") == 5);
    CHECK(std::string(svg.find("title", "text")[0]->GetText()) == "Through the gap");
  }

  TEST_CASE("Without memory and path a picture shows the problem: the start and all goals") {
    Problem problem = test::gap_problem();
    problem.goals.push_back({2, 0, 0});
    const test::SvgReader svg(svg_of(test::picture_of(problem)));
    CHECK(svg.count("start", "circle") == 4);
    CHECK(svg.count("goal", "circle") == 8);
    CHECK(svg.count("memories", "polyline") == 0);
    CHECK(svg.count("path", "polyline") == 0);
    CHECK(svg.count("legend", "text") == 2);
    CHECK(std::string(svg.root()->FirstChildElement("title")->GetText()) == "gap");
  }

  TEST_CASE("Any title is escaped") {
    const Problem problem = test::gap_problem();
    PlanarPicture picture = test::picture_of(problem);
    picture.title = "a < b & \"c\" \x01\xFF";
    const test::SvgReader svg(svg_of(picture));
    CHECK(std::string(svg.find("title", "text")[0]->GetText()) ==
          "a < b & \"c\" \xEF\xBF\xBD\xEF\xBF\xBD");
  }

  TEST_CASE("A robot that is not planar is refused") {
    Problem problem = test::gap_problem();
    problem.robot = test::unit_arm(3, Vec3::UnitX());
    CHECK(require_error(to_svg(test::picture_of(problem))).code == ErrorCode::unsupported);
  }
}

TEST_SUITE("law") {
  TEST_CASE("Everything that is drawn lies within the panel, in short numbers") {
    Rng rng(7);
    for (int round = 0; round < 20; ++round) {
      CAPTURE(round);
      Problem problem = test::gap_problem();
      PlanarPicture picture = test::picture_of(problem);
      for (int i = 0; i < 4; ++i)
        picture.path.push_back(test::random_configuration(problem.robot, rng));
      const std::string text = svg_of(picture);
      CHECK_FALSE(has_long_number(text));
      const test::SvgReader svg(text);
      const auto* panel = svg.find("panel", "svg")[0];
      const double left = panel->DoubleAttribute("x");
      const double top = panel->DoubleAttribute("y");
      for (const auto* joint : svg.find("start", "circle")) {
        CHECK(joint->DoubleAttribute("cx") > left);
        CHECK(joint->DoubleAttribute("cx") < left + panel->DoubleAttribute("width"));
        CHECK(joint->DoubleAttribute("cy") > top);
        CHECK(joint->DoubleAttribute("cy") < top + panel->DoubleAttribute("height"));
      }
    }
  }
}

}  // namespace

}  // namespace mneme
