// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/database_check.h"

#include "experience/space.h"

namespace mneme::internal {

Result<void> check_database(const Robot& robot, const SolveSettings& settings,
                            const Database& database) {
  const auto wanted = make_space(robot, settings.decompose.decomposer);
  if (!wanted) return tl::unexpected(wanted.error());
  const ExperienceSpace& found = database.space();
  if (found.key_size == 0 || is_same_space(found, *wanted)) return {};
  return refuse_space(database.info().url, found, *wanted);
}

}  // namespace mneme::internal
