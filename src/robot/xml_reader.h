// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Strict reading of XML elements, in which the first fault decides.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"

#include <tinyxml2.h>

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::internal {

using XmlElement = tinyxml2::XMLElement;

/// Longer URDF and SRDF texts are refused.
inline constexpr std::size_t kMaxRobotTextSize = std::size_t{64} << 20;

/// Reads names, numbers and vectors from elements. After the first fault it goes on with empty
/// values, so that callers ask for the fault once, at the end. All calls name an element, whose
/// line stands in the message.
class XmlReader {
 public:
  /// What text between elements is.
  enum class StrayText { fault, warning };
  explicit XmlReader(std::string source, StrayText stray_text = StrayText::fault)
      : source_(std::move(source)), stray_text_(stray_text) {}

  [[nodiscard]] const std::optional<Error>& fault() const { return fault_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// What is being read, such as "link 'elbow'"; stands in messages after file and line.
  void set_context(std::string context) { context_ = std::move(context); }
  /// Notes a fault, unless there is one: "SOURCE:LINE: CONTEXT: what".
  void note(int line, std::string_view what, ErrorCode code = ErrorCode::parse);

  /// The root element, if the document is well-formed and is one `name` element.
  const XmlElement* read_root(tinyxml2::XMLDocument& document, std::string_view text,
                              const char* name);
  /// Faults unless all children are comments, text that is no fault, or elements: each of `single`
  /// at most once, others of `repeated` at will.
  void check_children(const XmlElement& element, std::initializer_list<std::string_view> single,
                      std::initializer_list<std::string_view> repeated);
  /// Faults if there is another attribute than these: a mistyped name must not become a default
  /// value.
  void check_attributes(const XmlElement& element, std::initializer_list<std::string_view> known);

  /// The child of this name, or null and a fault.
  const XmlElement* required_child(const XmlElement& element, const char* name);
  /// The attribute's text, not empty.
  std::string text(const XmlElement& element, const char* attribute);
  /// The attribute's value: one finite decimal number, whatever the locale.
  double number(const XmlElement& element, const char* attribute);
  double positive_number(const XmlElement& element, const char* attribute);
  double non_negative_number(const XmlElement& element, const char* attribute);
  /// The attribute's three numbers; `fallback` where it is missing.
  Vec3 vector(const XmlElement& element, const char* attribute, const Vec3& fallback);

 private:
  void note(const XmlElement& element, std::string_view what);
  void note_text(const XmlElement& element, const tinyxml2::XMLNode& text);

  [[nodiscard]] std::string place(int line, std::string_view what) const;

  std::string source_;
  StrayText stray_text_;
  std::vector<std::string> warnings_;
  std::string context_;
  std::optional<Error> fault_;
};

}  // namespace mneme::internal
