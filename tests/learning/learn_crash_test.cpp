// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/fixtures.h"
#include "support/exported.h"
#include "support/planar_memory.h"

#include <set>

namespace mneme::test {
namespace {

/// The ids of the rows that are safe by now.
std::set<std::int64_t> stored_ids(const std::string& path, const Robot& robot) {
  std::set<std::int64_t> ids;
  const Database database = make_database(path, robot, OpenMode::read_only);
  REQUIRE(database.for_each([&](const auto& row) { ids.insert(row->id); }).has_value());
  return ids;
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("learning that is killed again and again loses no row that was stored, and ends") {
    const std::uint64_t seed = 71;
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    const Robot robot = planar8();
    const int count = rounds(6);
    const auto keys = random_keys(8 * count, 66);
    Rng rng(seed);
    std::set<std::int64_t> stored;
    for (int round = 0; round < count; ++round) {
      const pid_t child = start_child([&] {
        const auto space = make_space(robot);
        auto database = Database::open(path, space, OpenMode::create);
        if (!database) return 1;
        LearnJob job;
        job.settings = cheap_settings();
        return learn_primitives(robot, keys, *database, job) ? 0 : 2;
      });
      spin(std::chrono::microseconds(1000 + rng.index(100000)));
      // What another process can read is safe.
      if (round % 2 == 1 && std::filesystem::exists(path)) {
        const std::set<std::int64_t> now = stored_ids(path, robot);
        stored.insert(now.begin(), now.end());
      }
      ::kill(child, SIGKILL);
      const int status = wait_for(child);
      INFO("seed " << seed << ", round " << round);
      REQUIRE((status == -1 || status == 0));
      if (!std::filesystem::exists(path)) continue;
      REQUIRE(verify_database(path)->empty());
      const std::set<std::int64_t> left = stored_ids(path, robot);
      REQUIRE(std::includes(left.begin(), left.end(), stored.begin(), stored.end()));
    }
    {
      Database database = make_database(path, robot);
      learn_into(database, robot, keys);
    }
    Database whole = make_database(directory / "whole.db", robot);
    learn_into(whole, robot, keys);
    CHECK(exported(path) == exported(directory / "whole.db"));
  }
}

}  // namespace mneme::test
