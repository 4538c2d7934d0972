// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A process's part in a job that several processes share.
#pragma once

#include "learning/lesson.h"

namespace mneme::internal {

/// learn_primitives() for a job that is shared. The lessons in their order are the job: processes
/// work together if they were given the same.
[[nodiscard]] Result<LearnSummary> learn_shared(const Robot& robot, std::span<const Lesson> lessons,
                                                Database& database, const LearnJob& job);

}  // namespace mneme::internal
