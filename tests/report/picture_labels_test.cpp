// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/picture.h"
#include "report/report_support.h"

namespace mneme::internal {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("Boxes overlap by their common area") {
    CHECK(overlap_area({0, 0, 2, 2}, {1, 1, 3, 3}) == 1);
    CHECK(overlap_area({0, 0, 2, 2}, {2, 0, 3, 3}) == 0);
    CHECK(overlap_area({0, 0, 1, 1}, {5, 5, 6, 6}) == 0);
  }

  TEST_CASE("A label takes the first place that is free") {
    LabelPlacer placer({0, 0, 100, 100});
    placer.avoid({0, 0, 50, 50});
    const std::vector<Point> candidates = {{25, 25}, {75, 25}, {75, 75}};
    const Point first = placer.place(candidates, 20, 10);
    CHECK(first.x == 75);
    CHECK(first.y == 25);
    const Point second = placer.place(candidates, 20, 10);
    CHECK(second.y == 75);
  }

  TEST_CASE("A label would rather cover something than stick out of the panel") {
    LabelPlacer placer({0, 0, 100, 100});
    placer.avoid({0, 0, 100, 100});
    const std::vector<Point> candidates = {{0, 50}, {50, 50}};
    CHECK(placer.place(candidates, 20, 10).x == 50);
  }

  TEST_CASE("Labels keep off lines") {
    LabelPlacer placer({0, 0, 100, 100});
    const std::vector<Point> line = {{0, 0}, {60, 60}};
    placer.avoid_line(line);
    const std::vector<Point> candidates = {{30, 30}, {30, 80}};
    CHECK(placer.place(candidates, 20, 10).y == 80);
  }

  TEST_CASE("The colour of the path runs from blue over violet to red") {
    CHECK(path_color(0) == "#1f5fd0");
    CHECK(path_color(0.5) == "#964aaa");
    CHECK(path_color(1) == "#d9303a");
    CHECK(path_color(2) == path_color(1));
  }

  TEST_CASE("A legend that is too long for one row takes another") {
    const std::vector<LegendEntry> entries(3, {LegendMark::bold_line, "#000000", "some words"});
    CHECK(legend_height(entries, 1000) * 3 == legend_height(entries, 10));
    CHECK(legend_height({}, 10) == 0);
  }

  TEST_CASE("A legend has a text for every entry and a mark beside it") {
    const std::vector<LegendEntry> entries = {{LegendMark::bold_line, "#000000", "start & more"},
                                              {LegendMark::fan, "", "path"},
                                              {LegendMark::dashed_box, "#111111", "primitive"},
                                              {LegendMark::thin_lines, "#222222", "arms"}};
    SvgWriter svg;
    write_legend(svg, entries, {0, 0}, 600);
    const test::SvgReader reader(svg.str());
    const auto texts = reader.find("legend", "text");
    REQUIRE(texts.size() == 4);
    CHECK(std::string(texts[0]->GetText()) == "start & more");
    CHECK(reader.count("legend", "line") == 1 + 9 + 3);
    CHECK(reader.count("legend", "path") == 1);
  }
}

TEST_SUITE("law") {
  TEST_CASE("Places for a label lie outside the polygon, whichever way round it goes") {
    const std::vector<Point> square = {{100, 100}, {200, 100}, {200, 200}, {100, 200}};
    const std::vector<Point> reversed(square.rbegin(), square.rend());
    for (const auto& corners : {square, reversed}) {
      const auto places = label_places(corners, 40, 10);
      CHECK(places.size() == 20);
      for (const Point& place : places) {
        const PixelBox box = {place.x - 20, place.y - 5, place.x + 20, place.y + 5};
        CHECK(overlap_area(box, {100, 100, 200, 200}) == 0);
      }
    }
  }
}

}  // namespace
}  // namespace mneme::internal
