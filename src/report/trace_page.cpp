// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/report.h"

#include "base/fail.h"
#include "report/markup.h"
#include "report/trace.h"

#include <nlohmann/json.hpp>

#include <array>

namespace mneme {
namespace internal {
namespace {

using PlainJson = nlohmann::json;

constexpr std::string_view kTitlePlace = "<!--mneme-title-->";
constexpr std::string_view kElementsPlace = "<!--mneme-elements-->";
constexpr std::string_view kTracePlace = "<!--mneme-trace-->";
constexpr int kMaxTraceDepth = 64;
/// The members that the page needs, with their types.
constexpr std::array<std::pair<const char*, PlainJson::value_t>, 15> kMembers = {{
    {"problem", PlainJson::value_t::string},
    {"robot", PlainJson::value_t::string},
    {"is_planar", PlainJson::value_t::boolean},
    {"joints", PlainJson::value_t::array},
    {"plan", PlainJson::value_t::object},
    {"times", PlainJson::value_t::object},
    {"links", PlainJson::value_t::array},
    {"obstacles", PlainJson::value_t::array},
    {"start", PlainJson::value_t::array},
    {"goals", PlainJson::value_t::array},
    {"waypoints", PlainJson::value_t::array},
    {"primitives", PlainJson::value_t::array},
    {"components", PlainJson::value_t::object},
    {"samples", PlainJson::value_t::object},
    {"edges", PlainJson::value_t::object},
}};

/// True if arrays and objects are nested more than kMaxTraceDepth deep. Writing JSON is recursive.
bool is_too_deep(std::string_view json) {
  int depth = 0;
  bool is_quoted = false;
  for (std::size_t i = 0; i < json.size() && depth <= kMaxTraceDepth; ++i) {
    const char c = json[i];
    if (is_quoted) {
      if (c == '\\') ++i;
      is_quoted = c != '"';
    } else if (c == '"') {
      is_quoted = true;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return depth > kMaxTraceDepth;
}

Result<PlainJson> parse_trace(std::string_view text, const std::string& source) {
  if (text.size() > kMaxTraceBytes) {
    return fail(ErrorCode::unsupported, "{}: expected a trace of at most {} bytes", source,
                kMaxTraceBytes);
  }
  if (is_too_deep(text)) {
    return fail(ErrorCode::unsupported, "{}: expected a trace nested at most {} deep", source,
                kMaxTraceDepth);
  }
  PlainJson json = PlainJson::parse(text, nullptr, false);
  if (json.is_discarded()) {
    return fail(ErrorCode::parse, "{}: not JSON; expected a trace of 'mneme plan --trace'", source);
  }
  const auto format = json.is_object() ? json.find("format") : json.end();
  if (!json.is_object() || format == json.end() || *format != "mneme-trace") {
    return fail(
        ErrorCode::parse,
        "{}: not a trace; expected \"format\": \"mneme-trace\", as 'mneme plan --trace' writes",
        source);
  }
  if (json.value("version", PlainJson()) != 1) {
    return fail(ErrorCode::unsupported, "{}: this trace has another version; expected 1", source);
  }
  for (const auto& [name, kind] : kMembers) {
    const auto member = json.find(name);
    if (member == json.end() || member->type() != kind) {
      return fail(ErrorCode::parse, "{}: expected a trace with \"{}\", of the type {}", source,
                  name, PlainJson(kind).type_name());
    }
  }
  return json;
}

/// Returns JSON that cannot end the script element around it.
std::string script_text(const PlainJson& json) {
  const std::string text = json.dump(-1, ' ', false, PlainJson::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string replaced(std::string_view text, std::string_view place, std::string_view with) {
  const std::size_t at = text.find(place);
  std::string result(text.substr(0, at));
  if (at == std::string_view::npos) return result;
  result += with;
  result += text.substr(at + place.size());
  return result;
}

/// Adds the second trace without the links and obstacles that both share.
Result<void> add_beside(PlainJson& trace, std::string_view text, const std::string& source) {
  PlainJson beside = MNEME_TRY(parse_trace(text, source + ", beside"));
  for (const char* key : {"robot", "joints", "is_planar"}) {
    if (trace[key] == beside[key]) continue;
    return fail(ErrorCode::invalid, "{}: the trace beside it is of another robot", source);
  }
  for (const char* key : {"links", "obstacles"}) {
    if (trace[key] == beside[key]) beside[key] = PlainJson::array();
  }
  trace["beside"] = std::move(beside);
  return {};
}

}  // namespace

Result<std::string> to_page_with(std::string_view elements, std::string_view json,
                                 const std::string& source, std::string_view beside) {
  PlainJson trace = MNEME_TRY(parse_trace(json, source));
  if (!beside.empty()) {
    MNEME_TRY(add_beside(trace, beside, source));
  }
  const std::string title = trace.at("problem").get<std::string>() + ", " +
                            trace.at("robot").get<std::string>() + " - mneme";
  // The trace comes last, so that its text is not searched for places.
  const std::string titled = replaced(viewer_page(), kTitlePlace, escape_markup(title));
  return replaced(replaced(titled, kElementsPlace, elements), kTracePlace, script_text(trace));
}

}  // namespace internal

Result<std::string> to_page(std::string_view json, const std::string& source,
                            std::string_view beside) {
  return internal::to_page_with("", json, source, beside);
}

}  // namespace mneme
