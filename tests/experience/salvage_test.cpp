// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/salvage.h"

#include "experience/database_file.h"
#include "experience/fixtures.h"

namespace mneme::test {

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

    auto connection = internal::open_for_reading(path);
    REQUIRE(connection.has_value());
    std::vector<Damage> damages;
    const auto copy = internal::salvage_file(*connection, damages);
    REQUIRE_MESSAGE(copy.has_value(), (copy ? "" : copy.error().message));
    CHECK(*copy == path + ".damaged");
    CHECK(!std::filesystem::exists(path + ".salvage"));
    CHECK(verify_database(path)->empty());
    CHECK(!verify_database(*copy)->empty());
    const Database database = open_database(path, OpenMode::read_only);
    CHECK(database.size() + static_cast<std::int64_t>(damages.size()) == 60);
    CHECK(!damages.empty());
    CHECK(damages.size() < 20);
    for (std::int64_t i = 0; i < database.size(); ++i) {
      const Experience row = *database.get(i);
      CHECK(is_same_content(row, rows[static_cast<std::size_t>(row.id - 1)]));
    }
  }

  TEST_CASE("without the row that names the robot nothing can be saved") {
    const TemporaryDirectory directory;
    open_database(directory / "a.db");
    run_sql(directory / "a.db", "DELETE FROM space");
    auto connection = internal::open_for_reading(directory / "a.db");
    std::vector<Damage> damages;
    const auto copy = internal::salvage_file(*connection, damages);
    REQUIRE(!copy.has_value());
    CHECK(copy.error().code == ErrorCode::corrupt);
  }
}

}  // namespace mneme::test
