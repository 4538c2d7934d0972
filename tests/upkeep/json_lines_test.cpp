// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/fixtures.h"

namespace mneme::test {
namespace {

void fill(const std::string& path, const std::vector<Experience>& rows) {
  require(open_database(path).insert(rows));
}

std::string exported(const std::string& url, const std::string& path) {
  require(export_database(url, path));
  return read_file(path);
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("equal sets give equal files, and a file gives the set back") {
    const TemporaryDirectory directory;
    Rng rng(12);
    auto rows = random_rows(rng, 20);
    rows[4].sampler() = {};
    fill(directory / "a.db", rows);
    std::reverse(rows.begin(), rows.end());
    fill(directory / "b.db", rows);
    const std::string bytes = exported(directory / "a.db", directory / "a.jsonl");
    CHECK(bytes == exported(directory / "b.db", directory / "b.jsonl"));
    CHECK(require(import_database(directory / "copy.db", directory / "a.jsonl")).added == 20);
    CHECK(import_database(directory / "copy.db", directory / "a.jsonl")->added == 0);
    CHECK(verify_database(directory / "copy.db")->empty());
    CHECK(bytes == exported(directory / "copy.db", directory / "c.jsonl"));
  }

  TEST_CASE("a damaged file is refused or gives rows that it held") {
    const std::uint64_t seed = 13;
    const TemporaryDirectory directory;
    Rng rng(seed);
    const auto rows = random_rows(rng, 3, 2);
    fill(directory / "a.db", rows);
    const std::string bytes = exported(directory / "a.db", directory / "a.jsonl");
    for (int i = 0; i < 40; ++i) {
      std::string damaged = bytes;
      const std::size_t position = rng.index(static_cast<std::uint32_t>(bytes.size()));
      damaged[position] = static_cast<char>(damaged[position] ^ (1 << rng.index(7)));
      write_file(directory / "damaged.jsonl", i % 2 == 0 ? damaged : bytes.substr(0, position));
      const std::string copy = directory / ("copy" + std::to_string(i));
      const auto imported = import_database(copy, directory / "damaged.jsonl");
      INFO("seed " << seed << ", byte " << position << ", flip " << (i % 2 == 0));
      if (!std::filesystem::exists(copy)) {
        CHECK(!imported.has_value());
        continue;
      }
      CHECK(verify_database(copy)->empty());
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("names, missing files and other robots are refused") {
    const TemporaryDirectory directory;
    Rng rng(14);
    fill(directory / "a.db", random_rows(rng, 2));
    CHECK(export_database(directory / "a.db", directory / "a.csv").error().code ==
          ErrorCode::invalid);
    CHECK(export_database(directory / "b.db", directory / "b.jsonl").error().code == ErrorCode::io);
    CHECK(export_database(directory / "a.db", directory / "none/a.jsonl").error().code ==
          ErrorCode::io);
    write_file(directory / "empty.db", "");
    CHECK(export_database(directory / "empty.db", directory / "b.jsonl").error().code ==
          ErrorCode::invalid);
    RobotSignature other = arm_signature();
    other.model_hash = "other";
    write_file(directory / "other.db", "");
    require(Database::open(directory / "other.db", other, OpenMode::create));
    exported(directory / "a.db", directory / "a.jsonl");
    CHECK(import_database(directory / "other.db", directory / "a.jsonl").error().code ==
          ErrorCode::wrong_robot);
    CHECK(import_database(directory / "c.db", directory / "none.jsonl").error().code ==
          ErrorCode::io);
    write_file(directory / "text.jsonl", "text");
    const Error error =
        require_error(import_database(directory / "c.db", directory / "text.jsonl"));
    CHECK(error.code == ErrorCode::parse);
    CHECK(error.message.find(directory / "text.jsonl:1: ") == 0);
    CHECK(!std::filesystem::exists(directory / "c.db"));
    // The robot's line is sound, the first row is not.
    const std::string lines = exported(directory / "a.db", directory / "a.jsonl");
    write_file(directory / "cut.jsonl", lines.substr(0, lines.find('\n') + 20));
    CHECK(import_database(directory / "c.db", directory / "cut.jsonl").error().code ==
          ErrorCode::parse);
    CHECK(!std::filesystem::exists(directory / "c.db"));
  }

  TEST_CASE("a line without end is refused, not held in memory") {
    const TemporaryDirectory directory;
    Rng rng(16);
    fill(directory / "a.db", random_rows(rng, 3));
    const std::string text = exported(directory / "a.db", directory / "a.jsonl");
    constexpr std::uintmax_t kFarTooLong = std::uintmax_t{1} << 40;
    for (const auto& [whole_lines, place] :
         {std::pair(std::string(), "b.jsonl:1: "), std::pair(text, "b.jsonl:5: ")}) {
      write_file(directory / "b.jsonl", whole_lines);
      std::filesystem::resize_file(directory / "b.jsonl", kFarTooLong);  // zeros, not on the disk
      const Error error = require_error(import_database(directory / "b.db", directory / "b.jsonl"));
      CHECK(error.code == ErrorCode::unsupported);
      CHECK(contains(error.message, place));
      CHECK(contains(error.message, "at most 67108864 bytes"));
    }
  }

  TEST_CASE("a wrong line is named, and what stood before it may be imported again") {
    const TemporaryDirectory directory;
    Rng rng(15);
    fill(directory / "a.db", random_rows(rng, 3));
    std::string text = exported(directory / "a.db", directory / "a.jsonl");
    write_file(directory / "b.jsonl", text + "{}\n");
    const Error error = require_error(import_database(directory / "b.db", directory / "b.jsonl"));
    CHECK(contains(error.message, "b.jsonl:5: "));
    text.replace(text.find("\"content\""), 9, "\"nothing\"");
    text.replace(text.find("\"key\":["), 7, "\"key\":[9.5,");
    write_file(directory / "c.jsonl", text);
    const Error wrong = require_error(import_database(directory / "b.db", directory / "c.jsonl"));
    CHECK(contains(wrong.message, "c.jsonl:3: its key has 6 numbers; expected 7"));
  }
}

}  // namespace mneme::test
