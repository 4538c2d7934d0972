// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "store/fixtures.h"
#include "store/new_file.h"
#include "upkeep/salvage.h"

#include <atomic>
#include <thread>

namespace mneme::test {
namespace {

using internal::CarvedRows;

CarvedRows carve(const std::string& path) {
  auto rows = CarvedRows::read(path);
  REQUIRE_MESSAGE(rows.has_value(), (rows ? "" : rows.error().message));
  return std::move(*rows);
}

std::string flaw_of(CarvedRows& rows, std::int64_t id) {
  const auto row = rows.row(id);
  REQUIRE(row.has_value());
  Experience experience;
  return internal::decode(*row, rows.space(), experience).value_or("");
}

/// Rows that take a while to build a file of.
constexpr int kMany = 1000;

void create_filled(const std::string& path) {
  Rng rng(24);
  REQUIRE(open_database(path).insert(random_rows(rng, 6, 30)));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("all that a sound file holds is found") {
    const TemporaryDirectory directory;
    create_filled(directory / "a.db");
    CarvedRows rows = carve(directory / "a.db");
    CHECK(rows.space().robot_name == "arm");
    CHECK(rows.space().joint_count == 3);
    REQUIRE(rows.head().has_value());
    CHECK(rows.head()->row_count == 6);
    CHECK(rows.dead().empty());
    CHECK(rows.ids() == std::vector<std::int64_t>{1, 2, 3, 4, 5, 6});
    const Database database = open_database(directory / "a.db", OpenMode::read_only);
    for (const std::int64_t id : rows.ids()) {
      const auto row = rows.row(id);
      Experience experience;
      REQUIRE(!internal::decode(*row, rows.space(), experience));
      CHECK(is_same_content(experience, *database.get(id - 1)));
    }
  }

  TEST_CASE("parts that are missing or changed are flaws, and tombstones are known") {
    const TemporaryDirectory directory;
    create_filled(directory / "a.db");
    run_sql(directory / "a.db", "UPDATE mixture SET seed = seed + 1 WHERE id = 1");
    REQUIRE(verify_database(directory / "a.db", VerifyMode::quarantine)->size() == 1);
    run_sql(directory / "a.db",
            "DELETE FROM experience WHERE id = 3; DELETE FROM mixture WHERE id = 4;"
            "UPDATE experience SET cell = cell + 1 WHERE id = 5; UPDATE head SET epoch = 9");
    CarvedRows rows = carve(directory / "a.db");
    CHECK(rows.dead() == std::set<std::int64_t>{1});
    CHECK(!rows.head().has_value());
    CHECK(flaw_of(rows, 2).empty());
    CHECK(flaw_of(rows, 3) == "its key is missing");
    CHECK(flaw_of(rows, 4) == "its mixture is missing");
    CHECK(flaw_of(rows, 5).find("the checksum of its key") == 0);
  }

  TEST_CASE("a file with no robot, or with two, says so") {
    const TemporaryDirectory directory;
    create_filled(directory / "a.db");
    ExperienceSpace other = arm_space();
    other.robot_hash = "f";
    run_sql(directory / "a.db",
            "CREATE TABLE twin (id INTEGER PRIMARY KEY, a, b, c, d);"
            "INSERT INTO twin VALUES (1, 'arm', 'f', 3, " +
                std::to_string(internal::checksum_of(other)) + ")");
    CHECK(CarvedRows::read(directory / "a.db").error().message.find("different robots") !=
          std::string::npos);
    run_sql(directory / "a.db", "DELETE FROM twin; DELETE FROM space");
    const auto none = CarvedRows::read(directory / "a.db");
    CHECK(none.error().code == ErrorCode::corrupt);
    CHECK(none.error().message.find("names the robot is missing") != std::string::npos);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("rows of the pages that can still be read are saved under their ids") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(17);
    const auto rows = random_rows(rng, 60, 30);
    REQUIRE(open_database(path).insert(rows));
    // The mixtures of some rows in the middle stand on this page.
    std::string bytes = read_file(path);
    const auto& means = rows[30].sampler.means;
    const std::string stored(reinterpret_cast<const char*>(means.data()), 4 * means.size());
    const std::size_t at = bytes.find(stored);
    REQUIRE(at != std::string::npos);
    for (std::size_t i = at / 8192 * 8192; i < at / 8192 * 8192 + 100; ++i) bytes[i] = '\x7f';
    write_file(path, bytes);

    std::vector<Damage> damages;
    const auto copy = internal::salvage_file(path, damages);
    REQUIRE_MESSAGE(copy.has_value(), (copy ? "" : copy.error().message));
    CHECK(*copy == path + ".damaged");
    CHECK(!std::filesystem::exists(path + ".salvage"));
    CHECK(verify_database(path)->empty());
    CHECK(!verify_database(*copy)->empty());
    const Database database = open_database(path, OpenMode::read_only);
    // The last damage says how many.
    const auto lost = static_cast<std::int64_t>(damages.size()) - 1;
    CHECK(database.size() + lost == 60);
    CHECK(lost > 0);
    CHECK(lost < 20);
    CHECK(damages.back().what == "built anew: " + std::to_string(60 - lost) + " rows are saved, " +
                                     std::to_string(lost) + " are lost; " + path +
                                     ".damaged is what was there before");
    for (std::int64_t i = 0; i < database.size(); ++i) {
      const Experience row = *database.get(i);
      CHECK(is_same_content(row, rows[static_cast<std::size_t>(row.id - 1)]));
    }
  }

  TEST_CASE("without the row that names the robot nothing can be saved") {
    const TemporaryDirectory directory;
    open_database(directory / "a.db");
    run_sql(directory / "a.db", "DELETE FROM space");
    const std::string before = read_file(directory / "a.db");
    std::vector<Damage> damages;
    const auto copy = internal::salvage_file(directory / "a.db", damages);
    REQUIRE(!copy.has_value());
    CHECK(copy.error().code == ErrorCode::corrupt);
    CHECK(copy.error().message.find("names the robot") != std::string::npos);
    CHECK(damages.empty());
    CHECK(read_file(directory / "a.db") == before);
    CHECK(!std::filesystem::exists(directory / "a.db.damaged"));
  }

  TEST_CASE("rows that nothing names are counted, without those that were removed before") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(21);
    REQUIRE(open_database(path).insert(random_rows(rng, 60, 30)));
    run_sql(path, "UPDATE mixture SET seed = seed + 1 WHERE id = 9");
    REQUIRE(verify_database(path, VerifyMode::quarantine)->size() == 1);
    REQUIRE(compact_database(path));
    const std::string bytes = read_file(path);
    // Keys come first, and pages of 20 mixtures; indices are last.
    write_file(path, bytes.substr(0, bytes.size() - std::size_t{5} * 8192));
    const auto damages = verify_database(path, VerifyMode::quarantine);
    const std::int64_t saved = open_database(path, OpenMode::read_only).size();
    CHECK(saved > 0);
    CHECK(saved < 59);
    CHECK(damages->back().is_quarantined);
    CHECK(damages->back().what.find("built anew: " + std::to_string(saved) + " rows are saved, " +
                                    std::to_string(59 - saved) + " are lost") == 0);
  }

