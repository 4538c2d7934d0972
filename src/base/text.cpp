// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <utf8.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <system_error>
#include <utility>

namespace mneme::internal {

CodePoint first_code_point(std::string_view text) {
  const char* end = text.data();
  try {
    const char32_t value = utf8::next(end, text.data() + text.size());
    return value == 0 ? CodePoint{} : CodePoint{value, static_cast<std::size_t>(end - text.data())};
  } catch (const utf8::exception&) {
    return {};
  }
}

std::optional<std::u32string> decode_utf8(std::string_view text) {
  if (text.find('\0') != text.npos || !utf8::is_valid(text)) return std::nullopt;
  return utf8::utf8to32(text);
}

std::string escape_bytes(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t size = first_code_point(text).size;
    if (size == 0) {
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
    } else {
      result += text.substr(0, size);
    }
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return result;
}

#ifdef __cpp_lib_to_chars

std::from_chars_result number_from(const char* begin, const char* end, double& value) {
  return std::from_chars(begin, end, value);
}

#else

std::from_chars_result number_from(const char* begin, const char* end, double& value) {
  // strtod() reads more than from_chars(): spaces, a plus sign and hexadecimal digits.
  const auto is_of_number = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == '+';
  };
  std::string text(begin, std::find_if_not(begin, end, is_of_number));
  if (text.empty() || text.front() == '+') return {begin, std::errc::invalid_argument};
  const std::size_t x = text.find_first_of("xX");
  if (x != text.npos) text.resize(x);
  char* stop = nullptr;
  errno = 0;
  const double number = std::strtod(text.c_str(), &stop);
  if (stop == text.c_str()) return {begin, std::errc::invalid_argument};
  const char* const reached = begin + (stop - text.c_str());
  // Numbers below the least normal one are numbers, too.
  const bool is_out_of_range = number == 0 || std::isinf(number);
  if (errno == ERANGE && is_out_of_range) return {reached, std::errc::result_out_of_range};
  value = number;
  return {reached, std::errc()};
}

#endif

std::optional<double> parse_number_or_infinity(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = number_from(text.data(), end, value);
  if (stop != end || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc()) return value;
  return std::strtod(std::string(text).c_str(), nullptr);  // infinity, or about 0
}

namespace {
constexpr const char* kSpaces = " \t\r\n";
}  // namespace

std::vector<std::string_view> split_words(std::string_view text) {
  std::vector<std::string_view> words;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    words.push_back(text.substr(0, text.find_first_of(kSpaces)));
    text.remove_prefix(words.back().size());
  }
  return words;
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
  return text.substr(0, text.find_last_not_of(kSpaces) + 1);
}

std::string escape_csv(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  quoted += '"';
  return quoted;
}

std::string xml_escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '"') {
      result += "&quot;";
    } else if (c == '\'') {
      result += "&#39;";
    } else {
      result += c;
    }
  }
  return result;
}

namespace {

/// Elements and attributes: tinyxml2 takes some 100 bytes for each.
constexpr std::size_t kMostXmlParts = 2'000'000;
/// tinyxml2 takes quadratic time for the attributes of one element.
constexpr std::size_t kMostAttributes = 100;

/// Returns the position of the last byte of the comment, text or declaration that begins at
/// `begin`, or `begin` if a tag does; npos if it does not end.
std::size_t skip_no_tag(std::string_view text, std::size_t begin) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kOthers = {
      {{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}, {"<!", ">"}}};
  for (const auto& [open, close] : kOthers) {
    if (text.substr(begin).starts_with(open)) return text.find(close, begin + open.size());
  }
  return begin;
}

}  // namespace

std::string utc_text(std::time_t seconds) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(seconds));
}

std::string current_time() { return utc_text(std::time(nullptr)); }

std::string percent_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char byte = 0;
    const char* const digits = text.data() + i + 1;
    const bool is_code = text[i] == '%' && i + 2 < text.size() &&
                         std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2;
    decoded += is_code ? static_cast<char>(byte) : text[i];
    i += is_code ? 2 : 0;
  }
  return decoded;
}

std::optional<std::string> find_costly_xml(std::string_view text) {
  std::size_t parts = 0, attributes = 0;
  char quote = 0;
  bool is_in_tag = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (is_in_tag) {
      if (c == '"' || c == '\'') quote = c;
      if (c == '>') is_in_tag = false;
      parts += c == '=' ? 1 : 0;
      if (c == '=' && ++attributes > kMostAttributes) {
        return fmt::format("has an element with more than {} attributes", kMostAttributes);
      }
    } else if (c == '<') {
      ++parts;
      attributes = 0;
      i = skip_no_tag(text, i);
      if (i == text.npos) break;
      is_in_tag = text[i] == '<';
    }
  }
  if (parts <= kMostXmlParts) return std::nullopt;
  return fmt::format("has {} XML elements and attributes, expected at most {}", parts,
                     kMostXmlParts);
}

}  // namespace mneme::internal
