// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "input/xml_reader.h"

#include "base/text.h"
#include "input/elided.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

namespace mneme::internal {
namespace {

constexpr std::size_t kMaxQuotedLength = 60;
constexpr std::size_t kMostNamed = 12;  // findings

/// `text` short enough for a message.
std::string quoted_excerpt(std::string_view text) {
  const bool is_long = text.size() > kMaxQuotedLength;
  return fmt::format("'{}{}'", text.substr(0, kMaxQuotedLength), is_long ? "..." : "");
}

/// Advice for a text that xacro would have computed.
std::string_view xacro_hint(std::string_view text) {
  const bool is_left = text.find("${") != text.npos || text.find("$(") != text.npos;
  return is_left ? "; let xacro compute it: xacro FILE.xacro > FILE" : "";
}

/// May be infinite, but not NaN.
std::optional<double> parse_xml_number(std::string_view word) {
  // XML allows a plus sign, which from_chars does not.
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const auto value = parse_number_or_infinity(word);
  return value && !std::isnan(*value) ? value : std::nullopt;
}

/// The name of tinyxml2's error, such as "mismatched element".
std::string describe(const tinyxml2::XMLDocument& document) {
  if (document.ErrorID() == tinyxml2::XML_ERROR_PARSING) return "an element that does not end";
  if (document.ErrorID() == tinyxml2::XML_ERROR_PARSING_TEXT) return "text that no tag follows";
  if (document.ErrorID() == tinyxml2::XML_ERROR_PARSING_DECLARATION) {
    return "an instruction <?..?> that is not at the beginning or does not end; remove it";
  }
  std::string_view name = document.ErrorName();
  constexpr std::string_view kPrefix = "XML_ERROR_";
  if (name.starts_with(kPrefix)) name.remove_prefix(kPrefix.size());
  std::string words(name);
  std::ranges::transform(words, words.begin(), [](char c) {
    return c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return words;
}

bool contains(std::initializer_list<std::string_view> names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

std::vector<const XmlElement*> children(const XmlElement& element, const char* name) {
  std::vector<const XmlElement*> result;
  for (const XmlElement* child = element.FirstChildElement(name); child != nullptr;
       child = child->NextSiblingElement(name)) {
    result.push_back(child);
  }
  return result;
}

void XmlReader::fail(int line, std::string_view what, ErrorCode code) const {
  throw InputFailure{
      {code, fmt::format("{}:{}: {}", source_, std::max(line, 1), elided(in_context(what)))}};
}

void XmlReader::fail(const XmlElement& element, std::string_view what, ErrorCode code) const {
  fail(element.GetLineNum(), fmt::format("<{}>: {}", element.Name(), what), code);
}

std::string XmlReader::in_context(std::string_view what) const {
  return context_.empty() ? std::string(what) : fmt::format("{}: {}", context_, what);
}

void XmlReader::tolerate(int line, const std::string& what, std::string_view fault,
                         ErrorCode code) {
  if (is_strict()) fail(line, fault, code);
  ++finding_count_;
  const std::string shown = elided(what);
  const auto known = std::ranges::find(findings_, shown, &Finding::what);
  if (known != findings_.end()) {
    ++known->count;
  } else if (findings_.size() < kMostNamed) {
    findings_.push_back({shown, line});
  }
}

void XmlReader::tolerate(const XmlElement& element, std::string_view what, std::string_view fault,
                         ErrorCode code) {
  tolerate(element.GetLineNum(), in_context(fmt::format("<{}>: {}", element.Name(), what)),
           fmt::format("<{}>: {}", element.Name(), fault), code);
}

std::vector<std::string> XmlReader::warnings() const {
  if (findings_.empty()) return {};
  std::vector<std::string> named;
  int left = finding_count_;
  for (const Finding& finding : findings_) {
    left -= finding.count;
    const std::string times =
        finding.count > 1 ? fmt::format("{} times, first in ", finding.count) : "";
    named.push_back(fmt::format("{} ({}line {})", finding.what, times, finding.line));
  }
  if (left > 0) named.push_back(fmt::format("and {} more", left));
  return {fmt::format("{}: tolerated {} {} (an error if strict): {}", source_, finding_count_,
                      finding_count_ == 1 ? "fault" : "faults", fmt::join(named, "; "))};
}

const XmlElement& XmlReader::read_root(tinyxml2::XMLDocument& document, std::string_view text,
                                       const char* name) const {
  if (text.size() > kMaxRobotTextSize) fail(1, "the text is longer than 64 MB");
  const auto null = std::ranges::find(text, '\0');
  if (null != text.end()) {
    fail(1 + static_cast<int>(std::count(text.begin(), null, '\n')), "a null byte is no XML");
  }
  if (const auto flaw = find_costly_xml(text)) fail(1, *flaw, ErrorCode::unsupported);
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const bool is_xml =
        text.substr(0, text.find_first_not_of(" \t\r\n\xef\xbb\xbf") + 1).ends_with('<');
    fail(document.ErrorLineNum(),
         "malformed XML: " + describe(document) +
             (is_xml ? "" : fmt::format("; expected a <{}> element", name)));
  }
  const XmlElement* root = document.RootElement();
  if (root == nullptr || root->Name() != std::string_view(name)) {
    fail(root == nullptr ? 1 : root->GetLineNum(), "the document is no <{}> element", name);
  }
  for (const tinyxml2::XMLNode* node = root->NextSibling(); node; node = node->NextSibling()) {
    if (node->ToComment() != nullptr) continue;
    const XmlElement* element = node->ToElement();
    if (element != nullptr && element->Name() == std::string_view(name)) {
      fail(node->GetLineNum(), "there is more than one <{}> element", name);
    }
    fail(node->GetLineNum(), "expected nothing after </{}>, got {}", name,
         element != nullptr ? fmt::format("<{}>", element->Name()) : quoted_excerpt(node->Value()));
  }
  return *root;
}

void XmlReader::check_children(const XmlElement& element,
                               std::initializer_list<std::string_view> single,
                               std::initializer_list<std::string_view> repeated) {
  std::vector<std::string_view> known(single);
  known.insert(known.end(), repeated);
  for (const tinyxml2::XMLNode* node = element.FirstChild(); node; node = node->NextSibling()) {
    if (node->ToComment() != nullptr) continue;
    const XmlElement* child = node->ToElement();
    if (child == nullptr) {
      const std::string text =
          fmt::format("text {} in <{}>", quoted_excerpt(trimmed(node->Value())), element.Name());
      tolerate(node->GetLineNum(), text, "unexpected " + text);
    } else {
      check_child(element, *child, contains(single, child->Name()), known);
    }
  }
}

void XmlReader::check_child(const XmlElement& element, const XmlElement& child, bool is_single,
                            const std::vector<std::string_view>& known) {
  const std::string_view name = child.Name();
  const int line = child.GetLineNum();
  const std::string what = fmt::format("<{}> in <{}>", name, element.Name());
  // A document whose macros are not expanded lacks links; definitions that remain do no harm.
  const bool is_definition = name == "xacro:property" || name == "xacro:arg";
  if (name.starts_with("xacro:") && (is_strict() || !is_definition)) {
    fail(line,
         "unknown element {}; expected URDF, which xacro writes: xacro FILE.xacro > FILE.urdf",
         what);
  }
  if (std::ranges::find(known, name) == known.end()) {
    tolerate(line, "unknown element " + what,
             fmt::format("unknown element {}; expected one of: {}", what, fmt::join(known, ", ")));
  } else if (is_single && element.FirstChildElement(child.Name()) != &child) {
    tolerate(line, "a second " + what, "there is a second " + what);
  }
}

void XmlReader::check_attributes(const XmlElement& element,
                                 std::initializer_list<std::string_view> known) {
  for (const auto* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next()) {
    const std::string_view name = attribute->Name();
    if (contains(known, name) || name.starts_with("xmlns:")) continue;
    const std::string hint =
        did_you_mean(name, std::vector<std::string>(known.begin(), known.end()));
    tolerate(element.GetLineNum(),
             fmt::format("unknown attribute '{}' of <{}>{}", name, element.Name(), hint),
             fmt::format("<{}>: unknown attribute '{}'; expected one of: {}", element.Name(), name,
                         fmt::join(known, ", ")));
  }
}

const XmlElement& XmlReader::required_child(const XmlElement& element, const char* name) const {
  const XmlElement* child = element.FirstChildElement(name);
  if (child == nullptr) fail(element, "the element <{}> is missing", name);
  return *child;
}

std::string XmlReader::text(const XmlElement& element, const char* attribute) const {
  const char* value = element.Attribute(attribute);
  if (value == nullptr) fail(element, "attribute '{}' is missing", attribute);
  if (*value == '\0') fail(element, "'{}' is empty", attribute);
  if (!decode_utf8(value)) {
    fail(element, "{} is {}, which is not UTF-8; expected a file saved as UTF-8", attribute,
         quoted_excerpt(value));
  }
  return value;
}

double XmlReader::number_or_infinity(const XmlElement& element, const char* attribute) const {
  const std::string value = text(element, attribute);
  const auto fields = split_words(value);
  const auto result = fields.size() == 1 ? parse_xml_number(fields[0]) : std::nullopt;
  if (result) return *result;
  fail(element, "{} is {}, expected a finite number{}", attribute, quoted_excerpt(value),
       xacro_hint(value));
}

double XmlReader::number(const XmlElement& element, const char* attribute) const {
  const double value = number_or_infinity(element, attribute);
  if (std::isfinite(value)) return value;
  fail(element, "{} is {}, expected a finite number", attribute,
       quoted_excerpt(element.Attribute(attribute)));
}

double XmlReader::non_negative_number(const XmlElement& element, const char* attribute) const {
  const double value = number(element, attribute);
  if (value < 0) fail(element, "{} is {}, expected 0 or more", attribute, value);
  return value;
}

std::vector<double> XmlReader::numbers(const XmlElement& element, const char* attribute,
                                       std::initializer_list<std::size_t> counts,
                                       std::string_view expected) const {
  const std::string_view value = element.Attribute(attribute);
  std::vector<double> numbers;
  const auto fields = split_words(value);
  for (const std::string_view field : fields) {
    const auto number = parse_xml_number(field);
    if (number && std::isfinite(*number)) numbers.push_back(*number);
  }
  const bool is_count = std::ranges::find(counts, fields.size()) != counts.end();
  if (is_count && numbers.size() == fields.size()) return numbers;
  fail(element, "{} is {}, expected {}{}", attribute, quoted_excerpt(value), expected,
       xacro_hint(value));
}

Vec3 XmlReader::vector(const XmlElement& element, const char* attribute,
                       const Vec3& fallback) const {
  if (element.Attribute(attribute) == nullptr) return fallback;
  const auto n = numbers(element, attribute, {3}, "three finite numbers");
  return {n[0], n[1], n[2]};
}

namespace {

/// Roll, pitch and yaw. Roll is computed from the rotation after yaw, so that their sum is accurate
/// near a pitch of 90 degrees, where each alone is arbitrary.
Vec3 rpy_of(const Eigen::Matrix3d& r) {
  const double yaw = std::atan2(r(1, 0), r(0, 0));
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  const double c = std::cos(yaw), s = std::sin(yaw);
  const double roll = std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1));
  return {roll, pitch, yaw};
}

}  // namespace

std::string xml_vector(const Vec3& v) {
  // Adding zero makes a zero positive.
  return fmt::format("{} {} {}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

std::string xml_origin(const Transform& pose) {
  std::string attributes;
  if (!pose.translation.isZero(0)) {
    attributes += fmt::format(" xyz=\"{}\"", xml_vector(pose.translation));
  }
  const Vec3 rpy = rpy_of(pose.rotation);
  if (!rpy.isZero(0)) attributes += fmt::format(" rpy=\"{}\"", xml_vector(rpy));
  return attributes.empty() ? "" : "<origin" + attributes + "/>";
}

}  // namespace mneme::internal