  TEST_CASE("sound rows whose keys are not as long as others of their kind are not saved") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(22);
    REQUIRE(open_database(path).insert(random_rows(rng, 4)));
    Experience row = random_experience(rng);
    row.kind = "other/1";
    row.key.push_back(1);
    REQUIRE(open_database(path).insert({row}));
    row.kind = kPairs;
    const internal::EncodedRow encoded(row);
    const internal::StoredRow stored = encoded.stored(5, 2);
    // Sound in itself, but of the first kind.
    run_sql(path, "UPDATE experience SET kind = 'pairs/1', content = x'" +
                      internal::to_hex(stored.content) +
                      "', checksum = " + std::to_string(stored.key_checksum) + " WHERE id = 5");
    const auto damages = verify_database(path);
    REQUIRE(damages.has_value());
    CHECK(damages->front().id == 5);
    CHECK(damages->front().what.find("7 numbers; expected 6") != std::string::npos);
    std::string bytes = read_file(path);
    bytes[0] ^= 1;
    write_file(path, bytes);
    REQUIRE(verify_database(path, VerifyMode::quarantine)->front().is_quarantined);
    CHECK(open_database(path).size() == 4);
  }

  TEST_CASE("tables and triggers of a stranger are left in the copy and never run") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(18);
    REQUIRE(open_database(path).insert(random_rows(rng, 5)));
    run_sql(path,
            "CREATE TABLE more (a); CREATE TRIGGER t AFTER INSERT ON experience BEGIN DELETE FROM "
            "mixture; END; CREATE VIEW v AS SELECT * FROM space");
    REQUIRE(verify_database(path, VerifyMode::quarantine)->front().is_quarantined);
    CHECK(open_database(path).size() == 5);
    CHECK(first_damage(path + ".damaged").find("is not one that mneme creates") !=
          std::string::npos);
  }

  TEST_CASE("what a killed writer left in the log is saved under a damaged header, too") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(19);
    const auto rows = random_rows(rng, 12);
    {
      Database database = open_database(path);
      REQUIRE(database.insert({rows.begin(), rows.begin() + 8}));
    }
    {
      Database database = open_database(path, OpenMode::read_write);
      REQUIRE(database.insert({rows.begin() + 8, rows.end()}));
      std::filesystem::copy_file(path, directory / "b.db");
      std::filesystem::copy_file(path + "-wal", directory / "b.db-wal");
    }
    std::string bytes = read_file(directory / "b.db");
    bytes[0] ^= 1;
    write_file(directory / "b.db", bytes);
    REQUIRE(!verify_database(directory / "b.db", VerifyMode::quarantine)->empty());
    const Database database = open_database(directory / "b.db", OpenMode::read_only);
    REQUIRE(database.size() == 12);
    CHECK(is_same_content(*database.get(11), rows[11]));
  }

  TEST_CASE("what others insert while a file is built anew is saved, too") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(25);
    Database writer = open_database(path);
    REQUIRE(writer.insert(random_rows(rng, kMany, 30)));
    const auto late = random_rows(rng, 1);
    bool is_inserted = false;
    std::vector<Damage> damages;
    std::jthread thread([&](const std::stop_token& stop) {
      while (!std::filesystem::exists(path + ".damaged")) {
        if (stop.stop_requested()) return;
        std::this_thread::yield();
      }
      is_inserted = writer.insert(late).has_value();
    });
    const auto copy = internal::salvage_file(path, damages);
    thread.join();
    REQUIRE_MESSAGE(copy.has_value(), (copy ? "" : copy.error().message));
    CHECK(*copy == path + ".damaged");
    CHECK(damages.size() == 1);
    REQUIRE(is_inserted);
    CHECK(open_database(path, OpenMode::read_only).size() == kMany + 1);
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("a file that others go on writing to is not replaced") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(26);
    Database writer = open_database(path);
    REQUIRE(writer.insert(random_rows(rng, kMany, 30)));
    std::atomic<int> acknowledged = 0;
    std::vector<Damage> damages;
    std::jthread thread([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (writer.insert(random_rows(rng, 1))) ++acknowledged;
        // Locks of SQLite are not fair: who never lets go may keep others out until they give up.
        spin(std::chrono::milliseconds(2));
      }
    });
    const auto copy = internal::salvage_file(path, damages);
    thread.request_stop();
    thread.join();
    REQUIRE(!copy.has_value());
    CHECK(copy.error().code == ErrorCode::io);
    CHECK(copy.error().message.find(path + ": others wrote to it") == 0);
    CHECK(damages.empty());
    for (const char* suffix : {".damaged", ".salvage"}) {
      CHECK(!std::filesystem::exists(path + suffix));
    }
    CHECK(open_database(path, OpenMode::read_only).size() == kMany + acknowledged);
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("one at a time builds a file anew, and the others say who does") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    create_filled(path);
    std::string bytes = read_file(path);
    bytes[0] ^= 1;
    write_file(path, bytes);
    {
      const auto other = internal::NewFile::create(path + ".salvage");
      REQUIRE(other.has_value());
      const auto found = verify_database(path, VerifyMode::quarantine);
      REQUIRE((found.has_value() && !found->empty()));
      CHECK(found->back().what == "nothing was set aside: " + path + ": cannot be built anew: " +
                                      path + ".salvage: is being written by another process");
      CHECK(read_file(path) == bytes);
    }
    CHECK_FALSE(verify_database(path, VerifyMode::quarantine)->empty());
    CHECK(verify_database(path)->empty());
    CHECK(open_database(path, OpenMode::read_only).size() == 6);
  }

  TEST_CASE("of several who verify a damaged file at the same time one cures it") {
    const TemporaryDirectory directory;
    create_filled(directory / "sound.db");
    std::string bytes = read_file(directory / "sound.db");
    bytes[0] ^= 1;
    for (int round = 0; round < rounds(8); ++round) {
      const std::string path = directory / ("a" + std::to_string(round) + ".db");
      write_file(path, bytes);
      std::vector<pid_t> children;
      for (int i = 0; i < 3; ++i) {
        children.push_back(start_child([&] {
          const auto found = verify_database(path, VerifyMode::quarantine);
          return found && !found->empty() && found->front().is_quarantined ? 0 : 1;
        }));
      }
      int cures = 0;
      for (const pid_t child : children) cures += wait_for(child) == 0 ? 1 : 0;
      INFO("round " << round);
      CHECK(cures >= 1);
      CHECK(verify_database(path)->empty());
      CHECK(open_database(path, OpenMode::read_only).size() == 6);
      CHECK_FALSE(std::filesystem::exists(path + ".damaged.2"));
    }
  }

  TEST_CASE("whoever is killed while they build a file anew loses nothing") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(20);
    REQUIRE(open_database(directory / "sound.db").insert(random_rows(rng, 60, 30)));
    std::string bytes = read_file(directory / "sound.db");
    bytes[0] ^= 1;
    for (int round = 0; round < rounds(8); ++round) {
      for (const auto& entry : std::filesystem::directory_iterator(directory / "")) {
        if (entry.path().filename() != "sound.db") std::filesystem::remove(entry.path());
      }
      write_file(path, bytes);
      const pid_t child =
          start_child([&] { return verify_database(path, VerifyMode::quarantine) ? 0 : 1; });
      spin(std::chrono::microseconds(rng.index(60000)));
      ::kill(child, SIGKILL);
      (void)wait_for(child);
      (void)verify_database(path, VerifyMode::quarantine);
      INFO("round " << round);
      REQUIRE(verify_database(path)->empty());
      REQUIRE(open_database(path, OpenMode::read_only).size() == 60);
    }
  }
}

}  // namespace mneme::test
