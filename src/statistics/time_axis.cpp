// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "statistics/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace mneme::internal {
namespace {

constexpr std::string_view kRules = R"css(
.plot { --ink: #1f2937; --soft: #5b6675; --line: #dde3ec; --paper: #ffffff; --bad: #b42318;
  --c0: #c76a00; --c1: #4f74b3; --c2: #0b8a6a; --c3: #8250df; --c4: #bf2c86; --c5: #5f8416;
  --c6: #0e7c9b; --c7: #8a6d3b; font: 12px Inter, "Helvetica Neue", Helvetica, Arial, "DejaVu Sans",
  sans-serif; }
@media (prefers-color-scheme: dark) { .plot { --ink: #e6eaf0; --soft: #9aa6b6; --line: #323b49;
  --paper: #1b212b; --bad: #ff8a80; --c0: #f0a04b; --c1: #8fb0e6; --c2: #4cc3a1; --c3: #b79bff;
  --c4: #f07fc0; --c5: #a9cf5a; --c6: #5cc4e0; --c7: #cfae74; } }
.plot .paper { fill: var(--paper); }
.plot text { fill: var(--ink); }
.plot .soft { fill: var(--soft); }
.plot .head { font-weight: 600; font-size: 13px; }
.plot .grid { stroke: var(--line); }
.plot .faint { stroke: var(--line); stroke-opacity: 0.5; }
.plot .frame { stroke: var(--soft); fill: none; }
.plot .limit { stroke: var(--bad); stroke-dasharray: 6 4; stroke-opacity: 0.8; }
.plot .box { fill: var(--color); fill-opacity: 0.22; stroke: var(--color); stroke-width: 1.4; }
.plot .open { stroke-dasharray: 4 3; }
.plot .run { fill: var(--color); fill-opacity: 0.55; }
.plot .curve { stroke: var(--color); stroke-width: 2; fill: none; stroke-linejoin: round; }
)css";

}  // namespace

double TimeAxis::at(double seconds) const {
  const double clamped = std::clamp(seconds, least, most);
  return length * std::log(clamped / least) / std::log(most / least);
}

std::vector<Tick> ticks_of(const TimeAxis& axis) {
  const double decades = std::log10(axis.most / axis.least);
  std::vector<Tick> ticks;
  for (int power = static_cast<int>(std::floor(std::log10(axis.least)));; ++power) {
    for (const int digit : {1, 2, 5}) {
      const double seconds = digit * std::pow(10.0, power);
      if (seconds > axis.most * 1.0001) return ticks;
      if (seconds < axis.least * 0.9999) continue;
      const bool has_label = digit == 1 || decades < 2.5;
      ticks.push_back({seconds, has_label ? format_duration(seconds) : ""});
    }
  }
}

std::string format_duration(double seconds) {
  if (seconds >= 0.9995) return fmt::format("{:.3g} s", seconds);
  if (seconds >= 0.9995e-3) return fmt::format("{:.3g} ms", seconds * 1e3);
  return fmt::format("{:.3g} \u00b5s", seconds * 1e6);
}

void open_figure(SvgWriter& svg, const std::string& kind, double width, double height,
                 const std::string& label) {
  svg.open("svg", {{"class", kind},
                   {"xmlns", "http://www.w3.org/2000/svg"},
                   {"viewBox", fmt::format("0 0 {} {}", short_number(width), short_number(height))},
                   {"width", short_number(width)},
                   {"role", "img"},
                   {"aria-label", label}});
  svg.element("rect", {{"class", "paper"}, {"width", "100%"}, {"height", "100%"}});
}

void draw_line(SvgWriter& svg, const std::string& kind, Point from, Point to) {
  svg.element("line", {{"class", kind},
                       {"x1", short_number(from.x)},
                       {"y1", short_number(from.y)},
                       {"x2", short_number(to.x)},
                       {"y2", short_number(to.y)}});
}

void draw_text(SvgWriter& svg, const std::string& kind, Point at, const std::string& anchor,
               const std::string& text) {
  svg.text_element("text",
                   {{"class", kind},
                    {"x", short_number(at.x)},
                    {"y", short_number(at.y)},
                    {"text-anchor", anchor}},
                   text);
}

std::string color_class(const std::string& sampler, const std::vector<std::string>& samplers) {
  const auto position = std::ranges::find(samplers, sampler) - samplers.begin();
  return fmt::format("color-{}", position % kFigureColors);
}

std::string dash_of(std::size_t setting) {
  constexpr std::array<const char*, 5> kDashes = {"none", "7 4", "2 3", "10 3 2 3", "4 2"};
  return kDashes[setting % kDashes.size()];
}

const std::string& figure_style() {
  static const std::string style = [] {
    std::string text(kRules);
    for (int i = 0; i < kFigureColors; ++i) {
      text += fmt::format(".plot .color-{} {{ --color: var(--c{}); }}\n", i, i);
    }
    return text;
  }();
  return style;
}

std::string to_document(const std::string& figure) {
  const std::size_t content = figure.find(">\n") + 2;
  return fmt::format("{}<style>{}</style>\n{}", figure.substr(0, content), figure_style(),
                     figure.substr(content));
}

}  // namespace mneme::internal
