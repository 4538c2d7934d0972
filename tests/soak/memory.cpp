// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "soak/memory.h"

#include <span>

namespace mneme::soak {
namespace {

constexpr std::int64_t kMaxRows = 2000;

Result<void> insert(Database& database, std::vector<Experience> rows) {
  if (database.size() >= kMaxRows) return {};
  auto inserted = database.insert(std::move(rows));
  if (!inserted) return tl::unexpected(inserted.error());
  return {};
}

Result<Database> open(const Robot& robot, const std::string& path) {
  return Database::open(path, make_space(robot), OpenMode::create);
}

}  // namespace

Result<Memory> Memory::create(const Robot& robot, const std::string& directory) {
  auto pairs = open(robot, directory + "/" + robot.name() + "_pairs.db");
  if (!pairs) return tl::unexpected(pairs.error());
  auto paths = open(robot, directory + "/" + robot.name() + "_paths.db");
  if (!paths) return tl::unexpected(paths.error());
  return Memory(std::move(*pairs), std::move(*paths));
}

Result<void> Memory::remember(const Problem& problem, const Path& path) {
  const std::span<const Path> solved(&path, 1);
  auto kept = insert(paths_, learn_whole_paths(problem.robot, solved));
  if (!kept || problem.robot.is_planar()) return kept;
  auto rows = learn_from_paths(problem.robot, problem.scene, solved, {});
  if (!rows) return tl::unexpected(rows.error());
  return insert(pairs_, std::move(*rows));
}

}  // namespace mneme::soak
