// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/fixtures.h"
#include "support/exported.h"
#include "support/planar_memory.h"

#include <atomic>
#include <set>

namespace mneme::test {
namespace {

LearnJob cheap_job(std::uint64_t seed = 1, int jobs = 1) {
  LearnJob job;
  job.settings = cheap_settings();
  job.seed = seed;
  job.jobs = jobs;
  return job;
}

std::vector<PrimitiveKey> keys_of(const Database& database) {
  std::vector<PrimitiveKey> keys;
  for (std::int64_t i = 0; i < database.size(); ++i) keys.push_back(database.get(i)->key);
  return keys;
}

/// Checks that two databases hold the same, except the time of their rows.
void check_same_contents(const Database& a, const Database& b) {
  REQUIRE(a.size() == b.size());
  for (std::int64_t i = 0; i < a.size(); ++i) {
    CHECK(a.get(i)->key == b.get(i)->key);
    CHECK(is_same_mixture(a.get(i)->sampler(), b.get(i)->sampler()));
    CHECK(a.get(i)->provenance.seed == b.get(i)->provenance.seed);
    CHECK(a.get(i)->provenance.settings == b.get(i)->provenance.settings);
    CHECK(a.get(i)->provenance.tool == b.get(i)->provenance.tool);
  }
}

/// The ids of the rows that are safe by now.
std::set<std::int64_t> stored_ids(const std::string& path, const Robot& robot) {
  std::set<std::int64_t> ids;
  const Database database = make_database(path, robot, OpenMode::read_only);
  require(database.for_each([&](const auto& row) { ids.insert(row->id); }));
  return ids;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("what is learned does not depend on the number of threads") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    const auto keys = random_keys(50, 41);
    Database one = make_database(directory / "one.db", robot);
    Database three = make_database(directory / "three.db", robot);
    const LearnSummary summary = require(learn_primitives(robot, keys, one, cheap_job(1, 1)));
    const LearnSummary same = require(learn_primitives(robot, keys, three, cheap_job(1, 3)));
    CHECK(summary.learned == 50);
    CHECK(summary.skipped == 0);
    CHECK(!summary.is_cancelled);
    CHECK(summary.components == one.info().components);
    CHECK(same.learned == summary.learned);
    CHECK(same.components == summary.components);
    CHECK(same.empty == summary.empty);
    CHECK(keys_of(one) == keys);
    check_same_contents(one, three);
  }

  TEST_CASE("a row can be learned again from what it says about itself") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    const LearnSummary summary =
        require(learn_primitives(robot, random_keys(10, 42), database, cheap_job()));
    int empty = 0;
    for (std::int64_t i = 0; i < database.size(); ++i) {
      const Experience row = *database.get(i);
      CHECK(row.provenance.settings == describe(cheap_settings()));
      CHECK(row.provenance.tool == "mneme " + std::string(version()));
      CHECK(!row.provenance.time.empty());
      const LearnResult again = learn(robot, row.key, cheap_settings(), row.provenance.seed);
      CHECK(again.sampler.means == row.sampler().means);
      empty += row.sampler().component_count() == 0;
    }
    CHECK(summary.empty == empty);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a lesson's seed depends on the job's seed and on every number of the key") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    std::vector<PrimitiveKey> keys(7, near_pair());
    for (std::size_t i = 0; i < 6; ++i) keys[i][i] += 1e-12;
    LearnJob job = cheap_job(1);
    CHECK(require(learn_primitives(robot, keys, database, job)).learned == 7);
    job.seed = 2;
    CHECK(require(learn_primitives(robot, keys, database, job)).learned == 7);
    std::set<std::uint64_t> seeds;
    for (std::int64_t i = 0; i < database.size(); ++i) {
      seeds.insert(database.get(i)->provenance.seed);
    }
    CHECK(seeds.size() == 14);
    Database other = make_database(directory / "b.db", robot);
    require(learn_primitives(robot, std::span(&keys[4], 1), other, job));
    CHECK(other.get(0)->provenance.seed == database.get(11)->provenance.seed);
  }

  TEST_CASE("a cancelled job goes on where it was") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    const auto keys = random_keys(40, 43);
    std::atomic<bool> is_cancelled = false;
    LearnJob job;
    job.settings.paths_per_start = 4;
    job.jobs = 2;
    job.cancel = &is_cancelled;
    std::vector<LearnProgress> progress;
    job.on_progress = [&](const LearnProgress& latest) {
      progress.push_back(latest);
      is_cancelled = latest.done > 0;
    };
    std::int64_t done = 0;
    {
      Database database = make_database(directory / "a.db", robot);
      const LearnSummary summary = require(learn_primitives(robot, keys, database, job));
      CHECK(summary.is_cancelled);
      done = database.size();
      CHECK(summary.learned == done);
    }
    CHECK(done > 0);
    REQUIRE(!progress.empty());
    for (const LearnProgress& latest : progress) {
      CHECK(latest.total == 40);
      CHECK(latest.done <= 40);
      CHECK(latest.elapsed_s > 0);
    }
    CHECK(progress.back().done == done);

