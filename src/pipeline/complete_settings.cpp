// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/complete_settings.h"

#include <array>

namespace mneme {
namespace {

/// What measures best for the samplers of one decomposer.
struct Defaults {
  std::string_view decomposer;
  double lambda, sigma, similarity;
  int max_matches;
  bool can_drop_invalid_means;
  int retrieve_after;
  double first_components;
};

constexpr std::array kDefaults = {
    Defaults{"pairs", 0.5, 0.05, 0.5, 8, true, 0, 0},
    Defaults{"body_pairs", 0.5, 0.3, 0.05, 8, false, 1500, 20},
    Defaults{"gaps", 0.5, 0.07, 0.03, 8, true, 1500, 0},
    Defaults{"paths", 0.7, 0.4, 1e9, 50, false, 2500, 20},
};

const Defaults& defaults_of(std::string_view decomposer) {
  for (const Defaults& defaults : kDefaults) {
    const std::size_t size = defaults.decomposer.size();
    const bool has_version = decomposer.size() > size && decomposer[size] == '/';
    if (decomposer.starts_with(defaults.decomposer) && (has_version || decomposer.size() == size)) {
      return defaults;
    }
  }
  return kDefaults.front();
}

}  // namespace

double default_similarity(std::string_view decomposer) {
  return defaults_of(decomposer).similarity;
}

int default_max_matches(std::string_view decomposer) { return defaults_of(decomposer).max_matches; }

namespace internal {
namespace {

/// The robot's own if there are rows of it, or else that of the first rows. Into an empty database
/// that only remembers, arms in space put whole paths.
std::string decomposer_of(const Database& database, const SolveSettings& settings,
                          const Robot& robot) {
  const std::vector<KindInfo> kinds = database.kinds();
  const bool only_remembers = settings.remember_after >= 0 && settings.learn_budget_s == 0;
  if (kinds.empty()) return only_remembers && !robot.is_planar() ? "paths" : "";
  std::string first;
  for (const KindInfo& kind : kinds) {
    const std::string known = decomposer_of_version(kind.kind).value_or("");
    if (known == default_decomposer(robot)) return known;
    if (first.empty()) first = known;
  }
  return first;
}

}  // namespace

SolveSettings complete_settings(SolveSettings settings, const Robot& robot,
                                const Database* database) {
  std::string& decomposer = settings.decompose.decomposer;
  if (decomposer.empty() && database != nullptr) {
    decomposer = decomposer_of(*database, settings, robot);
  }
  if (decomposer.empty()) decomposer = default_decomposer(robot);
  const Defaults& defaults = defaults_of(decomposer);
  if (settings.lambda < 0) settings.lambda = defaults.lambda;
  if (settings.sigma == 0) settings.sigma = defaults.sigma;
  if (settings.similarity == 0) settings.similarity = defaults.similarity;
  if (settings.max_matches < 0) settings.max_matches = defaults.max_matches;
  settings.drop_invalid_means &= defaults.can_drop_invalid_means;
  if (settings.retrieve_after < 0) settings.retrieve_after = defaults.retrieve_after;
  if (settings.first_components < 0) settings.first_components = defaults.first_components;
  return settings;
}

}  // namespace internal
}  // namespace mneme
