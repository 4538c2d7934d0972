// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "soak/memory.h"

#include "support/kinds.h"

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
  return Database::open(path, make_signature(robot), OpenMode::create);
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
  const MemoryQuery query{problem.robot, problem.scene};
  const auto teach = [&](Database& database, const MemorySettings& kind) {
    return learn_from_paths(query, solved, kind).and_then([&](std::vector<Experience> rows) {
      return insert(database, std::move(rows));
    });
  };
  auto kept = teach(paths_, test::of_kind("paths"));
  return !kept || problem.robot.is_planar() ? kept : teach(pairs_, {});
}

}  // namespace mneme::soak
