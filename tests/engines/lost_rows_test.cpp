// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/fixtures.h"
#include "store/lost_rows.h"

#include <sys/stat.h>
#include <sys/xattr.h>
#include <map>

namespace mneme::test {
namespace {

constexpr int kRows = 40, kTransactions = 20;

/// The files that a killed process leaves: the database, its log, and the record beside them.
struct Leftover {
  std::string file, log, record;
};

/// Half of the rows are in the file, the other half in its log.
Leftover make_leftover(const std::string& path) {
  Rng rng(95);
  { REQUIRE(open_database(path).insert(random_rows(rng, kRows / 2, 20))); }
  Database database = open_database(path);
  for (int i = 0; i < kTransactions; ++i) {
    REQUIRE(database.insert(random_rows(rng, kRows / 2 / kTransactions, 20)));
  }
  return {read_file(path), read_file(path + "-wal"), read_file(internal::record_path(path))};
}

void write_leftover(const std::string& path, const Leftover& leftover) {
  std::filesystem::remove(path + "-shm");
  write_file(path, leftover.file);
  write_file(path + "-wal", leftover.log);
  std::filesystem::remove(path + ".tally");
  if (!leftover.record.empty()) write_file(path + ".tally", leftover.record);
}

std::string flipped_at(std::string bytes, std::size_t position, int bit) {
  bytes[position] = static_cast<char>(bytes[position] ^ (1 << bit));
  return bytes;
}

/// True if all rows are there, or their loss is reported by opening and by verifying.
bool is_whole_or_reported(const std::string& path, const Leftover& leftover) {
  write_leftover(path, leftover);
  const auto opened = Database::open(path, arm_signature(), OpenMode::read_only);
  if (opened) return opened->size() == kRows;
  const ErrorCode code = opened.error().code;
  if (code != ErrorCode::corrupt && code != ErrorCode::unsupported) return false;
  write_leftover(path, leftover);
  const auto damages = verify_database(path);
  return !damages || !damages->empty();
}

/// Inserts rows in a process that ends without closing the database: they are in its log only.
void insert_and_die(const std::string& path, int count) {
  const pid_t child = start_child([&]() -> int {
    Rng rng(5);
    auto database = Database::open(path, arm_signature(), OpenMode::create);
    const bool is_stored = database && database->insert(random_rows(rng, count));
    ::_exit(is_stored ? 0 : 1);
  });
  REQUIRE(wait_for(child) == 0);
}

/// True if the file system keeps extended attributes, which stay with a renamed file.
bool keeps_attributes(const std::string& path) {
  return ::setxattr(path.c_str(), "user.mneme.test", "1", 1, 0) == 0;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("no damage to what a killed process left loses rows silently") {
    const std::uint64_t seed = 96;
    const TemporaryDirectory directory;
    const Leftover sound = make_leftover(directory / "sound.db");
    const std::string path = directory / "a.db";
    REQUIRE(is_whole_or_reported(path, sound));
    Rng rng(seed);
    for (int i = 0; i < rounds(300); ++i) {
      Leftover damaged = sound;
      std::string& part = i % 3 == 2 ? damaged.file : damaged.log;
      const std::size_t position = rng.index(static_cast<std::uint32_t>(part.size()));
      part = i % 3 == 1 ? part.substr(0, position)
                        : flipped_at(part, position, static_cast<int>(rng.index(8)));
      INFO("seed " << seed << ", round " << i << ", byte " << position);
      REQUIRE(is_whole_or_reported(path, damaged));
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("an empty file beside its log is damaged, and the log is kept") {
    const TemporaryDirectory directory;
    Leftover leftover = make_leftover(directory / "sound.db");
    leftover.file.clear();
    leftover.record.clear();
    const std::string path = directory / "a.db";
    write_leftover(path, leftover);
    for (const OpenMode mode : {OpenMode::read_only, OpenMode::read_write, OpenMode::create}) {
      const Error error = require_error(Database::open(path, arm_signature(), mode));
      CHECK(error.code == ErrorCode::corrupt);
      CHECK(contains(error.message, "it is empty, but its log"));
    }
    const auto damages = verify_database(path);
    CHECK((!damages || !damages->empty()));
    CHECK(read_file(path + "-wal") == leftover.log);
  }

  TEST_CASE("a missing file beside its log is no new database, and the log is kept") {
    const TemporaryDirectory directory;
    const Leftover leftover = make_leftover(directory / "sound.db");
    const std::string path = directory / "a.db";
    write_leftover(path, leftover);
    std::filesystem::remove(path);
    for (const OpenMode mode : {OpenMode::read_only, OpenMode::read_write, OpenMode::create}) {
      const Error error = open_error(path, mode);
      CHECK(error.code == ErrorCode::corrupt);
      CHECK_MESSAGE(
          contains(error.message, "the file is missing, but its log " + path + "-wal has"),
          error.message);
      CHECK(contains(error.message, "or remove " + path + "-wal to begin an empty database"));
    }
    CHECK_FALSE(std::filesystem::exists(path));
    CHECK(read_file(path + "-wal") == leftover.log);
    CHECK(read_file(path + ".tally") == leftover.record);
    std::filesystem::remove(path + "-wal");
    CHECK(open_database(path).size() == 0);
  }

  TEST_CASE("files of a database that are not regular are refused without waiting for them") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    for (const char* ending : {"", "-wal", "-shm", "-journal", ".tally"}) {
      for (const bool is_pipe : {true, false}) {
        const std::string file = path + ending;
        std::filesystem::remove(path);
        if (*ending != '\0') {
          Rng rng(4);
          REQUIRE(open_database(path).insert(random_rows(rng, 2)));
        }
        std::filesystem::remove(file);
        REQUIRE((is_pipe ? ::mkfifo(file.c_str(), 0600) : ::mkdir(file.c_str(), 0700)) == 0);
        for (const OpenMode mode : {OpenMode::read_only, OpenMode::read_write, OpenMode::create}) {
          const Error error = open_error(path, mode);
          CHECK(error.code == ErrorCode::io);
          CHECK(contains(error.message, file + ": "));
          CHECK_MESSAGE(contains(error.message, "expected a regular file"), error.message);
        }
        CHECK(verify_database(path).error().code == ErrorCode::io);
        std::filesystem::remove(file);
      }
    }
  }

  TEST_CASE("a record that tells nothing is named with its flaw until the next insertion") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db", tally = path + ".tally";
    Rng rng(7);
    { REQUIRE(open_database(path).insert(random_rows(rng, 2))); }
    { REQUIRE(open_database(directory / "b.db").insert(random_rows(rng, 2))); }
    const std::string sound = read_file(tally);
    const auto flaw_of = [&] {
      return open_database(path, OpenMode::read_only).info().record_flaw;
    };
    CHECK(flaw_of().empty());
    CHECK_FALSE(describe_record_flaw(path).has_value());
    for (const auto& [bytes, flaw] :
         {std::pair(std::string(), " is empty"),
          {sound.substr(0, 50), " is damaged: it has 50 bytes, expected 104"},
          {flipped_at(sound, 20, 1), " is damaged"},
          {read_file(directory / "b.db.tally"), " is of another database"}}) {
      write_file(tally, bytes);
      CHECK_MESSAGE(flaw_of().starts_with(tally + flaw + ": "), flaw_of());
      CHECK(contains(describe_record_flaw(path).value_or(""), tally + flaw + ": "));
    }
    std::filesystem::remove(tally);
    CHECK(flaw_of().empty());
    CHECK(contains(describe_record_flaw(path).value_or(""), "there is no " + tally));
    write_file(tally, "");
    REQUIRE(open_database(path).insert(random_rows(rng, 1)));
    CHECK(flaw_of().empty());
  }

  TEST_CASE("the record of another database with more changes tells of no loss") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(8);
    { REQUIRE(open_database(path).insert(random_rows(rng, 2))); }
    const Leftover other = make_leftover(directory / "b.db");
    write_file(path + ".tally", other.record);
    CHECK(open_database(path, OpenMode::read_only).size() == 2);
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("a changed byte in a log is reported with the number of lost rows, without a record") {
    const TemporaryDirectory directory;
    Leftover leftover = make_leftover(directory / "sound.db");
    leftover.record.clear();
    const std::string path = directory / "a.db";
    // In the header of the log, of its first frame, and in the page of that.
    for (const std::size_t position : {9, 20, 40, 5000}) {
      Leftover damaged = leftover;
      damaged.log = flipped_at(damaged.log, position, 3);
      write_leftover(path, damaged);
      const Error error = open_error(path);
      CHECK(error.code == ErrorCode::corrupt);
      CHECK_MESSAGE(contains(error.message, "20 rows that were stored in 20 transactions are lost"),
                    error.message);
      CHECK(read_file(path + "-wal") == damaged.log);  // nothing was touched
    }
  }

  TEST_CASE("verifying gives up lost rows, and makes the others usable") {
    const TemporaryDirectory directory;
    Leftover leftover = make_leftover(directory / "sound.db");
    leftover.log = flipped_at(leftover.log, leftover.log.size() / 2, 1);
    const std::string path = directory / "a.db";
    write_leftover(path, leftover);
    const auto damages = require(verify_database(path, VerifyMode::quarantine));
    REQUIRE(damages.size() == 1);
    CHECK(damages.front().is_quarantined);
    CHECK(contains(damages.front().what, "are lost"));
    const std::int64_t left = open_database(path, OpenMode::read_only).size();
    CHECK(left >= kRows / 2);
    CHECK(left < kRows);
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("a file renamed without its log is refused, and is whole again with it") {
    const TemporaryDirectory directory;
    std::filesystem::create_directory(directory / "elsewhere");
    const std::string path = directory / "a.db";
    std::string other = directory / "b.db";
    Rng rng(6);
    { REQUIRE(open_database(path).insert(random_rows(rng, 2))); }
    SUBCASE("in its directory") {}
    SUBCASE("into another directory") { other = directory / "elsewhere/a.db"; }
    SUBCASE("in the place of another database") {
      REQUIRE(open_database(other).insert(random_rows(rng, 3)));
    }
    insert_and_die(path, kRows);
    std::filesystem::rename(path, other);
    if (!keeps_attributes(other)) return;
    for (const OpenMode mode : {OpenMode::read_only, OpenMode::read_write, OpenMode::create}) {
      const Error error = open_error(other, mode);
      CHECK(error.code == ErrorCode::corrupt);
      CHECK_MESSAGE(contains(error.message, "40 rows that were stored are missing"), error.message);
      CHECK_MESSAGE(contains(error.message, "rename " + path + "-wal to " + other + "-wal"),
                    error.message);
    }
    CHECK(contains(first_damage(other), "40 rows that were stored are missing"));
    CHECK(contains(open_error(path).message, "rename the log with a file that was renamed"));
    std::filesystem::rename(path + "-wal", other + "-wal");
    CHECK(open_database(other, OpenMode::read_only).size() == kRows + 2);
    CHECK(verify_database(other)->empty());
    { REQUIRE(open_database(other).insert(random_rows(rng, 1))); }
    CHECK(open_database(other, OpenMode::read_only).size() == kRows + 3);
  }

  TEST_CASE("the lost log of a renamed file is named, and its rows can be given up") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db", other = directory / "b.db";
    insert_and_die(path, 3);
    std::filesystem::rename(path, other);
    if (!keeps_attributes(other)) return;
    std::filesystem::remove(path + "-wal");
    const Error error = open_error(other);
    CHECK_MESSAGE(contains(error.message, "whose log " + path + "-wal is gone"), error.message);
    CHECK_FALSE(require(verify_database(other, VerifyMode::quarantine)).empty());
    CHECK(open_database(other, OpenMode::read_only).size() == 0);
    CHECK(verify_database(other)->empty());
  }

  TEST_CASE("the log of a file that is there under its old name, too, is not to be renamed") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db", other = directory / "b.db";
    insert_and_die(path, 3);
    if (!keeps_attributes(path)) return;
    std::filesystem::create_hard_link(path, other);  // as a copy with attributes
    const Error error = open_error(other);
    CHECK_MESSAGE(contains(error.message, "3 rows that were stored are missing"), error.message);
    CHECK_MESSAGE(contains(error.message, "copy both " + path + " and the log"), error.message);
    CHECK(open_database(path, OpenMode::read_only).size() == 3);
  }

