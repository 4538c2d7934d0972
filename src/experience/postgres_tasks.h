// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Shared tasks in a table beside those of the database, drawn in docs/database.md.
#pragma once

#include "experience/task_queue.h"

namespace mneme::internal {

/// Makes the table if it is missing. `url` holds a database of `space`.
[[nodiscard]] Result<std::unique_ptr<TaskQueue>> open_postgres_tasks(const std::string& url,
                                                                     const ExperienceSpace& space,
                                                                     TaskOwner owner);

}  // namespace mneme::internal
