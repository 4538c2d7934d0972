// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/memory.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace mneme {
namespace internal {

// To add a kind: its file, which defines it, and its name in these two lists.
extern const MemoryKind kCirclePairs, kBodyPairs, kWholePaths, kGaps;

namespace {
constexpr std::array kMemoryKinds = {&kCirclePairs, &kBodyPairs, &kWholePaths, &kGaps};
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
              fmt::format("there is no kind of memory '{}'; expected one of: "
                          "{}{}",
                          name, fmt::join(known, ", "), did_you_mean(name, known)));
}

const MemoryKind* memory_kind_of(std::string_view version) {
  const auto found = std::ranges::find(memory_kinds(), version, &MemoryKind::version);
  return found == memory_kinds().end() ? nullptr : *found;
}

const MemoryKind& default_memory_kind(const Robot& robot) {
  return robot.is_planar() ? internal::kCirclePairs : internal::kBodyPairs;
}

const MemoryKind& default_kind_of_paths(const Robot& robot) {
  return robot.is_planar() ? internal::kCirclePairs : internal::kWholePaths;
}

Result<const MemoryKind*> choose_kind(const Robot& robot, const MemorySettings& settings) {
  if (settings.kind) return find_memory_kind(*settings.kind);
  return &default_memory_kind(robot);
}

Result<std::vector<LocalPrimitive>> decompose(const MemoryQuery& query,
                                              const MemorySettings& settings) {
  const auto kind = choose_kind(query.robot, settings);
  if (!kind) return tl::unexpected(kind.error());
  const double max_gap = settings.max_gap.value_or((*kind)->defaults.max_gap);
  if (!(max_gap >= 0)) {
    return fail(ErrorCode::invalid,
                fmt::format("max-gap is {}; expected metres, at least 0", max_gap));
  }
  return (*kind)->decompose(query, max_gap);
}

Result<std::vector<Experience>> learn_from_paths(const MemoryQuery& query,
                                                 std::span<const Path> paths,
                                                 const MemorySettings& settings, double reach) {
  const auto kind = choose_kind(query.robot, settings);
  if (!kind) return tl::unexpected(kind.error());
  // What a scene asks of a path and what a constraint asks of it could not be told apart later.
  if (!query.constraints.empty() && (*kind)->bend == nullptr) {
    return fail(ErrorCode::unsupported,
                fmt::format("memory of the kind '{}' knows no constraints: paths that keep some "
                            "teach it nothing",
                            (*kind)->name));
  }
  const double max_gap = settings.max_gap.value_or((*kind)->defaults.max_gap);
  return (*kind)->learn_from_paths(query, paths, max_gap, reach);
}

Result<std::vector<Match>> find_matches(const Database& database, const MemoryKind& kind,
                                        const LocalPrimitive& primitive, double threshold,
                                        int max_matches, std::int64_t* keys_left) {
  const std::vector<KeyImage> images = kind.images(primitive.key);
  std::vector<PrimitiveKey> keys;
  for (const KeyImage& image : images) keys.push_back(image.key);
  return database.find(kind.version, keys, threshold, max_matches, keys_left)
      .map([&](std::vector<KeyMatch> found) {
        std::vector<Match> matches;
        for (KeyMatch& match : found) {
          const Symmetry to_canonical{0, images[match.image].is_mirrored};
          matches.push_back({std::move(match.experience), match.similarity_error,
                             compose(primitive.to_scene, to_canonical)});
        }
        return matches;
      });
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