  TEST_CASE("a file that was closed may be renamed") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db", other = directory / "b.db";
    Rng rng(2);
    { REQUIRE(open_database(path).insert(random_rows(rng, 3))); }
    std::filesystem::rename(path, other);
    CHECK(open_database(other).size() == 3);
    CHECK(verify_database(other)->empty());
    { REQUIRE(open_database(path).insert(random_rows(rng, 1))); }
    CHECK(open_database(path, OpenMode::read_only).size() == 1);
  }

  TEST_CASE("an older copy may replace a file that was closed") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    Rng rng(2);
    { REQUIRE(open_database(path).insert(random_rows(rng, 3))); }
    const std::string copy = read_file(path);
    { REQUIRE(open_database(path).insert(random_rows(rng, 4))); }
    write_file(path, copy);
    CHECK(open_database(path, OpenMode::read_only).size() == 3);
    CHECK(verify_database(path)->empty());
  }

  TEST_CASE("a log cut short and a file of no bytes are compared with the record") {
    const TemporaryDirectory directory;
    const Leftover leftover = make_leftover(directory / "sound.db");
    const std::string path = directory / "a.db";
    Leftover cut = leftover;
    cut.log.clear();
    write_leftover(path, cut);
    CHECK(contains(open_error(path).message, "20 rows that were stored are missing"));
    write_leftover(path, {"", "", leftover.record});
    for (const OpenMode mode : {OpenMode::read_only, OpenMode::create}) {
      const Error error = open_error(path, mode);
      CHECK(error.code == ErrorCode::corrupt);
      CHECK(contains(error.message, "40 rows that were stored are missing"));
    }
    CHECK(!verify_database(path)->empty());
    // A new file of the same name is not the old one.
    std::filesystem::remove(path);
    std::filesystem::remove(path + "-wal");
    Rng rng(1);
    REQUIRE(open_database(path).insert(random_rows(rng, 1)));
    CHECK(open_database(path, OpenMode::read_only).size() == 1);
  }

  TEST_CASE("rows are not acknowledged once their file was removed, renamed or replaced") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db", other = directory / "b.db";
    Rng rng(2);
    std::function<void()> take_away = [&] { std::filesystem::remove(path); };
    SUBCASE("removed") {}
    SUBCASE("renamed") {
      take_away = [&] { std::filesystem::rename(path, other); };
    }
    SUBCASE("replaced") {
      { REQUIRE(open_database(other).insert(random_rows(rng, 3))); }
      take_away = [&] { std::filesystem::rename(other, path); };
    }
    Database database = open_database(path);
    REQUIRE(database.insert(random_rows(rng, 2)));
    take_away();
    for (int i = 0; i < 2; ++i) {
      const Error error = require_error(database.insert(random_rows(rng, 1)));
      CHECK(error.code == ErrorCode::io);
      CHECK(error.message.find(path) == 0);
      CHECK_MESSAGE(contains(error.message, "removed, renamed or replaced"), error.message);
    }
    CHECK(database.size() == 2);
  }

  TEST_CASE("rows are stored again once their file is back, and wait meanwhile") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db", other = directory / "b.db";
    Rng rng(3);
    Database database = open_database(path);
    REQUIRE(database.insert(random_rows(rng, 2)));
    std::filesystem::rename(path, other);
    REQUIRE(database.insert_later(random_rows(rng, 1)));
    CHECK_FALSE(database.flush(0.1).has_value());
    CHECK(database.queued_rows().stored == 0);
    CHECK(database.queued_rows().waiting == 1);
    std::filesystem::rename(other, path);
    REQUIRE(database.flush());
    CHECK(open_database(path, OpenMode::read_only).size() == 3);
  }
}

}  // namespace mneme::test
