// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/fixtures.h"
#include "upkeep/page_file.h"

#include <limits>

namespace mneme::test {
namespace {

using internal::Field;
using internal::LeafRecord;
using internal::PageFile;
using internal::RecordPlace;

/// All records of `path` that have `field_count` fields, with copies of their bytes.
std::vector<LeafRecord> records_of(const std::string& path, std::size_t field_count) {
  auto file = PageFile::open(path);
  REQUIRE(file.has_value());
  std::vector<RecordPlace> places;
  REQUIRE(file->visit_records([&](const LeafRecord& record, RecordPlace place) {
    if (record.fields.size() == field_count) places.push_back(place);
  }));
  std::vector<LeafRecord> records(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    REQUIRE(file->read_record(places[i], records[i]));
  }
  return records;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("values of all kinds and sizes are read as SQLite wrote them") {
    for (const int page_size : {512, 8192, 65536}) {
      INFO("pages of " << page_size);
      const TemporaryDirectory directory;
      const std::string path = directory / "a.db";
      std::string sql = "PRAGMA page_size = " + std::to_string(page_size) +
                        "; CREATE TABLE t (id INTEGER PRIMARY KEY, value, size, more);";
      std::vector<std::int64_t> numbers = {0, 1, std::numeric_limits<std::int64_t>::max()};
      for (int bit = 1; bit < 63; ++bit) numbers.push_back(-(std::int64_t{1} << bit));
      for (const std::int64_t number : numbers) {
        sql +=
            "INSERT INTO t (value, size, more) VALUES (" + std::to_string(number) + ", NULL, 0.5);";
      }
      // Lengths around those at which a record leaves its page.
      std::vector<std::int64_t> lengths = {0, 1, 40, 476, 477, 478, 8150, 8190, 20000, 70000};
      for (const std::int64_t length : lengths) {
        const std::string text = std::to_string(length);
        sql += "INSERT INTO t (value, size, more) VALUES (zeroblob(" + text + "), " + text +
               ", 'end');";
      }
      run_sql(path, "BEGIN;" + sql.substr(sql.find(';') + 1) + "COMMIT");
      const auto records = records_of(path, 4);
      REQUIRE(records.size() == numbers.size() + lengths.size());
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        CHECK(records[i].id == static_cast<std::int64_t>(i) + 1);
        CHECK(records[i].fields[1].kind == Field::Kind::integer);
        CHECK(records[i].fields[1].integer == numbers[i]);
        CHECK(records[i].fields[2].kind == Field::Kind::null);
        CHECK(records[i].fields[3].kind == Field::Kind::real);
      }
      for (std::size_t i = 0; i < lengths.size(); ++i) {
        const LeafRecord& record = records[numbers.size() + i];
        CHECK(record.fields[1].kind == Field::Kind::blob);
        CHECK(static_cast<std::int64_t>(record.fields[1].bytes.size()) == lengths[i]);
        CHECK(record.fields[3].text() == "end");
      }
    }
  }

  TEST_CASE("a file that is not there is an error, and one without pages has no records") {
    const TemporaryDirectory directory;
    CHECK(PageFile::open(directory / "none.db").error().code == ErrorCode::io);
    write_file(directory / "a.db", "");
    CHECK(records_of(directory / "a.db", 4).empty());
    auto file = PageFile::open(directory / "a.db");
    LeafRecord record;
    CHECK(file->read_record({1, 0}, record).error().code == ErrorCode::corrupt);
  }
}

TEST_SUITE("law") {
  TEST_CASE("whatever the bytes are, records end within the file") {
    const std::uint64_t seed = 23;
    const TemporaryDirectory directory;
    Rng rng(seed);
    REQUIRE(open_database(directory / "sound.db").insert(random_rows(rng, 20, 900)));
    const std::string sound = read_file(directory / "sound.db");
    for (int i = 0; i < rounds(60); ++i) {
      std::string bytes = sound;
      for (int k = 0; k < 3000; ++k) {
        // Headers, cell pointers and links stand at the beginnings of pages.
        const std::size_t page = 8192 * rng.index(static_cast<std::uint32_t>(bytes.size() / 8192));
        bytes[page + rng.index(k % 2 == 0 ? 8192 : 64)] = static_cast<char>(rng.index(256));
        if (k % 2 == 0 && rng.index(4) == 0) bytes[page] = '\x0d';
      }
      write_file(directory / "a.db", bytes);
      auto file = PageFile::open(directory / "a.db");
      REQUIRE(file.has_value());
      INFO("seed " << seed << ", round " << i);
      REQUIRE(file->visit_records([&](const LeafRecord& record, RecordPlace) {
        REQUIRE(record.payload.size() <= bytes.size());
        for (const Field& field : record.fields) {
          if (field.bytes.empty()) continue;
          REQUIRE(field.bytes.data() >= record.payload.data());
          REQUIRE(field.bytes.size() <= record.payload.size());
        }
      }));
    }
  }
}

}  // namespace mneme::test
