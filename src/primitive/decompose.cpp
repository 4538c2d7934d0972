// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/primitive.h"

#include "primitive/decomposers.h"

#include <fmt/format.h>

#include <array>

namespace mneme {
namespace {

Result<std::vector<LocalPrimitive>> refuse_scene(const Robot&, const Scene& scene,
                                                 const DecomposeSettings&) {
  return fail(ErrorCode::invalid,
              fmt::format("scene '{}': memory of whole paths needs a problem with start and goal",
                          scene.name));
}

constexpr std::array kDecomposers = {
    internal::Decomposer{"pairs", "pairs/1", 6, 1.0, internal::decompose_into_circle_pairs},
    internal::Decomposer{"body_pairs", "body_pairs/1", 2 * kBodyKeySize, 0.25,
                         internal::decompose_into_body_pairs},
    internal::Decomposer{"paths", "paths/1", internal::kSizeOfRobot, 1.0, refuse_scene},
    internal::Decomposer{"gaps", "gaps/1", kGapKeySize, 0.25, internal::decompose_into_gaps},
};

}  // namespace

Result<const internal::Decomposer*> internal::find_decomposer(std::string_view name) {
  std::string known;
  for (const Decomposer& decomposer : kDecomposers) {
    if (decomposer.name == name) return &decomposer;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", decomposer.name);
  }
  return fail(ErrorCode::invalid,
              fmt::format("there is no decomposer '{}'; expected one of: {}", name, known));
}

Result<std::vector<LocalPrimitive>> decompose(const Robot& robot, const Scene& scene,
                                              const DecomposeSettings& settings) {
  const auto decomposer = internal::find_decomposer(
      settings.decomposer.empty() ? default_decomposer(robot) : settings.decomposer);
  if (!decomposer) return tl::unexpected(decomposer.error());
  if (!(settings.max_gap >= 0)) {
    return fail(ErrorCode::invalid,
                fmt::format("max-gap is {}; expected metres, at least 0", settings.max_gap));
  }
  DecomposeSettings complete = settings;
  if (complete.max_gap == 0) complete.max_gap = (*decomposer)->default_gap;
  return (*decomposer)->decompose(robot, scene, complete);
}

std::vector<std::string> decomposer_names() {
  std::vector<std::string> names;
  for (const internal::Decomposer& decomposer : kDecomposers) names.emplace_back(decomposer.name);
  return names;
}

std::optional<std::string> decomposer_of_version(std::string_view version) {
  for (const internal::Decomposer& decomposer : kDecomposers) {
    if (decomposer.version == version) return std::string(decomposer.name);
  }
  return std::nullopt;
}

std::string default_decomposer(const Robot& robot) {
  return robot.is_planar() ? "pairs" : "body_pairs";
}

Result<std::string> decomposer_version(const std::string& decomposer) {
  return internal::find_decomposer(decomposer).map([](const internal::Decomposer* found) {
    return std::string(found->version);
  });
}

}  // namespace mneme
