// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "store/fixtures.h"

#include <cstdlib>

namespace mneme::test {
namespace {

void fill(const std::string& path, const std::vector<Experience>& rows) {
  REQUIRE(open_database(path).insert(rows).has_value());
}

std::string exported(const std::string& url, const std::string& path) {
  const auto count = export_database(url, path);
  REQUIRE_MESSAGE(count.has_value(), (count ? "" : count.error().message));
  return read_file(path);
}

const std::vector<std::string> kFormats = {".jsonl", ".npz"};

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("equal sets give equal files, and a file gives the set back") {
    const TemporaryDirectory directory;
    Rng rng(12);
    auto rows = random_rows(rng, 20);
    rows[4].sampler = {};
    fill(directory / "a.db", rows);
    std::reverse(rows.begin(), rows.end());
    fill(directory / "b.db", rows);
    for (const std::string& format : kFormats) {
      const std::string file = directory / ("a" + format);
      const std::string bytes = exported(directory / "a.db", file);
      CHECK(bytes == exported(directory / "b.db", directory / ("b" + format)));
      const std::string copy = directory / ("copy.db" + format);
      const auto imported = import_database(copy, file);
      REQUIRE_MESSAGE(imported.has_value(), (imported ? "" : imported.error().message));
      CHECK(imported->added == 20);
      CHECK(import_database(copy, file)->added == 0);
      CHECK(verify_database(copy)->empty());
      CHECK(bytes == exported(copy, directory / ("c" + format)));
    }
  }

  TEST_CASE("a damaged file is refused or gives rows that it held") {
    const std::uint64_t seed = 13;
    const TemporaryDirectory directory;
    Rng rng(seed);
    const auto rows = random_rows(rng, 3, 2);
    fill(directory / "a.db", rows);
    for (const std::string& format : kFormats) {
      const std::string bytes = exported(directory / "a.db", directory / ("a" + format));
      for (int i = 0; i < 40; ++i) {
        std::string damaged = bytes;
        const std::size_t position = rng.index(static_cast<std::uint32_t>(bytes.size()));
        damaged[position] = static_cast<char>(damaged[position] ^ (1 << rng.index(7)));
        write_file(directory / ("damaged" + format),
                   i % 2 == 0 ? damaged : bytes.substr(0, position));
        const std::string copy = directory / ("copy" + std::to_string(i) + format);
        const auto imported = import_database(copy, directory / ("damaged" + format));
        INFO("seed " << seed << ", byte " << position << ", flip " << (i % 2 == 0));
        if (!std::filesystem::exists(copy)) {
          CHECK(!imported.has_value());
          continue;
        }
        CHECK(verify_database(copy)->empty());
      }
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
    CHECK(export_database(directory / "b.db", directory / "b.npz").error().code == ErrorCode::io);
    CHECK(export_database(directory / "a.db", directory / "none/a.npz").error().code ==
          ErrorCode::io);
    write_file(directory / "empty.db", "");
    CHECK(export_database(directory / "empty.db", directory / "b.npz").error().code ==
          ErrorCode::invalid);
    ExperienceSpace other = arm_space();
    other.robot_hash = "other";
    REQUIRE(Database::open(directory / "other.db", other, OpenMode::create).has_value());
    for (const std::string& format : kFormats) {
      exported(directory / "a.db", directory / ("a" + format));
      CHECK(import_database(directory / "other.db", directory / ("a" + format)).error().code ==
            ErrorCode::wrong_robot);
      CHECK(import_database(directory / "c.db", directory / ("none" + format)).error().code ==
            ErrorCode::io);
      write_file(directory / ("text" + format), "text");
      const auto text = import_database(directory / "c.db", directory / ("text" + format));
      REQUIRE(!text.has_value());
      CHECK(text.error().code == ErrorCode::parse);
      CHECK(text.error().message.find(directory / ("text" + format)) == 0);
    }
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
      const auto imported = import_database(directory / "b.db", directory / "b.jsonl");
      REQUIRE(!imported.has_value());
      CHECK(imported.error().code == ErrorCode::unsupported);
      CHECK(imported.error().message.find(place) != std::string::npos);
      CHECK(imported.error().message.find("at most 67108864 bytes") != std::string::npos);
    }
  }

  TEST_CASE("a wrong line is named, and what stood before it may be imported again") {
    const TemporaryDirectory directory;
    Rng rng(15);
    fill(directory / "a.db", random_rows(rng, 3));
    std::string text = exported(directory / "a.db", directory / "a.jsonl");
    write_file(directory / "b.jsonl", text + "{}\n");
    const auto imported = import_database(directory / "b.db", directory / "b.jsonl");
    REQUIRE(!imported.has_value());
    CHECK(imported.error().message.find("b.jsonl:5: ") != std::string::npos);
    text.replace(text.find("\"content\""), 9, "\"nothing\"");
    text.replace(text.find("\"key\":["), 7, "\"key\":[9.5,");
    write_file(directory / "c.jsonl", text);
    const auto wrong = import_database(directory / "b.db", directory / "c.jsonl");
    REQUIRE(!wrong.has_value());
    CHECK(wrong.error().message.find("line 3: its key has 6 numbers; expected 7") !=
          std::string::npos);
  }
}

TEST_SUITE("oracle") {
  TEST_CASE("NumPy reads the arrays, and mneme what NumPy saves") {
    const char* python = "/usr/bin/python3";
    if (std::system((std::string(python) + " -c 'import numpy' 2>/dev/null").c_str()) != 0) {
      MESSAGE("skipped: no NumPy");
      return;
    }
    const TemporaryDirectory directory;
    Rng rng(16);
    auto rows = random_rows(rng, 4);
    rows[0].provenance.settings = "Gr\u00fc\u00dfe";
    fill(directory / "a.db", rows);
    const std::string bytes = exported(directory / "a.db", directory / "a.npz");
    write_file(directory / "check.py",
               "import numpy as np, sys\n"
               "a = np.load(sys.argv[1])\n"
               "assert str(a['robot_name']) == 'arm'\n"
               "assert a['keys'].shape == (24,) and a['keys'].dtype == np.float64\n"
               "assert list(a['key_ends']) == [6, 12, 18, 24]\n"
               "assert list(a['kinds'][a['kind_rows']]) == ['pairs/1'] * 4\n"
               "assert a['means'].shape == (20, 3) and a['means'].dtype == np.float32\n"
               "assert list(a['mean_ends']) == [5, 10, 15, 20]\n"
               "assert 'Gr\u00fc\u00dfe' in list(a['settings'])\n"
               "assert a['seeds'].dtype == np.uint64\n"
               "np.savez(sys.argv[2], **a)\n"
               "np.savez_compressed(sys.argv[3], **a)\n");
    const std::string command = std::string(python) + " " + (directory / "check.py") + " " +
                                (directory / "a.npz") + " " + (directory / "b.npz") + " " +
                                (directory / "c.npz");
    REQUIRE(std::system(command.c_str()) == 0);
    REQUIRE(import_database(directory / "b.db", directory / "b.npz").has_value());
    CHECK(exported(directory / "b.db", directory / "d.npz") == bytes);
    CHECK(import_database(directory / "c.db", directory / "c.npz").error().code ==
          ErrorCode::unsupported);
  }
}

}  // namespace mneme::test
