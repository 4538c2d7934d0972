// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/npz_rows.h"

#include "experience/fixtures.h"

namespace mneme::test {
namespace {

using internal::NpyArray;

std::map<std::string, NpyArray> arrays_of(const std::vector<Experience>& rows) {
  internal::NpzColumns columns(arm_space());
  for (const Experience& row : rows) columns.add(row);
  std::map<std::string, NpyArray> arrays;
  for (auto& [name, array] : columns.arrays()) arrays.emplace(name, array);
  return arrays;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("rows of any size come back from columns") {
    Rng rng(10);
    std::vector<Experience> rows;
    for (const int components : {3, 0, 1, 7}) rows.push_back(random_experience(rng, components));
    rows[1].sampler.factors.clear();
    rows[2].sampler.factor_rows.clear();
    rows[3].provenance.settings = "";
    rows[2].kind = "trios/1";
    rows[2].key = {1, 2, 3};
    const auto read = internal::rows_of(arrays_of(rows));
    REQUIRE_MESSAGE(read.has_value(), (read ? "" : read.error().message));
    CHECK(read->space.robot_name == "arm");
    CHECK(read->space.joint_count == 3);
    REQUIRE(read->rows.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) CHECK(is_same_content(read->rows[i], rows[i]));
    CHECK(internal::rows_of(arrays_of({}))->rows.empty());
  }

  TEST_CASE("an array that is missing or does not fit is named") {
    Rng rng(11);
    const auto sound = arrays_of(random_rows(rng, 3));
    for (const auto& entry : sound) {
      auto arrays = sound;
      arrays.erase(entry.first);
      const auto missing = internal::rows_of(arrays);
      REQUIRE(!missing.has_value());
      CHECK(missing.error().code == ErrorCode::parse);
      CHECK_MESSAGE(missing.error().message.find("'" + entry.first + "'") != std::string::npos,
                    missing.error().message);
      // The same bytes as something else, or too few of them.
      arrays = sound;
      arrays[entry.first].type = "<f2";
      CHECK(!internal::rows_of(arrays).has_value());
    }
    const auto refused = [&](const std::string& name, std::vector<std::int64_t> numbers) {
      auto arrays = sound;
      const std::size_t size = numbers.size();
      arrays[name] = internal::to_npy(std::span<const std::int64_t>(numbers), {size});
      return !internal::rows_of(arrays).has_value();
    };
    CHECK(!refused("mean_ends", {5, 10, 15}));
    CHECK(refused("mean_ends", {5, 10, 16}));
    CHECK(refused("mean_ends", {10, 5, 15}));
    CHECK(refused("mean_ends", {-5, 10, 15}));
    CHECK(refused("mean_ends", {5, 15}));
    CHECK(!refused("key_ends", {6, 12, 18}));
    CHECK(refused("key_ends", {6, 12, 19}));
    CHECK(refused("key_ends", {-6, 12, 18}));
    auto arrays = sound;
    const std::vector<std::int32_t> places = {0, 0, 9};
    for (const char* name : {"tool_rows", "kind_rows"}) {
      arrays = sound;
      arrays[name] = internal::to_npy(std::span<const std::int32_t>(places), {3});
      CHECK(!internal::rows_of(arrays).has_value());
    }
    arrays = sound;
    const std::int64_t joints = 4;
    arrays["joint_count"] = internal::to_npy(std::span(&joints, 1), {});
    CHECK(!internal::rows_of(arrays).has_value());
  }

  TEST_CASE("one long text that all rows share cannot fill the memory") {
    Rng rng(12);
    auto rows = random_rows(rng, 400);
    const auto refused = [&](std::size_t length) {
      for (Experience& row : rows) row.provenance.settings = std::string(length, 's');
      const auto read = internal::rows_of(arrays_of(rows));
      return read ? std::string() : read.error().message;
    };
    CHECK(refused(2000) == "");
    CHECK(refused(100'000) == "array 'settings' has long texts that too many rows share");
  }
}

}  // namespace mneme::test
