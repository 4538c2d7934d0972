// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "problem_part.h"

#include <fmt/format.h>

#include "shard.h"

namespace mneme::app {
namespace {

Result<Fraction> parse_part(const std::string& text) {
  const std::optional<Fraction> part = parse_fraction(text);
  if (part && part->index >= 1 && part->index <= part->count) return *part;
  return fail(ErrorCode::invalid,
              fmt::format("'{}' is no part; expected I/N with 1 <= I <= N, such as 1/2", text));
}

}  // namespace

Result<std::vector<BenchProblem>> take_part(std::vector<BenchProblem> problems,
                                            const std::string& part) {
  if (part.empty()) return problems;
  return parse_part(part).map(
      [&](const Fraction& taken) { return take_shard(std::move(problems), taken); });
}

}  // namespace mneme::app
