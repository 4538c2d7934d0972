// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/xml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>

namespace mneme::internal {
namespace {

constexpr std::size_t kMaxQuotedLength = 60;

/// `text` short enough for a message.
std::string in_quotes(std::string_view text) {
  const bool is_long = text.size() > kMaxQuotedLength;
  return fmt::format("'{}{}'", text.substr(0, kMaxQuotedLength), is_long ? "..." : "");
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> result;
  for (auto at = text.begin(); at != text.end();) {
    const auto begin = std::find_if_not(at, text.end(), is_space);
    at = std::find_if(begin, text.end(), is_space);
    if (begin != at) result.emplace_back(begin, at);
  }
  return result;
}

std::string_view trimmed(std::string_view text) {
  const auto is_other = [](char c) { return !is_space(c); };
  const auto begin = std::ranges::find_if(text, is_other);
  const auto end = std::find_if(text.rbegin(), std::make_reverse_iterator(begin), is_other).base();
  return {begin, end};
}

std::optional<double> parse_number(std::string_view word) {
  // XML allows a plus sign, which from_chars does not.
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_number = code == std::errc() && end == word.data() + word.size();
  return is_number && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// The name of tinyxml2's error, such as "mismatched element".
std::string describe(const tinyxml2::XMLDocument& document) {
  if (document.ErrorID() == tinyxml2::XML_ERROR_PARSING) return "an element that does not end";
  if (document.ErrorID() == tinyxml2::XML_ERROR_PARSING_TEXT) return "text that no tag follows";
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
  throw InputFailure{{code, place(line, what)}};
}

void XmlReader::fail(const XmlElement& element, std::string_view what, ErrorCode code) const {
  fail(element.GetLineNum(), fmt::format("<{}>: {}", element.Name(), what), code);
}

std::string XmlReader::place(int line, std::string_view what) const {
  const std::string context = context_.empty() ? "" : context_ + ": ";
  return fmt::format("{}:{}: {}{}", source_, std::max(line, 1), context, what);
}

const XmlElement& XmlReader::read_root(tinyxml2::XMLDocument& document, std::string_view text,
                                       const char* name) const {
  if (text.size() > kMaxRobotTextSize) fail(1, "the text is longer than 64 MB");
  const auto null = std::ranges::find(text, '\0');
  if (null != text.end()) {
    fail(1 + static_cast<int>(std::count(text.begin(), null, '\n')), "a null byte is no XML");
  }
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
    if (node->ToComment() == nullptr) {
      fail(node->GetLineNum(), "there is more than one <{}> element", name);
    }
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
      take_stray_text(element, *node);
      continue;
    }
    const std::string_view name = child->Name();
    if (std::ranges::find(known, name) == known.end()) {
      const bool is_xacro = name.starts_with("xacro:");
      fail(child->GetLineNum(), "unknown element <{}> in <{}>; expected {}", name, element.Name(),
           is_xacro ? "URDF, which xacro writes: xacro FILE.xacro > FILE.urdf"
                    : fmt::format("one of: {}", fmt::join(known, ", ")));
    }
    if (contains(single, name) && element.FirstChildElement(child->Name()) != child) {
      fail(child->GetLineNum(), "there is a second <{}> in <{}>", name, element.Name());
    }
  }
}

void XmlReader::take_stray_text(const XmlElement& element, const tinyxml2::XMLNode& text) {
  const std::string what = fmt::format("<{}>: text {} is not expected here", element.Name(),
                                       in_quotes(trimmed(text.Value())));
  if (stray_text_ == StrayText::fault) fail(text.GetLineNum(), what);
  warnings_.push_back(place(text.GetLineNum(), what + "; it is left aside"));
}

void XmlReader::check_attributes(const XmlElement& element,
                                 std::initializer_list<std::string_view> known) const {
  for (const auto* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next()) {
    if (contains(known, attribute->Name())) continue;
    fail(element, "unknown attribute '{}'; expected one of: {}", attribute->Name(),
         fmt::join(known, ", "));
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
  return value;
}

double XmlReader::number(const XmlElement& element, const char* attribute) const {
  const std::string value = text(element, attribute);
  const auto fields = words(value);
  const auto result = fields.size() == 1 ? parse_number(fields[0]) : std::nullopt;
  if (result) return *result;
  fail(element, "{} is {}, expected a finite number", attribute, in_quotes(value));
}

double XmlReader::positive_number(const XmlElement& element, const char* attribute) const {
  const double value = number(element, attribute);
  if (value <= 0) fail(element, "{} is {}, expected more than 0", attribute, value);
  return value;
}

double XmlReader::non_negative_number(const XmlElement& element, const char* attribute) const {
  const double value = number(element, attribute);
  if (value < 0) fail(element, "{} is {}, expected 0 or more", attribute, value);
  return value;
}

Vec3 XmlReader::vector(const XmlElement& element, const char* attribute,
                       const Vec3& fallback) const {
  const char* value = element.Attribute(attribute);
  if (value == nullptr) return fallback;
  std::vector<double> numbers;
  const auto fields = words(value);
  for (const std::string_view field : fields) {
    if (const auto number = parse_number(field)) numbers.push_back(*number);
  }
  if (fields.size() == 3 && numbers.size() == 3) return {numbers[0], numbers[1], numbers[2]};
  fail(element, "{} is {}, expected three finite numbers", attribute, in_quotes(value));
}

}  // namespace mneme::internal
