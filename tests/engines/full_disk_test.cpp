// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/fixtures.h"

#include <sys/mount.h>
#include <sys/resource.h>
#include <csignal>
#include <fstream>

namespace mneme::test {
namespace {

/// A file system in memory that is full after two megabytes, where one may be mounted.
class SmallDisk {
 public:
  explicit SmallDisk(std::string directory) : directory_(std::move(directory)) {
    std::filesystem::create_directory(directory_);
    is_mounted_ = ::mount("tmpfs", directory_.c_str(), "tmpfs", 0, "size=2m") == 0;
    if (!is_mounted_) MESSAGE("skipped: no file system can be mounted here");
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (is_mounted_) ::umount2(directory_.c_str(), MNT_DETACH);
  }
  [[nodiscard]] bool is_mounted() const { return is_mounted_; }

 private:
  std::string directory_;
  bool is_mounted_ = false;
};

/// Inserts until there is no room; returns the rows that are acknowledged.
std::int64_t insert_until_full(Database& database, Rng& rng, int rows_at_once) {
  std::int64_t acknowledged = 0;
  for (;;) {
    const auto ids = database.insert(random_rows(rng, rows_at_once, 100));
    if (!ids) {
      CHECK(ids.error().code == ErrorCode::io);
      CHECK(contains(ids.error().message, "full"));
      return acknowledged;
    }
    acknowledged += static_cast<std::int64_t>(ids->size());
  }
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("a full disk is an error that inserts nothing and harms nothing") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    const int status = wait_for(start_child([&] {
      std::signal(SIGXFSZ, SIG_IGN);
      auto database = Database::open(path, arm_signature(), OpenMode::create);
      Rng rng(93);
      if (!database || !database->insert(random_rows(rng, 3, 100))) return 1;
      rlimit limit{};
      ::getrlimit(RLIMIT_FSIZE, &limit);
      const rlimit full{200 * 1024, limit.rlim_max};
      ::setrlimit(RLIMIT_FSIZE, &full);
      const auto refused = database->insert(random_rows(rng, 400, 100));
      if (refused || refused.error().code != ErrorCode::io) return 2;
      if (refused.error().message.find(path) != 0) return 3;
      if (database->size() != 3) return 4;
      ::setrlimit(RLIMIT_FSIZE, &limit);
      const auto ids = database->insert(random_rows(rng, 2, 100));
      return ids && *ids == std::vector<std::int64_t>{4, 5} ? 0 : 5;
    }));
    CHECK(status == 0);
    CHECK(verify_database(path)->empty());
    CHECK(open_database(path, OpenMode::read_only).size() == 5);
  }

  TEST_CASE("a disk that is full from the start leaves no database, or an empty one") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    const int status = wait_for(start_child([&] {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit full{10 * 1024, RLIM_INFINITY};
      ::setrlimit(RLIMIT_FSIZE, &full);
      auto database = Database::open(path, arm_signature(), OpenMode::create);
      if (!database) return 1;
      Rng rng(95);
      const auto inserted = database->insert(random_rows(rng, 1));
      return !inserted && inserted.error().code == ErrorCode::io ? 0 : 2;
    }));
    CHECK(status == 0);
    CHECK(open_database(path).size() == 0);
  }

  TEST_CASE("whatever is done on a full file system, nothing that was acknowledged is lost") {
    const TemporaryDirectory directory;
    const SmallDisk disk(directory / "disk");
    if (!disk.is_mounted()) return;
    const std::string path = directory / "disk/a.db";
    const std::string other = directory / "other.db";
    Rng rng(94);
    REQUIRE(open_database(other).insert(random_rows(rng, 500, 100)));
    std::int64_t acknowledged = 0;
    {
      Database database = open_database(path);
      acknowledged = insert_until_full(database, rng, 20);
      acknowledged += insert_until_full(database, rng, 1);
      CHECK(database.size() == acknowledged);
      CHECK(find_like(database, make_primitive(random_key(rng)), 3, 8).has_value());
    }
    const auto check_sound = [&] {
      CHECK(verify_database(path)->empty());
      CHECK(open_database(path, OpenMode::read_only).size() == acknowledged);
    };
    check_sound();
    // An index of a database that does not fit into memory is not worth an error.
    CHECK(Database::open(path, arm_signature(), OpenMode::read_only, {0}).has_value());
    CHECK(require_error(merge_databases(path, other)).code == ErrorCode::io);
    check_sound();
    const Error error = require_error(export_database(path, directory / "disk/a.jsonl"));
    CHECK(error.code == ErrorCode::io);
    CHECK(!std::filesystem::exists(directory / "disk/a.jsonl"));
    (void)compact_database(path);
    check_sound();
    CHECK(merge_databases(other, path)->added == acknowledged);
    CHECK(open_database(other, OpenMode::read_only).size() == 500 + acknowledged);
  }

  TEST_CASE("a disk that fills up while rows are set aside leaves them named, and the rest whole") {
    const TemporaryDirectory directory;
    const SmallDisk disk(directory / "disk");
    if (!disk.is_mounted()) return;
    const std::string path = directory / "disk/a.db";
    Rng rng(95);
    REQUIRE(open_database(path).insert(random_rows(rng, 200, 100)));
    run_sql(path, "UPDATE mixture SET seed = seed + 1 WHERE id = 9");
    const std::string filler = directory / "disk/filler";
    std::ofstream(filler) << std::string(4 << 20, 'x');
    const auto damages = require(verify_database(path, VerifyMode::quarantine));
    REQUIRE(!damages.empty());
    CHECK(damages.front().id == 9);
    std::filesystem::remove(filler);
    require(verify_database(path, VerifyMode::quarantine));
    CHECK(verify_database(path)->empty());
    CHECK(open_database(path, OpenMode::read_only).size() == 199);
  }
}

}  // namespace mneme::test
