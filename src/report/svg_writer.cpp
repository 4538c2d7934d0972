// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/svg_writer.h"

#include "report/markup.h"

#include <fmt/format.h>

#include <cmath>

namespace mneme::internal {

std::string short_number(double value, int decimals) {
  if (!std::isfinite(value)) return "0";
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (decimals > 0) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string short_points(std::span<const Point> points) {
  std::string text;
  for (const Point& point : points) {
    if (!text.empty()) text += ' ';
    text += short_number(point.x) + ',' + short_number(point.y);
  }
  return text;
}

void SvgWriter::begin(std::string_view tag, Attributes attributes) {
  text_ += '<';
  text_ += tag;
  for (const auto& [name, value] : attributes) {
    text_ += fmt::format(" {}=\"{}\"", name, escape_markup(value));
  }
}

void SvgWriter::open(std::string_view tag, Attributes attributes) {
  begin(tag, attributes);
  text_ += ">\n";
  open_tags_.emplace_back(tag);
}

void SvgWriter::close() {
  text_ += fmt::format("</{}>\n", open_tags_.back());
  open_tags_.pop_back();
}

void SvgWriter::element(std::string_view tag, Attributes attributes) {
  begin(tag, attributes);
  text_ += "/>\n";
}

void SvgWriter::text_element(std::string_view tag, Attributes attributes,
                             std::string_view content) {
  begin(tag, attributes);
  text_ += fmt::format(">{}</{}>\n", escape_markup(content), tag);
}

}  // namespace mneme::internal
