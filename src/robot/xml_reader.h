// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Strict reading of XML elements.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include "base/fail.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace mneme::internal {

using XmlElement = tinyxml2::XMLElement;

/// Longer URDF and SRDF texts are refused.
inline constexpr std::size_t kMaxRobotTextSize = std::size_t{64} << 20;

/// Returns the child elements in order; only those called `name` if it is given.
[[nodiscard]] std::vector<const XmlElement*> children(const XmlElement& element,
                                                      const char* name = nullptr);

/// Reads names, numbers and vectors from elements. Throws InputFailure with
/// "SOURCE:LINE: CONTEXT: what" at a faulty element.
class XmlReader {
 public:
  /// How text between elements is treated.
  enum class StrayText { fault, warning };
  explicit XmlReader(std::string source, StrayText stray_text = StrayText::fault)
      : source_(std::move(source)), stray_text_(stray_text) {}

  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// Names the current part, such as "link 'elbow'", in messages.
  void set_context(std::string context) { context_ = std::move(context); }
  [[noreturn]] void fail(int line, std::string_view what, ErrorCode code = ErrorCode::parse) const;
  /// The same with the element's line and "<NAME>: " before `what`.
  [[noreturn]] void fail(const XmlElement& element, std::string_view what,
                         ErrorCode code = ErrorCode::parse) const;

  template <class Where, class First, class... Rest>
  requires(!std::same_as<std::remove_cvref_t<First>, ErrorCode>)
      [[noreturn]] void fail(const Where& where, fmt::format_string<First, Rest...> what,
                             First&& first, Rest&&... rest) const {
    fail(where, fmt::format(what, std::forward<First>(first), std::forward<Rest>(rest)...));
  }

  /// The root element of `text`, which must be well-formed, at most 64 MB and one `name` element.
  const XmlElement& read_root(tinyxml2::XMLDocument& document, std::string_view text,
                              const char* name) const;
  /// Allows comments, text that is no fault, each element of `single` at most once, and those of
  /// `repeated` at will.
  void check_children(const XmlElement& element, std::initializer_list<std::string_view> single,
                      std::initializer_list<std::string_view> repeated);
  /// Refuses other attributes: a mistyped name must not become a default value.
  void check_attributes(const XmlElement& element,
                        std::initializer_list<std::string_view> known) const;

  const XmlElement& required_child(const XmlElement& element, const char* name) const;
  /// The attribute's text, not empty.
  std::string text(const XmlElement& element, const char* attribute) const;
  /// The attribute's value: one finite decimal number, whatever the locale.
  double number(const XmlElement& element, const char* attribute) const;
  double positive_number(const XmlElement& element, const char* attribute) const;
  double non_negative_number(const XmlElement& element, const char* attribute) const;
  /// The attribute's three numbers; `fallback` where it is missing.
  Vec3 vector(const XmlElement& element, const char* attribute, const Vec3& fallback) const;

 private:
  void take_stray_text(const XmlElement& element, const tinyxml2::XMLNode& text);
  [[nodiscard]] std::string place(int line, std::string_view what) const;

  std::string source_;
  StrayText stray_text_;
  std::vector<std::string> warnings_;
  std::string context_;
};

}  // namespace mneme::internal
