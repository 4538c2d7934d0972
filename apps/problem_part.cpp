// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "problem_part.h"

#include <charconv>

#include <fmt/format.h>

namespace mneme::app {
namespace {

struct Part {
  std::size_t first = 0;  ///< from 1
  std::size_t count = 0;
};

Result<Part> parse_part(const std::string& text) {
  Part part;
  const char* end = text.data() + text.size();
  const auto [slash, first_error] = std::from_chars(text.data(), end, part.first);
  bool is_part = first_error == std::errc{} && slash != end && *slash == '/';
  if (is_part) {
    const auto [rest, count_error] = std::from_chars(slash + 1, end, part.count);
    is_part =
        count_error == std::errc{} && rest == end && part.first >= 1 && part.first <= part.count;
  }
  if (is_part) return part;
  return fail(ErrorCode::invalid,
              fmt::format("'{}' is no part; expected I/N with 1 <= I <= N, such as 1/2", text));
}

}  // namespace

Result<std::vector<BenchProblem>> take_part(std::vector<BenchProblem> problems,
                                            const std::string& part) {
  if (part.empty()) return problems;
  const Result<Part> parsed = parse_part(part);
  if (!parsed) return tl::unexpected(parsed.error());
  std::vector<BenchProblem> taken;
  for (std::size_t i = parsed->first - 1; i < problems.size(); i += parsed->count) {
    taken.push_back(std::move(problems[i]));
  }
  return taken;
}

}  // namespace mneme::app
