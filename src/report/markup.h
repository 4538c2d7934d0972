// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Text that is safe in XML, HTML, CSV and tables for any input bytes. A writer of SVG elements.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Replaces malformed UTF-8, and characters that XML 1.0 forbids, by U+FFFD.
[[nodiscard]] std::string clean_text(std::string_view text);
/// Cleans and escapes text for the content and the quoted attributes of XML and HTML.
[[nodiscard]] std::string escape_markup(std::string_view text);
/// Cleans text and joins its lines, for text tables.
[[nodiscard]] std::string single_line(std::string_view text);
/// Returns the number of characters of well-formed UTF-8.
[[nodiscard]] int character_count(std::string_view text);
/// Returns at most `limit` >= 1 characters of well-formed UTF-8; shortened text ends in an
/// ellipsis.
[[nodiscard]] std::string shortened(const std::string& text, int limit);

/// A point of a picture in pixels, or of the plane in metres.
struct Point {
  double x = 0;
  double y = 0;
};

/// Prints at most `decimals` decimals without trailing zeros; "0" if `value` is not finite.
[[nodiscard]] std::string short_number(double value, int decimals = 2);
/// Prints the value of a `points` attribute.
[[nodiscard]] std::string short_points(std::span<const Point> points, int decimals = 2);

/// Names and values of attributes. Values are escaped when written.
using Attributes = std::initializer_list<std::pair<std::string_view, std::string>>;

class SvgWriter {
 public:
  void open(std::string_view tag, Attributes attributes = {});
  void close();
  void element(std::string_view tag, Attributes attributes);
  /// An element that holds text.
  void text_element(std::string_view tag, Attributes attributes, std::string_view content);

  /// Returns the document. Every opened element must be closed.
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  void begin(std::string_view tag, Attributes attributes);
  std::string text_;
  std::vector<std::string> open_tags_;
};

}  // namespace mneme::internal
