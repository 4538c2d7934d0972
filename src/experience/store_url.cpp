// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/store_url.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace mneme::internal {
namespace {

constexpr std::string_view kHidden = "***";

std::string scheme_of(const std::string& url) {
  const std::size_t end = url.find("://");
  if (end == std::string::npos) return "";
  const std::string scheme = url.substr(0, end);
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  return std::ranges::all_of(scheme, is_letter) ? scheme : "";
}

}  // namespace

Result<Engine> engine_of(const std::string& url) {
  const std::string scheme = scheme_of(url);
  if (scheme.empty()) return Engine::sqlite;
  if (scheme == "postgresql" || scheme == "postgres") return Engine::postgresql;
  return fail(ErrorCode::unsupported,
              fmt::format("{}: databases of kind '{}' are not supported; expected the path of an "
                          "SQLite file or postgresql://...",
                          without_password(url), scheme));
}

std::string without_password(const std::string& url) {
  std::string shown = url;
  const std::size_t scheme = shown.find("://");
  if (scheme == std::string::npos) return shown;
  const std::size_t begin = scheme + 3;
  // As libpq reads it: a question mark may stand in a password.
  const std::size_t host_end = std::min(shown.find('/', begin), shown.size());
  const std::size_t at = shown.rfind('@', host_end);
  const std::size_t colon = shown.find(':', begin);
  if (at != std::string::npos && at >= begin && colon < at) {
    shown.replace(colon + 1, at - colon - 1, kHidden);
  }
  constexpr std::string_view kKey = "password=";  // and with it sslpassword
  std::size_t found = shown.find(kKey);
  for (; found != std::string::npos; found = shown.find(kKey, found)) {
    found += kKey.size();
    const std::size_t end = std::min(shown.find('&', found), shown.size());
    shown.replace(found, end - found, kHidden);
  }
  return shown;
}

}  // namespace mneme::internal
