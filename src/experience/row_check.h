// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What an experience must look like to be stored, and to be used once read.
#pragma once

#include "mneme/experience.h"

#include <optional>
#include <string>

namespace mneme::internal {

/// Numbers of a key beyond this cannot be metres; far larger ones would overflow the index's
/// distances.
inline constexpr double kMaxKeyMagnitude = 1e6;

/// Why `key` cannot be one of `key_size` numbers, or nothing if it can.
[[nodiscard]] std::optional<std::string> describe_key_flaw(const PrimitiveKey& key, int key_size);

/// Why `experience` cannot belong to `space` (sizes, values that are not finite, rows that do not
/// exist, texts that are not UTF-8), or nothing if it can. An empty sampler may have a joint count
/// of 0.
[[nodiscard]] std::optional<std::string> describe_flaw(const Experience& experience,
                                                       const ExperienceSpace& space);

}  // namespace mneme::internal
