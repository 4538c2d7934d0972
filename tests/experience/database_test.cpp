// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/fixtures.h"
#include "engines/sqlite_connection.h"
#include "support/kinds.h"

#include <atomic>
#include <limits>
#include <thread>

namespace mneme::test {
namespace {}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("what is inserted can be read at once and after the next opening") {
    const TemporaryDirectory directory;
    Rng rng(51);
    auto rows = random_rows(rng, 7);
    rows[3].sampler() = {};
    {
      Database database = open_database(directory / "a.db");
      CHECK(database.size() == 0);
      CHECK(database.insert(rows) == std::vector<std::int64_t>{1, 2, 3, 4, 5, 6, 7});
      rows.push_back(random_experience(rng));
      CHECK(database.insert({rows[7]}) == std::vector<std::int64_t>{8});
      CHECK(database.size() == 8);
    }
    rows[3].sampler().joint_count = 3;
    for (const OpenMode mode : {OpenMode::read_only, OpenMode::read_write, OpenMode::create}) {
      const Database database = open_database(directory / "a.db", mode);
      REQUIRE(database.size() == 8);
      for (int i = 0; i < 8; ++i) {
        CHECK(database.get(i)->id == i + 1);
        CHECK(is_same_content(*database.get(i), rows[static_cast<std::size_t>(i)]));
      }
    }
  }

  TEST_CASE("a position that no row has is an error") {
    const TemporaryDirectory directory;
    Database database = open_database(directory / "a.db");
    Rng rng(4);
    require(database.insert(random_rows(rng, 3)));
    for (const std::int64_t position : {std::int64_t{-1}, std::int64_t{3}, std::int64_t{1} << 40}) {
      const Error error = require_error(database.get(position));
      CHECK(error.code == ErrorCode::invalid);
      CHECK(contains(error.message, "a.db"));
    }
  }

  TEST_CASE("info counts samplers, components and bytes") {
    const TemporaryDirectory directory;
    Rng rng(52);
    Database database = open_database(directory / "a.db");
    REQUIRE(database.insert(random_rows(rng, 3, 5)));
    const DatabaseInfo info = database.info();
    CHECK(info.url == directory / "a.db");
    CHECK(info.samplers == 3);
    CHECK(info.components == 15);
    CHECK(info.bytes > 8192);
    CHECK(info.schema_version == 4);
    CHECK(info.generation == 1);
    CHECK(info.tombstones == 0);
    CHECK(info.signature.robot_name == "arm");
  }

  TEST_CASE("the time of insertion is filled in unless it is given") {
    const TemporaryDirectory directory;
    Rng rng(53);
    auto rows = random_rows(rng, 2);
    rows[1].provenance.time.clear();
    Database database = open_database(directory / "a.db");
    REQUIRE(database.insert(rows));
    CHECK(database.get(0)->provenance.time == "2020-01-02T03:04:05Z");
    const std::string time = database.get(1)->provenance.time;
    REQUIRE(time.size() == 20);
    CHECK(time.starts_with("20"));
    CHECK(time[10] == 'T');
    CHECK(time[19] == 'Z');
  }

