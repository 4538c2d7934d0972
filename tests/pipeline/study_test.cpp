// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/planar_memory.h"
#include "support/write_lock.h"

namespace mneme::test {

TEST_SUITE("flow") {
  TEST_CASE("a study ends with an error where its rows cannot be stored, and keeps them queued") {
    const Problem problem = planar_problem("threaded_b4");
    const TemporaryDirectory directory;
    const std::string path = directory / "m.db";
    Database database =
        Database::open(path, make_signature(problem.robot), OpenMode::create).value();
    SolveSettings settings;
    settings.memory.kind = "paths";
    settings.plan.timeout_s = 2;
    REQUIRE(study(problem, database, settings));
    const std::int64_t before = database.size();
    CHECK(before > 0);
    {
      const WriteLock lock(path);
      settings.plan.seed = 7;
      const Error error = require_error(study(problem, database, settings));
      CHECK(error.code == ErrorCode::io);
      CHECK(contains(error.message, "rows are not stored yet"));
      CHECK(database.queued_rows().waiting > 0);
    }
    REQUIRE(database.flush());
    CHECK(database.size() > before);
  }
}

}  // namespace mneme::test
