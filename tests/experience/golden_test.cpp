// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

namespace mneme::test {
namespace {

/// What tests/experience/schema3.db was made from.
std::vector<Experience> golden_rows() {
  Experience full;
  full.kind = kPairs;
  full.key = {3.5, 1.25, 1, 3.5, -1.25, 1.5};
  full.sampler = {3, {0.5f, -1, 2, 3, 0.25f, -0.125f}, {-1, 0}, {1, 0.5f, 1, 0, 0.25f, 2}, {4, -1}};
  full.provenance = {"mneme 0.1.0", "starts-per-link=3", 0xfedcba9876543210u,
                     "2020-01-02T03:04:05Z"};
  Experience empty;
  empty.kind = kPairs;
  empty.key = {2, 0.5, 1, 6, -0.5, 2};
  empty.sampler.joint_count = 3;
  empty.provenance = {"mneme 0.1.0", "", 1, "2020-01-02T03:04:06Z"};
  return {full, empty};
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE(
      "a database that the third schema's first version wrote can be read and added to for ever") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a.db";
    std::filesystem::copy_file(source_file("tests/experience/schema3.db"), path);
    const auto rows = golden_rows();
    {
      Database database = open_database(path, OpenMode::read_write);
      REQUIRE(database.size() == 2);
      CHECK(is_same_content(*database.get(0), rows[0]));
      CHECK(is_same_content(*database.get(1), rows[1]));
      CHECK(database.insert(rows) == std::vector<std::int64_t>{1, 2});
    }
    CHECK(verify_database(path)->empty());
  }
}

}  // namespace mneme::test
