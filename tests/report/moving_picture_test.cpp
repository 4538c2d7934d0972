// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/problem.h"

#include "report/picture.h"
#include "report/report_support.h"

namespace mneme::internal {
namespace {

int occurrences(const std::string& text, std::string_view words) {
  int count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) {
    ++count;
  }
  return count;
}

TEST_SUITE("unit") {
  TEST_CASE("a convex hull has the corners of a square and nothing inside") {
    const Polygon hull = convex_hull({{0, 0}, {1, 1}, {0.5, 0.5}, {1, 0}, {0, 1}, {0.5, 0}});
    CHECK(hull.size() == 4);
    double area = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Point &a = hull[i], &b = hull[(i + 1) % hull.size()];
      area += (a.x * b.y - b.x * a.y) / 2;
    }
    CHECK(area == doctest::Approx(1));
  }

  TEST_CASE("a moving picture has a group per frame, of which one at a time is shown") {
    const Problem problem = load_problem(test::source_file("scenes/shelf/thin.yaml")).value();
    MovingPicture picture{&problem, {problem.start, problem.goals.front()}};
    picture.frames = 5;
    const std::string svg = to_svg(picture).value();
    CHECK(occurrences(svg, "<animate ") == 5);
    CHECK(occurrences(svg, "display=\"inline\"") == 1);
    CHECK(occurrences(svg, "<svg") == 1);
    CHECK(occurrences(svg, "</g>") == occurrences(svg, "<g "));
    // Frames begin in order, and each ends where the next one begins.
    CHECK(occurrences(svg, "keyTimes=\"0;0.1200\"") == 1);
    CHECK(occurrences(svg, "keyTimes=\"0;0.1200;0.3733\"") == 1);
    CHECK(occurrences(svg, "keyTimes=\"0;0.8800\"") == 1);
  }

  TEST_CASE("a moving picture without a path is refused") {
    const Problem problem = load_problem(test::source_file("scenes/shelf/thin.yaml")).value();
    CHECK_FALSE(to_svg(MovingPicture{&problem, {problem.start}}).has_value());
  }
}

}  // namespace
}  // namespace mneme::internal
