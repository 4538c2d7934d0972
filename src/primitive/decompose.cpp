// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/primitive.h"

#include "primitive/decomposers.h"

#include <fmt/format.h>

#include <array>

namespace mneme {
namespace {

constexpr std::array kDecomposers = {
    internal::Decomposer{"pairs", "pairs/1", 6, internal::decompose_into_pairs},
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
  const auto decomposer = internal::find_decomposer(settings.decomposer);
  if (!decomposer) return tl::unexpected(decomposer.error());
  if (!(settings.max_gap >= 0)) {
    return fail(ErrorCode::invalid,
                fmt::format("max-gap is {}; expected metres, at least 0", settings.max_gap));
  }
  return (*decomposer)->decompose(robot, scene, settings);
}

Result<std::string> decomposer_version(const std::string& decomposer) {
  return internal::find_decomposer(decomposer).map([](const internal::Decomposer* found) {
    return std::string(found->version);
  });
}

}  // namespace mneme
