// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/markup.h"

#include "base/text.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

namespace mneme::internal {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

bool is_xml_character(char32_t code) {
  if (code < 0x20) return code == '\t' || code == '\n' || code == '\r';
  return code != 0xFFFE && code != 0xFFFF;
}

/// Bytes of the character that `text` begins with, or 0 if XML cannot hold it.
std::size_t character_size(std::string_view text) {
  const CodePoint first = first_code_point(text);
  return is_xml_character(first.value) ? first.size : 0;
}

}  // namespace

std::string clean_text(std::string_view text) {
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    clean += size == 0 ? kReplacement : text.substr(0, size);
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return clean;
}

std::string escape_markup(std::string_view text) { return xml_escaped(clean_text(text)); }

std::string single_line(std::string_view text) {
  std::string line = clean_text(text);
  for (char& c : line) {
    if (c == '\t' || c == '\n' || c == '\r') c = ' ';
  }
  return line;
}

int character_count(std::string_view text) {
  int count = 0;
  for (const char c : text) count += is_continuation(c) ? 0 : 1;
  return count;
}

std::string shortened(const std::string& text, int limit) {
  if (character_count(text) <= limit) return text;
  std::size_t end = 0;
  for (int kept = 0; end < text.size(); ++end) {
    if (is_continuation(text[end])) continue;
    if (kept == limit - 1) break;
    ++kept;
  }
  return text.substr(0, end) + "\xE2\x80\xA6";
}

std::string short_number(double value, int decimals) {
  if (!std::isfinite(value)) return "0";
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (decimals > 0) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string short_points(std::span<const Point> points, int decimals) {
  std::string text;
  for (const Point& point : points) {
    if (!text.empty()) text += ' ';
    text += short_number(point.x, decimals) + ',' + short_number(point.y, decimals);
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
