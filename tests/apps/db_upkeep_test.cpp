// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"

namespace mneme::test {
namespace {

using Json = nlohmann::json;

/// A copy of the database with a bit of its row's key flipped.
std::string damaged_copy(const PlanarFiles& files) {
  std::string bytes = read_file(files.database());
  const Json key = run_json({"db", "list", files.database()})["rows"][0]["key"];
  const double first = key[0].get<double>();
  const std::string stored(reinterpret_cast<const char*>(&first), sizeof first);
  const std::size_t at = bytes.find(stored);
  REQUIRE(at != std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  write_file(files / "damaged.db", bytes);
  return files / "damaged.db";
}

TEST_SUITE("flow") {
  TEST_CASE("verify passes a sound database, reports damage and sets it aside") {
    const PlanarFiles files;
    CHECK(run_json({"db", "verify", files.database()})["is_clean"] == true);
    CHECK(contains(run_program({"db", "verify", files.database()}).out, "is sound"));
    CHECK_FALSE(contains(run_program({"db", "verify", files.database()}).err, ".tally"));
    write_file(files / "copy.db", read_file(files.database()));
    const ProgramRun copied = require_run({"db", "verify", files / "copy.db"});
    CHECK(contains(copied.err, "there is no " + (files / "copy.db") + ".tally"));
    write_file(files / "copy.db.tally", "short");
    for (const char* command : {"verify", "info"}) {
      const ProgramRun noted = require_run({"db", command, files / "copy.db"});
      CHECK_MESSAGE(contains(noted.err, "is damaged: it has 5 bytes"), noted.err);
    }
    write_file(files / "empty.db", "");
    CHECK(contains(run_program({"db", "verify", files / "empty.db"}).out, "is empty"));

    const std::string damaged = damaged_copy(files);
    const Json report = run_json({"db", "verify", damaged, "--report"}, 5);
    CHECK(report["is_clean"] == false);
    REQUIRE(report["damages"].size() == 1);
    CHECK(report["damages"][0]["id"] == 1);
    CHECK(report["damages"][0]["is_quarantined"] == false);
    CHECK(run_program({"db", "info", damaged}).exit_code == 5);

    const ProgramRun cured = run_program({"db", "verify", damaged});
    CHECK(cured.exit_code == 5);
    CHECK(contains(cured.out, "row 1: "));
    CHECK(contains(cured.out, "(set aside)"));
    CHECK(run_json({"db", "verify", damaged})["is_clean"] == true);
    CHECK(run_json({"db", "info", damaged})["tombstones"] == 1);

    CHECK(run_json({"db", "merge", damaged, files.database()})["added"] == 1);
    CHECK(run_json({"db", "compact", damaged})["removed"] == 1);
    CHECK(run_json({"db", "info", damaged})["samplers"] == 1);
  }

  TEST_CASE("what verify quotes from a damaged file is printed, not obeyed") {
    const PlanarFiles files;
    std::string bytes = read_file(files.database());
    const std::size_t at = bytes.find("epoch INTEGER");
    REQUIRE(at != std::string::npos);
    bytes.replace(at, 13, "epoch INT\x1bGER");
    write_file(files / "damaged.db", bytes);
    const ProgramRun run = run_program({"db", "verify", files / "damaged.db", "--report"});
    CHECK(run.exit_code == 5);
    CHECK_MESSAGE(contains(run.out, "\\x1b"), run.out);
    CHECK_FALSE(contains(run.out, "\x1b"));
  }

  TEST_CASE("merging, exporting and importing give the same set") {
    const PlanarFiles files;
    const Json merged =
        run_json({"db", "merge", files / "all.db", files.database(), files.database()});
    CHECK(merged["read"] == 2);
    CHECK(merged["added"] == 1);
    const std::string file = files / "rows.jsonl", again = files / "again.jsonl";
    CHECK(run_json({"db", "export", files.database(), file})["rows"] == 1);
    CHECK(run_json({"db", "import", files / "new.db", file})["added"] == 1);
    CHECK(run_json({"db", "import", files / "all.db", file})["added"] == 0);
    require_run({"db", "export", files / "new.db", again});
    CHECK(read_file(file) == read_file(again));
    CHECK(contains(read_file(files / "rows.jsonl"), "mneme experience 3"));
  }
}

TEST_SUITE("unit") {
  TEST_CASE("wrong upkeep ends with a message and an exit code") {
    const PlanarFiles files;
    std::filesystem::copy_file(source_file("tests/engines/schema3.db"), files / "other.db");
    const std::string database = files.database();
    check_bad_inputs({
        {{"db", "merge", database}, 2, {"FROM is required"}},
        {{"db", "export", database}, 2, {"FILE is required"}},
        {{"db", "export", database, files / "rows.csv"}, 1, {".jsonl"}},
        {{"db", "import", database, files / "none.jsonl"}, 1, {"none.jsonl"}},
        {{"db", "merge", database, files / "other.db"}, 5, {"'arm'"}},
        {{"db", "verify", files / "missing.db"}, 1, {"missing.db"}},
        {{"db", "compact", files / "missing.db"}, 1, {"missing.db"}},
    });
    CHECK_FALSE(std::filesystem::exists(files / "missing.db"));
  }
}

}  // namespace
}  // namespace mneme::test
