// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/database_check.h"

#include "store/row_check.h"

namespace mneme::internal {

Result<void> check_database(const Robot& robot, const SolveSettings& settings,
                            const Database& database) {
  const std::string& decomposer = settings.decompose.decomposer;
  const auto kind = decomposer_version(decomposer.empty() ? default_decomposer(robot) : decomposer);
  if (!kind) return tl::unexpected(kind.error());
  const ExperienceSpace wanted = make_space(robot);
  const ExperienceSpace& found = database.space();
  if (found.joint_count == 0 || is_same_space(found, wanted)) return {};
  return refuse_space(database.info().url, found, wanted);
}

}  // namespace mneme::internal
