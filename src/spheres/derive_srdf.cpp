// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/spheres.h"

#include "base/fail.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

namespace mneme {
namespace {

using Names = std::pair<std::string, std::string>;

/// Why pairs may touch: derived ones, and then those of `own` that are not among them.
std::vector<std::pair<Names, std::string>> with_reasons(const std::vector<AllowedPair>& derived,
                                                        const std::vector<Names>& own) {
  std::vector<std::pair<Names, std::string>> pairs;
  std::set<Names> known;
  const auto add = [&](const std::string& first, const std::string& second,
                       std::string_view reason) {
    if (!known.insert(std::minmax(first, second)).second) return;
    pairs.emplace_back(Names(first, second), reason);
  };
  for (const AllowedPair& pair : derived) add(pair.first, pair.second, to_string(pair.reason));
  for (const auto& [first, second] : own) add(first, second, "User");
  return pairs;
}

}  // namespace

Result<std::vector<std::string>> allow_derived_pairs(Robot::Parts& parts,
                                                     const PairSettings& settings) {
  return derive_allowed_pairs(parts, settings).map([&](const std::vector<AllowedPair>& derived) {
    const auto pairs = with_reasons(derived, parts.allowed_pairs.value_or(std::vector<Names>()));
    parts.allowed_pairs.emplace();
    std::vector<std::string> reasons;
    for (const auto& [names, reason] : pairs) {
      parts.allowed_pairs->push_back(names);
      reasons.push_back(reason);
    }
    return reasons;
  });
}

Result<DerivedSrdf> derive_srdf(const std::string& path, const RobotOptions& options,
                                const PairSettings& settings,
                                const SphereProgress& on_approximated) {
  const auto with_path = internal::naming(path);
  Robot::Parts parts = MNEME_TRY(read_robot(path, options));
  DerivedSrdf result;
  result.notes = parts.warnings;
  RobotSpheres made =
      MNEME_TRY(approximate_robot(std::move(parts), {}, on_approximated).map_error(with_path));
  std::ranges::move(made.notes, std::back_inserter(result.notes));
  result.reasons = MNEME_TRY(allow_derived_pairs(made.parts, settings).map_error(with_path));
  result.text = to_srdf(
      made.parts, result.reasons,
      fmt::format("Allowed pairs derived from {} samples by mneme robot srdf", settings.samples));
  return result;
}

}  // namespace mneme