    is_cancelled = false;
    job.on_progress = {};
    Database database = make_database(directory / "a.db", robot, OpenMode::read_write);
    const LearnSummary rest = require(learn_primitives(robot, keys, database, job));
    CHECK(!rest.is_cancelled);
    CHECK(rest.skipped == done);
    CHECK(rest.learned == 40 - done);
    CHECK(keys_of(database) == keys);
  }

  TEST_CASE("a job that is cancelled before it begins learns nothing") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    const std::atomic<bool> is_cancelled = true;
    LearnJob job = cheap_job(1, 2);
    job.cancel = &is_cancelled;
    const LearnSummary summary =
        require(learn_primitives(robot, random_keys(5, 44), database, job));
    CHECK(summary.is_cancelled);
    CHECK(summary.learned == 0);
    CHECK(database.size() == 0);
  }

  TEST_CASE("another seed or other settings add, the same ones do not") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    const auto keys = random_keys(6, 45);
    CHECK(require(learn_primitives(robot, keys, database, cheap_job(1))).learned == 6);
    CHECK(require(learn_primitives(robot, keys, database, cheap_job(1))).skipped == 6);
    CHECK(database.size() == 6);
    CHECK(require(learn_primitives(robot, keys, database, cheap_job(2))).learned == 6);
    LearnJob richer = cheap_job(1);
    richer.settings.starts_per_link = 2;
    CHECK(require(learn_primitives(robot, keys, database, richer)).learned == 6);
    CHECK(require(learn_primitives(robot, keys, database, richer)).skipped == 6);
    CHECK(database.size() == 18);
    std::set<std::vector<float>> different;
    for (std::int64_t i = 0; i < database.size(); ++i) {
      different.insert(database.get(i)->sampler().means);
    }
    CHECK(different.size() == 18);
  }

  TEST_CASE("a longer list learns only what is new in it, a key that is doubled only once") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    auto keys = random_keys(8, 46);
    const std::vector<PrimitiveKey> some(keys.begin() + 2, keys.begin() + 5);
    CHECK(require(learn_primitives(robot, some, database, cheap_job())).learned == 3);
    keys.push_back(keys[0]);
    const LearnSummary summary = require(learn_primitives(robot, keys, database, cheap_job()));
    CHECK(summary.learned == 5);
    CHECK(summary.skipped == 4);
    CHECK(database.size() == 8);
    // A primitive's sampler does not depend on its place in a list.
    Database other = make_database(directory / "b.db", robot);
    require(learn_primitives(robot, some, other, cheap_job()));
    CHECK(is_same_mixture(other.get(1)->sampler(), database.get(1)->sampler()));
  }

  TEST_CASE("what takes long to learn is stored after a second, however little it is") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    LearnJob job = cheap_job();
    job.settings.paths_per_start = 200;
    std::atomic<bool> is_cancelled = false;
    job.cancel = &is_cancelled;
    std::int64_t stored = 0;
    job.on_progress = [&](const LearnProgress& latest) {
      if (!is_cancelled) stored = make_database(directory / "a.db", robot).size();
      is_cancelled = latest.done > 0;
    };
    // Fewer than make a transaction.
    const LearnSummary summary =
        require(learn_primitives(robot, random_keys(30, 49), database, job));
    CHECK(summary.is_cancelled);
    CHECK(summary.learned < 30);
    CHECK(stored > 0);
  }

  TEST_CASE("no keys are no work") {
    const Robot robot = planar8();
    const TemporaryDirectory directory;
    Database database = make_database(directory / "a.db", robot);
    LearnJob job = cheap_job();
    int calls = 0;
    job.on_progress = [&](const LearnProgress& latest) {
      ++calls;
      CHECK(latest.total == 0);
    };
    CHECK(require(learn_primitives(robot, {}, database, job)).learned == 0);
    CHECK(calls == 1);
  }

  TEST_CASE("a robot that is no planar arm is an error and leaves the database empty") {
    const TemporaryDirectory directory;
    const Robot robot = upright_arm();
    const RobotSignature space = {robot.name(), "", robot.hash(), 1};
    auto database = require(Database::open(directory / "a.db", space, OpenMode::create));
    const Error error =
        require_error(learn_primitives(robot, random_keys(5, 47), database, cheap_job(1, 2)));
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(database.size() == 0);
  }

  TEST_CASE("a database that cannot take the rows is an error") {
    const TemporaryDirectory directory;
    const Robot robot = planar8();
    Database small = make_database(directory / "small.db", planar_arm({1, 1}));
    const Error error =
        require_error(learn_primitives(robot, random_keys(3, 48), small, cheap_job()));
    CHECK(error.code == ErrorCode::wrong_robot);
    CHECK(small.size() == 0);

    write_file(directory / "a.db", "");
    make_database(directory / "a.db", robot);
    Database reader = make_database(directory / "a.db", robot, OpenMode::read_only);
    const Error refused =
        require_error(learn_primitives(robot, random_keys(3, 48), reader, cheap_job()));
    CHECK(refused.code == ErrorCode::io);
    CHECK(contains(refused.message, "a.db"));
  }
}

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
        const auto space = make_signature(robot);
        auto database = Database::open(path, space, OpenMode::create);
        if (!database) return 1;
        LearnJob job;
        job.settings = cheap_settings();
        return learn_primitives(robot, keys, *database, job) ? 0 : 2;
      });
      spin(std::chrono::microseconds(1000 + rng.index(100000)));
      // Rows that another process can read are safe.
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
