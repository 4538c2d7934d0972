// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/database_file.h"

#include <sys/stat.h>

namespace mneme::test {
namespace {

constexpr uid_t kNobody = 65534;

/// Runs `body` as someone whom permissions bind, which they do not for root.
int as_ordinary_user(const std::function<int()>& body) {
  return wait_for(start_child([&] {
    if (::geteuid() == 0 && ::setuid(kNobody) != 0) return 99;
    return body();
  }));
}

void permit(const std::string& path, mode_t mode) { REQUIRE(::chmod(path.c_str(), mode) == 0); }

/// A database with two rows, in a directory that its owner may change again afterwards.
struct LockedDirectory {
  LockedDirectory() {
    permit(directory / "", 0755);
    Rng rng(46);
    REQUIRE(open_database(path).insert(random_rows(rng, 2)));
    permit(path, 0444);
    permit(directory / "", 0555);
  }
  ~LockedDirectory() { ::chmod((directory / "").c_str(), 0755); }
  TemporaryDirectory directory;
  std::string path = directory / "a.db";
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a missing file, a directory and a pipe are refused with the reason") {
    const TemporaryDirectory directory;
    auto opened = internal::open_for_reading(directory / "a.db");
    REQUIRE(!opened.has_value());
    CHECK(opened.error().code == ErrorCode::io);
    CHECK(opened.error().message == directory / "a.db: cannot be read: No such file or directory");
    CHECK(internal::open_for_writing(directory / "a.db", false).error().message ==
          directory / "a.db: cannot be written: No such file or directory");

    for (const bool can_create : {false, true}) {
      opened = internal::open_for_writing(directory / "", can_create);
      REQUIRE(!opened.has_value());
      CHECK(opened.error().code == ErrorCode::io);
      CHECK(opened.error().message.find("is a directory") != std::string::npos);
    }

    REQUIRE(::mkfifo((directory / "pipe").c_str(), 0600) == 0);
    opened = internal::open_for_reading(directory / "pipe");
    REQUIRE(!opened.has_value());
    CHECK(opened.error().message.find("is no regular file") != std::string::npos);
  }

  TEST_CASE("a file in a directory that does not exist cannot be created") {
    const TemporaryDirectory directory;
    const auto opened = internal::open_for_writing(directory / "none/a.db", true);
    REQUIRE(!opened.has_value());
    CHECK(opened.error().code == ErrorCode::io);
    CHECK(opened.error().message.find(directory / "none/a.db") == 0);
  }

  TEST_CASE("a database that may not be read is refused") {
    LockedDirectory locked;
    permit(locked.path, 0);
    CHECK(as_ordinary_user([&] {
            const auto opened = internal::open_for_reading(locked.path);
            return !opened && opened.error().code == ErrorCode::io &&
                           opened.error().message.find("Permission denied") != std::string::npos
                       ? 0
                       : 1;
          }) == 0);
  }

  TEST_CASE("a read-only database in a read-only directory can be read but not written") {
    const LockedDirectory locked;
    CHECK(as_ordinary_user([&] {
            const auto database = Database::open(locked.path, arm_space(), OpenMode::read_only);
            return database && database->size() == 2 ? 0 : 1;
          }) == 0);
    CHECK(as_ordinary_user([&] {
            const auto opened = Database::open(locked.path, arm_space(), OpenMode::read_write);
            return !opened && opened.error().code == ErrorCode::io ? 0 : 1;
          }) == 0);
    CHECK(as_ordinary_user([&] {
            const auto damages = verify_database(locked.path);
            return damages && damages->empty() ? 0 : 1;
          }) == 0);
  }

  TEST_CASE("a writable database in a read-only directory is refused to writers") {
    const LockedDirectory locked;
    permit(locked.path, 0666);
    CHECK(as_ordinary_user([&] {
            const auto opened = Database::open(locked.path, arm_space(), OpenMode::read_write);
            return !opened && opened.error().code == ErrorCode::io ? 0 : 1;
          }) == 0);
  }

  TEST_CASE("unfinished work in the log is not passed over where it cannot be put in order") {
    LockedDirectory locked;
    permit(locked.directory / "", 0755);
    write_file(locked.path + "-wal", std::string(100, 'x'));
    permit(locked.path + "-wal", 0444);
    permit(locked.directory / "", 0555);
    CHECK(as_ordinary_user([&] {
            const auto opened = Database::open(locked.path, arm_space(), OpenMode::read_only);
            return !opened && opened.error().code == ErrorCode::io &&
                           opened.error().message.find("-wal") != std::string::npos
                       ? 0
                       : 1;
          }) == 0);
  }

  TEST_CASE("reading does not leave files beside the database") {
    const TemporaryDirectory directory;
    open_database(directory / "a.db");
    open_database(directory / "a.db", OpenMode::read_only);
    CHECK(!std::filesystem::exists(directory / "a.db-wal"));
    CHECK(!std::filesystem::exists(directory / "a.db-shm"));
  }

  TEST_CASE("the bytes on disk include the log") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", std::string(100, 'x'));
    CHECK(internal::bytes_on_disk(directory / "a.db") == 100);
    write_file(directory / "a.db-wal", std::string(20, 'x'));
    CHECK(internal::bytes_on_disk(directory / "a.db") == 120);
    CHECK(internal::bytes_on_disk(directory / "b.db") == 0);
  }
}

}  // namespace mneme::test
