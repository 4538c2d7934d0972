// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/memory.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>

namespace mneme {
namespace internal {

// To add a kind, define it in its own file and add its name to these two lists.
extern const MemoryKind kCirclePairs, kBodyPairs, kLocalMotions, kWholePaths;

namespace {

constexpr std::array kMemoryKinds = {&kCirclePairs, &kBodyPairs, &kLocalMotions, &kWholePaths};

template <class Value>
std::string default_text(const Value& value) {
  if constexpr (std::is_same_v<Value, bool>) {
    return value ? "on" : "off";
  } else {
    return value >= Value(1e9) ? "all" : fmt::format("{}", value);
  }
}

/// The default of one setting, and the default with escape walks where it differs.
template <class Value>
std::string share_text(const MemoryDefaults& defaults, Value (*read)(const MemoryShare&)) {
  const std::string text = default_text(read(defaults.share_for(false)));
  const std::string with_walks = default_text(read(defaults.share_for(true)));
  return text == with_walks ? text : fmt::format("{} ({} with walks)", text, with_walks);
}

struct DefaultEntry {
  std::string_view setting;
  std::string (*text)(const MemoryDefaults& defaults);
};

template <auto member>
std::string member_text(const MemoryDefaults& defaults) {
  return default_text(defaults.*member);
}

constexpr std::array kDefaults = {
    DefaultEntry{"lambda",
                 [](const MemoryDefaults& d) {
                   return share_text<double>(d, [](const MemoryShare& s) { return s.lambda; });
                 }},
    DefaultEntry{"least-lambda",
                 [](const MemoryDefaults& d) {
                   return share_text<double>(
                       d, [](const MemoryShare& s) { return s.least_lambda.value_or(s.lambda); });
                 }},
    DefaultEntry{"retrieve-after",
                 [](const MemoryDefaults& d) {
                   return share_text<int>(d, [](const MemoryShare& s) { return s.retrieve_after; });
                 }},
    DefaultEntry{"sigma", member_text<&MemoryDefaults::sigma>},
    DefaultEntry{"similarity", member_text<&MemoryDefaults::similarity>},
    DefaultEntry{"max-matches", member_text<&MemoryDefaults::max_matches>},
    DefaultEntry{"drop-invalid-means", member_text<&MemoryDefaults::drop_invalid_means>},
    DefaultEntry{"retarget", member_text<&MemoryDefaults::retarget>},
    DefaultEntry{"first-components", member_text<&MemoryDefaults::first_components>},
    DefaultEntry{"max-gap", member_text<&MemoryDefaults::max_gap>},
};

/// The kind of highest `rank` among those that support the robot.
const MemoryKind& best_for(const Robot& robot, int MemoryKind::*rank) {
  return **std::ranges::max_element(kMemoryKinds, {}, [&](const MemoryKind* kind) {
    return kind->handles(robot) ? kind->*rank : -1;
  });
}

}  // namespace
}  // namespace internal

std::span<const MemoryKind* const> memory_kinds() { return internal::kMemoryKinds; }

Result<const MemoryKind*> find_memory_kind(std::string_view name) {
  std::vector<std::string> known;
  for (const MemoryKind* kind : memory_kinds()) {
    if (kind->name == name) return kind;
    known.emplace_back(kind->name);
  }
  return fail(ErrorCode::invalid,
              fmt::format("there is no kind of memory '{}'; expected one of: {}{}", name,
                          fmt::join(known, ", "), did_you_mean(name, known)));
}

const MemoryKind* memory_kind_of(std::string_view version) {
  const auto found = std::ranges::find(memory_kinds(), version, &MemoryKind::version);
  return found == memory_kinds().end() ? nullptr : *found;
}

const MemoryKind& default_memory_kind(const Robot& robot) {
  return internal::best_for(robot, &MemoryKind::rank_for_scenes);
}

const MemoryKind& default_kind_of_paths(const Robot& robot) {
  return internal::best_for(robot, &MemoryKind::rank_for_paths);
}

std::vector<KindDefault> kind_defaults() {
  std::vector<KindDefault> rows;
  for (const internal::DefaultEntry& entry : internal::kDefaults) {
    KindDefault& row = rows.emplace_back(KindDefault{entry.setting, {}});
    for (const MemoryKind* kind : memory_kinds()) row.values.push_back(entry.text(kind->defaults));
  }
  return rows;
}

Result<const MemoryKind*> choose_kind(const Robot& robot, const MemorySettings& settings) {
  if (settings.kind) return find_memory_kind(*settings.kind);
  return &default_memory_kind(robot);
}

Result<std::vector<LocalPrimitive>> decompose(const MemoryQuery& query,
                                              const MemorySettings& settings) {
  const MemoryKind* const kind = MNEME_TRY(choose_kind(query.robot, settings));
  const double max_gap = settings.max_gap.value_or(kind->defaults.max_gap);
  if (!(max_gap >= 0)) {
    return fail(ErrorCode::invalid,
                fmt::format("max-gap is {}; expected metres, at least 0", max_gap));
  }
  return kind->decompose(query, max_gap);
}

Result<std::vector<Experience>> learn_from_paths(const MemoryQuery& query,
                                                 std::span<const Path> paths,
                                                 const MemorySettings& settings, double reach) {
  const MemoryKind* const kind = MNEME_TRY(choose_kind(query.robot, settings));
  // A waypoint may be due to an obstacle or to a constraint.
  if (!query.constraints.empty() && !kind->can_replay()) {
    return fail(ErrorCode::unsupported,
                fmt::format("memory of the kind '{}' does not support constraints; use the kind "
                            "'paths'",
                            kind->name));
  }
  return kind->learn_from_paths(query, paths, settings.max_gap.value_or(kind->defaults.max_gap),
                                reach);
}

Result<std::vector<Match>> find_matches(const Database& database, const MemoryKind& kind,
                                        const LocalPrimitive& primitive, const MatchLimits& limits,
                                        std::int64_t* keys_left) {
  std::vector<KeyImage> images = kind.images(primitive.key);
  if (!limits.mirror) std::erase_if(images, [](const auto& image) { return image.is_mirrored; });
  std::vector<PrimitiveKey> keys;
  for (const KeyImage& image : images) keys.push_back(image.key);
  auto found = MNEME_TRY(database.find(kind.version, keys, limits.similarity, limits.max_matches,
                                       keys_left, primitive.constraints));
  std::vector<Match> matches;
  for (KeyMatch& match : found) {
    // Skip rows whose type of content does not fit their kind.
    if (match.experience->is_path() != (kind.bend != nullptr)) continue;
    const Symmetry to_canonical{0, images[match.image].is_mirrored};
    matches.push_back({std::move(match.experience), match.similarity_error,
                       compose(primitive.to_scene, to_canonical)});
  }
  return matches;
}

double similarity_error(const MemoryKind& kind, const PrimitiveKey& a, const PrimitiveKey& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const KeyImage& image : kind.images(b)) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - image.key[i]) * (a[i] - image.key[i]);
    least = std::min(least, sum);
  }
  return least;
}

}  // namespace mneme
