// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Reading of XML elements, strict or lenient, and values to write.
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
  /// Strict: findings are errors. Lenient: warnings() lists them.
  enum class Mode { strict, lenient };
  explicit XmlReader(std::string source, Mode mode = Mode::strict)
      : source_(std::move(source)), mode_(mode) {}

  [[nodiscard]] bool is_strict() const { return mode_ == Mode::strict; }
  /// Records a finding such as "unknown element <x> in <link>", or fails with `fault` if strict.
  void tolerate(int line, const std::string& what, std::string_view fault,
                ErrorCode code = ErrorCode::parse);
  /// As above, with the context and the element's name before both texts.
  void tolerate(const XmlElement& element, std::string_view what, std::string_view fault,
                ErrorCode code = ErrorCode::parse);
  /// Returns one warning that counts and names the findings; none without findings.
  [[nodiscard]] std::vector<std::string> warnings() const;
  /// Names the current part, such as "link 'elbow'", in messages.
  void set_context(std::string context) { context_ = std::move(context); }
  [[noreturn]] void fail(int line, std::string_view what, ErrorCode code = ErrorCode::parse) const;
  /// As above, with the element's line and "<NAME>: " before `what`.
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
  /// Records text, elements other than `single` and `repeated`, and a second element of `single`,
  /// which is ignored. Elements that xacro expands are an error in both modes.
  void check_children(const XmlElement& element, std::initializer_list<std::string_view> single,
                      std::initializer_list<std::string_view> repeated);
  /// Records attributes that are not in `known`.
  void check_attributes(const XmlElement& element, std::initializer_list<std::string_view> known);

  const XmlElement& required_child(const XmlElement& element, const char* name) const;
  /// The attribute's text, not empty.
  std::string text(const XmlElement& element, const char* attribute) const;
  /// The attribute's value: one finite decimal number, whatever the locale.
  double number(const XmlElement& element, const char* attribute) const;
  double non_negative_number(const XmlElement& element, const char* attribute) const;
  /// As number(), but infinite values are allowed.
  double number_or_infinity(const XmlElement& element, const char* attribute) const;
  /// The finite numbers of an attribute that exists, as many as one of `counts`; `expected` names
  /// them in messages.
  std::vector<double> numbers(const XmlElement& element, const char* attribute,
                              std::initializer_list<std::size_t> counts,
                              std::string_view expected) const;
  /// The attribute's three numbers; `fallback` where it is missing.
  Vec3 vector(const XmlElement& element, const char* attribute, const Vec3& fallback) const;

 private:
  struct Finding {
    std::string what;
    int line = 0;
    int count = 1;
  };
  [[nodiscard]] std::string in_context(std::string_view what) const;
  void check_child(const XmlElement& element, const XmlElement& child, bool is_single,
                   const std::vector<std::string_view>& known);

  std::string source_;
  Mode mode_;
  std::vector<Finding> findings_;  ///< the first few
  int finding_count_ = 0;
  std::string context_;
};

/// Returns three numbers that read back to the same bits, except for the sign of zero.
[[nodiscard]] std::string xml_vector(const Vec3& v);

/// Returns `<origin xyz rpy/>` without attributes that are zero; nothing for the identity.
[[nodiscard]] std::string xml_origin(const Transform& pose);

}  // namespace mneme::internal