  TEST_CASE("rows that do not fit are refused, and with them the whole batch") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    Rng rng(54);
    Database database = open_database(directory / "a.db");
    auto rows = random_rows(rng, 3);
    rows[2].key[0] = std::numeric_limits<double>::quiet_NaN();
    const Error error = require_error(database.insert(rows));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(contains(error.message, "row 2 of 3"));
    CHECK(database.size() == 0);
    CHECK(open_database(directory / "a.db", OpenMode::read_only).size() == 0);
  }

  TEST_CASE("a database that was opened for reading refuses rows") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    Rng rng(55);
    open_database(directory / "a.db");
    Database database = open_database(directory / "a.db", OpenMode::read_only);
    const Error error = require_error(database.insert(random_rows(rng, 1)));
    CHECK(error.code == ErrorCode::io);
    CHECK(contains(error.message, "reading only"));
  }

  TEST_CASE("the database of another robot is refused with both names and hashes") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    open_database(directory / "a.db");
    RobotSignature other = arm_signature();
    other.robot_name = "panda";
    other.model_hash = "fedcba9876543210";
    const Error error = open_error(directory / "a.db", OpenMode::read_write, other);
    CHECK(error.code == ErrorCode::wrong_robot);
    for (const char* part : {"'arm'", "0123456789abcdef", "'panda'", "fedcba9876543210"}) {
      CHECK_MESSAGE(contains(error.message, part), error.message);
    }
  }

  TEST_CASE("each part of the space but the robot's name decides whether a database fits") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    open_database(directory / "a.db");
    RobotSignature other = arm_signature();
    other.robot_name = "the same arm by another name";
    CHECK(Database::open(directory / "a.db", other, OpenMode::read_write).has_value());
    const std::vector<std::function<void(RobotSignature&)>> changes = {
        [](RobotSignature& s) { s.model_hash = "0"; },
        [](RobotSignature& s) { s.joint_count = 4; }};
    for (const auto& change : changes) {
      other = arm_signature();
      change(other);
      CHECK(open_error(directory / "a.db", OpenMode::create, other).code == ErrorCode::wrong_robot);
    }
  }

  TEST_CASE("a missing file is an error unless it may be created") {
    const TemporaryDirectory directory;
    CHECK(open_error(directory / "a.db", OpenMode::read_only).code == ErrorCode::io);
    CHECK(open_error(directory / "a.db", OpenMode::read_write).code == ErrorCode::io);
    CHECK(!std::filesystem::exists(directory / "a.db"));
    CHECK(!Database::inspect(directory / "a.db").has_value());
  }

  TEST_CASE("a database in which nothing is stored leaves no file") {
    const TemporaryDirectory directory;
    {
      Database database = open_database(directory / "a.db");
      CHECK(database.size() == 0);
      CHECK(database.refresh() == 0);
      CHECK(database.info().schema_version == 0);
      CHECK(!database.insert({Experience{}}).has_value());
    }
    CHECK(std::filesystem::is_empty(directory / ""));
    CHECK(open_error(directory / "none/a.db", OpenMode::create).code == ErrorCode::io);
  }

  TEST_CASE("of two that create one database the second sees the rows of the first") {
    const TemporaryDirectory directory;
    Rng rng(52);
    Database first = open_database(directory / "a.db"), second = open_database(directory / "a.db");
    RobotSignature other = arm_signature();
    other.model_hash = "other";
    auto stranger = require(Database::open(directory / "a.db", other, OpenMode::create));
    REQUIRE(first.insert(random_rows(rng, 2)));
    CHECK(first.info().schema_version == 4);
    REQUIRE(second.insert(random_rows(rng, 3)));
    CHECK(second.size() == 5);
    CHECK(first.refresh() == 3);
    CHECK(stranger.insert(random_rows(rng, 1)).error().code == ErrorCode::wrong_robot);
  }

  TEST_CASE("a lesson is finished while all of its rows are there, also those stored before") {
    const TemporaryDirectory directory;
    Rng rng(53);
    auto rows = random_rows(rng, 3);
    rows[0].provenance.lesson = rows[1].provenance.lesson = 7;
    {
      Database database = open_database(directory / "a.db");
      CHECK(database.finished_lessons()->empty());
      REQUIRE(database.insert(rows));
      CHECK(*database.finished_lessons() == std::unordered_set<std::uint64_t>{7});
      rows[2].provenance.lesson = std::uint64_t{1} << 63;
      REQUIRE(database.insert({rows[2]}));
      CHECK(database.size() == 3);
      CHECK(database.finished_lessons()->size() == 2);
    }
    REQUIRE(merge_databases(directory / "b.db", directory / "a.db"));
    CHECK(open_database(directory / "b.db").finished_lessons()->size() == 2);
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1 WHERE id = 2");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
    CHECK(*open_database(directory / "a.db").finished_lessons() ==
          std::unordered_set<std::uint64_t>{std::uint64_t{1} << 63});
  }

  TEST_CASE("queued rows are stored by themselves, at the latest when the database is closed") {
    const TemporaryDirectory directory;
    Rng rng(54);
    {
      Database database = open_database(directory / "a.db");
      CHECK(!database.insert_later({Experience{}}).has_value());
      for (int i = 0; i < 20; ++i) REQUIRE(database.insert_later(random_rows(rng, 1)));
      REQUIRE(database.flush());
      CHECK(database.size() == 20);
      CHECK(database.queued_rows().stored == 20);
      CHECK(database.queued_rows().waiting == 0);
      REQUIRE(database.insert_later(random_rows(rng, 5)));
    }
    CHECK(open_database(directory / "a.db", OpenMode::read_only).size() == 25);
  }

  TEST_CASE("rows that are refused once they are made lose no others") {
    const TemporaryDirectory directory;
    Rng rng(55);
    Database database = open_database(directory / "a.db");
    const auto make = [&](std::vector<Experience> rows) {
      return database.insert_later([rows](const std::atomic<bool>& stop) {
        CHECK(!stop);
        return Result<std::vector<Experience>>(rows);
      });
    };
    REQUIRE(make(random_rows(rng, 2)));
    REQUIRE(make({Experience{}}));
    REQUIRE(make(random_rows(rng, 3)));
    REQUIRE(database.flush());
    CHECK(database.size() == 5);
    CHECK(database.queued_rows().stored == 5);
    CHECK(database.queued_rows().lost == 1);
  }

  TEST_CASE("rows in the making are given up once the database need not wait") {
    const TemporaryDirectory directory;
    Database database = open_database(directory / "a.db");
    REQUIRE(database.insert_later([](const std::atomic<bool>& stop) {
      while (!stop) std::this_thread::yield();
      return Result<std::vector<Experience>>(
          tl::unexpected(Error{ErrorCode::io, "the database is closed"}));
    }));
    CHECK(!database.flush(0.01).has_value());
    database.stop_waiting();
    REQUIRE(database.flush());
    CHECK(database.queued_rows().lost == 1);
    Rng rng(58);
    const Error error = require_error(database.insert_later(random_rows(rng, 1)));
    CHECK(error.code == ErrorCode::io);
    CHECK(contains(error.message, "takes no more rows"));
    CHECK(database.queued_rows().waiting == 0);
  }

  TEST_CASE("nothing waits for a lock of another process once the database need not wait") {
    const TemporaryDirectory directory;
    Rng rng(57);
    Database database = open_database(directory / "a.db");
    REQUIRE(database.insert(random_rows(rng, 1)));
    internal::Connection other = require(
        internal::Connection::open(directory / "a.db", internal::Connection::Access::read_write));
    const auto lock =
        require(internal::Transaction::begin(other, internal::Transaction::Kind::write));
    REQUIRE(database.insert_later(random_rows(rng, 1)));
    CHECK(contains(require_error(database.flush(0.01)).message,
                   ": 1 rows are not stored yet: the first attempt has not ended"));
    database.stop_waiting();
    const Stopwatch stopwatch;
    const Error error = require_error(database.insert(random_rows(rng, 1)));
    CHECK(error.code == ErrorCode::io);
    CHECK(contains(error.message, "locked by another process"));
    // It waited ten seconds for the lock.
    CHECK(stopwatch.elapsed_s() < 5);
  }

  TEST_CASE("an empty file counts as an empty database") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    CHECK(open_database(directory / "a.db", OpenMode::read_only).size() == 0);
    CHECK(std::filesystem::file_size(directory / "a.db") == 0);
    CHECK(Database::inspect(directory / "a.db")->info().schema_version == 0);
    CHECK(verify_database(directory / "a.db")->empty());
    Rng rng(56);
    REQUIRE(open_database(directory / "a.db", OpenMode::read_write).insert(random_rows(rng, 1)));
    CHECK(open_database(directory / "a.db", OpenMode::read_only).size() == 1);
  }

  TEST_CASE("inspecting shows a database of any robot") {
    const TemporaryDirectory directory;
    Rng rng(57);
    REQUIRE(open_database(directory / "a.db").insert(random_rows(rng, 2)));
    const auto database = require(Database::inspect(directory / "a.db"));
    CHECK(database.signature().model_hash == "0123456789abcdef");
    CHECK(database.size() == 2);
  }

  TEST_CASE("a space without joints cannot have a database") {
    const TemporaryDirectory directory;
    const Error error = open_error(directory / "a.db", OpenMode::create, RobotSignature{});
    CHECK(error.code == ErrorCode::invalid);
    CHECK(!std::filesystem::exists(directory / "a.db"));
  }

  TEST_CASE("matches stay valid while rows are added and the database is moved") {
    const TemporaryDirectory directory;
    Rng rng(58);
    Database first = open_database(directory / "a.db");
    const Experience row = random_experience(rng);
    REQUIRE(first.insert({row}));
    const auto matches = *find_like(first, make_primitive(row.key), 0.1, 1);
    REQUIRE(matches.size() == 1);
    REQUIRE(first.insert(random_rows(rng, 2000, 1)));
    const Database second = std::move(first);
    CHECK(matches[0].experience->id == second.get(0)->id);
    CHECK(is_same_content(*matches[0].experience, row));
  }

  TEST_CASE("a key of another size, or of a kind that is not there, matches nothing") {
    const TemporaryDirectory directory;
    Rng rng(59);
    Database database = open_database(directory / "a.db");
    REQUIRE(database.insert(random_rows(rng, 3)));
    const std::vector<PrimitiveKey> keys = {{1, 2, 3}};
    CHECK(database.find(kPairs, keys, 1e9, 0)->empty());
    CHECK(database.find("trios/1", keys, 1e9, 0)->empty());
    const std::vector<PrimitiveKey> mixed = {random_key(rng), {1, 2, 3}};
    CHECK(database.find(kPairs, mixed, 1e9, 0)->empty());
    CHECK(database.find("", keys_of(random_key(rng)), 1e9, 0)->empty());
  }

  TEST_CASE("rows of several kinds live side by side, each kind with keys of its own length") {
    const TemporaryDirectory directory;
    Rng rng(69);
    Experience trio = random_experience(rng, 2);
    trio.kind = "trios/1";
    trio.key = {1, 2, 3};
    Experience other = random_experience(rng, 4);
    other.kind = "others/1";
    {
      Database database = open_database(directory / "a.db");
      CHECK(database.kinds().empty());
      REQUIRE(database.insert({random_experience(rng, 3), trio}));
      REQUIRE(database.insert({other, random_experience(rng, 3)}));
    }
    const Database database = open_database(directory / "a.db", OpenMode::read_only);
    const std::vector<KindInfo> kinds = database.info().kinds;
    REQUIRE(kinds.size() == 3);
    const std::vector<std::string> names = {"others/1", kPairs, "trios/1"};
    for (std::size_t i = 0; i < 3; ++i) CHECK(kinds[i].kind == names[i]);
    CHECK(kinds[1].samplers == 2);
    CHECK(kinds[1].components == 6);
    CHECK(kinds[2].key_size == 3);
    CHECK(database.info().samplers == 4);
    CHECK(database.info().components == 12);
    const std::vector<PrimitiveKey> keys = {{1, 2, 3.5}, {1, 2, 3.1}};
    const auto matches = *database.find("trios/1", keys, 1, 0);
    REQUIRE(matches.size() == 1);
    CHECK(matches[0].image == 1);
    CHECK(matches[0].similarity_error == doctest::Approx(0.01));
    CHECK(is_same_content(*matches[0].experience, trio));
    std::vector<std::string> visited;
    REQUIRE(database.for_each([&](const auto& row) { visited.push_back(row->kind); }));
    CHECK(visited == std::vector<std::string>{"others/1", kPairs, kPairs, "trios/1"});
    for (std::int64_t i = 0; i < 4; ++i) {
      CHECK(database.get(i)->kind == visited[static_cast<std::size_t>(i)]);
    }
    CHECK(verify_database(directory / "a.db")->empty());
  }

  TEST_CASE("the first row of a kind decides how long its keys are, for all processes") {
    const TemporaryDirectory directory;
    Rng rng(70);
    Database first = open_database(directory / "a.db");
    Database second = open_database(directory / "a.db");
    REQUIRE(first.insert(random_rows(rng, 1)));
    Experience row = random_experience(rng);
    row.key.push_back(1);
    for (Database* database : {&first, &second}) {
      const Error refused = require_error(database->insert({random_experience(rng), row}));
      CHECK(refused.code == ErrorCode::invalid);
      CHECK(refused.message.find(directory / "a.db") == 0);
      CHECK(contains(refused.message, "7 numbers; expected 6"));
    }
    REQUIRE(second.refresh() == 1);
    CHECK(second.size() == 1);
    row.kind = "other/1";
    CHECK(second.insert({row}).has_value());
    for (const std::string& kind :
         {std::string(), std::string(65, 'k'), std::string("a\nb"), std::string("\xff")}) {
      row.kind = kind;
      CHECK(second.insert({row}).error().code == ErrorCode::invalid);
    }
    row.kind = std::string(64, 'k');
    CHECK(second.insert({row}).has_value());
  }

  TEST_CASE("what is there already is not added again, within a batch or later") {
    const TemporaryDirectory directory;
    Rng rng(64);
    Database database = open_database(directory / "a.db");
    auto rows = random_rows(rng, 2);
    rows.push_back(rows[0]);
    rows[2].provenance.time = "2021-01-01T00:00:00Z";
    rows[2].provenance.tool = "another";
    CHECK(database.insert(rows) == std::vector<std::int64_t>{1, 2, 1});
    CHECK(database.insert({rows[1]}) == std::vector<std::int64_t>{2});
    CHECK(database.size() == 2);
    CHECK(database.info().generation == 1);
    rows[1].sampler().means[0] += 1;
    CHECK(database.insert({rows[1]}) == std::vector<std::int64_t>{3});
    CHECK(open_database(directory / "a.db", OpenMode::read_only).size() == 3);
  }

  TEST_CASE("refresh reads what another process added, and only that") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    Rng rng(65);
    Database writer = open_database(directory / "a.db");
    Database reader = open_database(directory / "a.db", OpenMode::read_only);
    CHECK(reader.refresh() == 0);
    const auto rows = random_rows(rng, 5);
    REQUIRE(writer.insert(rows));
    CHECK(reader.size() == 0);
    CHECK(reader.refresh() == 5);
    CHECK(reader.refresh() == 0);
    REQUIRE(reader.size() == 5);
    for (int i = 0; i < 5; ++i) {
      CHECK(is_same_content(*reader.get(i), rows[static_cast<std::size_t>(i)]));
      CHECK(find_like(reader, make_primitive(rows[static_cast<std::size_t>(i)].key), 1e-9, 1)
                ->size() == 1);
    }
    CHECK(reader.info().generation == writer.info().generation);
  }

  TEST_CASE("a writer sees the rows of others once it inserts") {
    const TemporaryDirectory directory;
    Rng rng(66);
    Database first = open_database(directory / "a.db");
    Database second = open_database(directory / "a.db");
    REQUIRE(first.insert(random_rows(rng, 2)));
    CHECK(second.insert(random_rows(rng, 1)) == std::vector<std::int64_t>{3});
    REQUIRE(second.size() == 3);
    for (int i = 0; i < 3; ++i) CHECK(second.get(i)->id == i + 1);
    CHECK(first.refresh() == 1);
  }

  TEST_CASE("rows that are set aside vanish at the next refresh, and matches stay valid") {
    const TemporaryDirectory directory;
    Rng rng(67);
    Database writer = open_database(directory / "a.db");
    const auto rows = random_rows(rng, 4);
    REQUIRE(writer.insert(rows));
    Database reader = open_database(directory / "a.db", OpenMode::read_only);
    const auto matches = *find_like(reader, make_primitive(rows[1].key), 1e-9, 1);
    REQUIRE(matches.size() == 1);
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1 WHERE id = 2");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
    CHECK(reader.refresh() == 0);
    CHECK(reader.size() == 3);
    CHECK(find_like(reader, make_primitive(rows[1].key), 1e-9, 1)->empty());
    CHECK(find_like(reader, make_primitive(rows[3].key), 1e-9, 1)->size() == 1);
    CHECK(is_same_content(*matches[0].experience, rows[1]));
    CHECK(reader.info().components == 15);

    // The same again after the rows are gone for good, and with the sound row back.
    CHECK(writer.insert({rows[1]}) == std::vector<std::int64_t>{5});
    require(compact_database(directory / "a.db"));
    CHECK(reader.refresh() == 1);
    CHECK(writer.refresh() == 0);
    for (const Database* database : {&reader, &writer}) {
      CHECK(database->size() == 4);
      CHECK(database->info().tombstones == 0);
      CHECK(find_like(*database, make_primitive(rows[1].key), 1e-9, 0)->size() == 1);
    }
  }

  TEST_CASE("an empty database of another robot is refused once that robot fills it") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    Database reader = open_database(directory / "a.db", OpenMode::read_only);
    CHECK(reader.refresh() == 0);
    RobotSignature other = arm_signature();
    other.model_hash = "other";
    require(Database::open(directory / "a.db", other, OpenMode::create));
    CHECK(require_error(reader.refresh()).code == ErrorCode::wrong_robot);
  }

  TEST_CASE("text that would be SQL elsewhere is stored as it is") {
    const TemporaryDirectory directory;
    const std::string attack = "x'); DROP TABLE experience; DELETE FROM mixture; --\"\\ $1 ?1";
    Rng rng(68);
    RobotSignature space{attack, attack, attack, 3};
    Experience row = random_experience(rng);
    row.provenance = {attack, attack, 1, attack};
    const std::string path = directory / "a'; DROP TABLE x; --.db";
    require(Database::open(path, space, OpenMode::create)->insert({row}));
    const auto database = require(Database::open(path, space, OpenMode::read_only));
    CHECK(is_same_content(*database.get(0), row));
    CHECK(database.signature().robot_name == attack);
  }

  TEST_CASE("a database that is read while another writes shows what was complete by then") {
    const TemporaryDirectory directory;
    Rng rng(60);
    Database writer = open_database(directory / "a.db");
    REQUIRE(writer.insert(random_rows(rng, 2)));
    const Database reader = open_database(directory / "a.db", OpenMode::read_only);
    REQUIRE(writer.insert(random_rows(rng, 3)));
    CHECK(reader.size() == 2);
    CHECK(open_database(directory / "a.db", OpenMode::read_only).size() == 5);
  }

  TEST_CASE("closing the last writer leaves one file") {
    const TemporaryDirectory directory;
    Rng rng(61);
    {
      Database database = open_database(directory / "a.db");
      REQUIRE(database.insert(random_rows(rng, 5)));
      CHECK(std::filesystem::exists(directory / "a.db-wal"));
    }
    CHECK(!std::filesystem::exists(directory / "a.db-wal"));
    CHECK(!std::filesystem::exists(directory / "a.db-shm"));
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("find returns the nearest of all primitives under the threshold, nearest first") {
    const std::uint64_t seed = 63;
    const TemporaryDirectory directory;
    Rng rng(seed);
    Database database = open_database(directory / "a.db");
    const auto rows = random_rows(rng, 800, 1);
    REQUIRE(database.insert(rows));
    for (int i = 0; i < 200; ++i) {
      const LocalPrimitive primitive = make_primitive(random_key(rng));
      const double threshold = rng.uniform(0, 3);
      std::vector<std::pair<double, std::int64_t>> expected;
      for (std::size_t k = 0; k < rows.size(); ++k) {
        const double error = pair_error(primitive.key, rows[k].key);
        if (error < threshold) expected.emplace_back(error, static_cast<std::int64_t>(k) + 1);
      }
      std::sort(expected.begin(), expected.end());
      const auto all = *find_like(database, primitive, threshold, 0);
      const auto some = *find_like(database, primitive, threshold, 8);
      INFO("seed " << seed << ", query " << i);
      REQUIRE(all.size() == expected.size());
      REQUIRE(some.size() == std::min<std::size_t>(8, expected.size()));
      for (std::size_t k = 0; k < all.size(); ++k) {
        REQUIRE(all[k].experience->id == expected[k].second);
        REQUIRE(all[k].similarity_error == doctest::Approx(expected[k].first).epsilon(1e-12));
        if (k < some.size()) REQUIRE(some[k].experience == all[k].experience);
      }
    }
  }
}

}  // namespace mneme::test
