// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Writes SVG elements with short numbers and escaped text.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mneme::internal {

/// A point of a drawing, or of the plane in metres.
struct Point {
  double x = 0;
  double y = 0;
};

/// At most `decimals` decimals, without trailing zeros; "0" for what is not finite.
[[nodiscard]] std::string short_number(double value, int decimals = 2);
/// The value of a `points` attribute.
[[nodiscard]] std::string short_points(std::span<const Point> points);

/// Attribute names and values; values are escaped when written.
using Attributes = std::initializer_list<std::pair<std::string_view, std::string>>;

class SvgWriter {
 public:
  void open(std::string_view tag, Attributes attributes = {});
  void close();
  void element(std::string_view tag, Attributes attributes);
  /// An element that holds text.
  void text_element(std::string_view tag, Attributes attributes, std::string_view content);

  /// The document; every opened element must be closed.
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  void begin(std::string_view tag, Attributes attributes);
  std::string text_;
  std::vector<std::string> open_tags_;
};

}  // namespace mneme::internal
