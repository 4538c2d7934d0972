// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Whether experience applies.
#pragma once

#include "mneme/experience.h"

#include <string>

namespace mneme::internal {

/// What of a space matters to users, for messages.
[[nodiscard]] std::string describe(const ExperienceSpace& space);

/// True if experience of `a` is experience of `b`; names do not count.
[[nodiscard]] bool is_same_space(const ExperienceSpace& a, const ExperienceSpace& b);
/// Error: wrong_robot, because `url` holds experience of `found`.
[[nodiscard]] tl::unexpected<Error> refuse_space(const std::string& url,
                                                 const ExperienceSpace& found,
                                                 const ExperienceSpace& wanted);

}  // namespace mneme::internal
