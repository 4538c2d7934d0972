// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Kinds of memory by name, for tests.
#pragma once

#include "mneme/memory.h"

#include <string>
#include <string_view>
#include <vector>

namespace mneme::test {

inline const MemoryKind& kind_named(std::string_view name) {
  return *find_memory_kind(name).value();
}

/// Similarity error of two keys of the kind "pairs".
inline double pair_error(const PrimitiveKey& a, const PrimitiveKey& b) {
  return similarity_error(kind_named("pairs"), a, b);
}

inline MemorySettings of_kind(std::string name) { return {std::move(name), {}}; }

/// The rows of kind "paths" that solved paths become.
inline std::vector<Experience> learn_whole_paths(const Robot& robot, std::span<const Path> paths) {
  return learn_from_paths({robot, Scene{}}, paths, of_kind("paths")).value();
}

}  // namespace mneme::test
