// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/fixtures.h"

#include "experience/row_codec.h"

namespace mneme::test {
namespace {

using internal::checksum_of;
using internal::decode;
using internal::EncodedRow;

Experience small_experience() {
  Experience experience;
  experience.key = {1, 0, 0.5, 2, 0, 0.25};
  experience.sampler = {3, {1, -2, 0.5}, {0}, {1, 0, 1, 0, 0, 1}, {7}};
  experience.provenance = {"tool", "settings", 0xfedcba9876543210u, "2020-01-02T03:04:05Z"};
  return experience;
}

std::vector<int> numbers(std::span<const std::byte> bytes) {
  std::vector<int> result;
  for (const std::byte byte : bytes) result.push_back(std::to_integer<int>(byte));
  return result;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("numbers are stored in little-endian order") {
    const Experience experience = small_experience();
    const EncodedRow row(experience);
    CHECK(numbers(row.view().means) ==
          std::vector<int>{0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0, 0, 0, 0, 0x3f});
    CHECK(numbers(row.view().key.first(8)) == std::vector<int>{0, 0, 0, 0, 0, 0, 0xf0, 0x3f});
    CHECK(numbers(row.view().origins) == std::vector<int>{7, 0, 0, 0});
  }

  TEST_CASE("the checksum of a given row never changes, or old databases would be refused") {
    const Experience experience = small_experience();
    CHECK(checksum_of(EncodedRow(experience).view()) == 2177887054044674719);
    CHECK(internal::tally_mark(1, 2) == 571542372673154031);
  }

  TEST_CASE("a row whose checksum does not fit is refused") {
    const Experience experience = small_experience();
    const EncodedRow row(experience);
    const std::int64_t checksum = checksum_of(row.view());
    Experience copy;
    CHECK(!decode(row.view(), checksum, arm_space(), copy).has_value());
    const auto flaw = decode(row.view(), checksum + 1, arm_space(), copy);
    REQUIRE(flaw.has_value());
    CHECK(flaw->find("checksum") != std::string::npos);
  }

  TEST_CASE("a row of another shape is refused even if its checksum fits") {
    const Experience experience = small_experience();
    const EncodedRow row(experience);
    ExperienceSpace space = arm_space();
    space.joint_count = 2;
    Experience copy;
    CHECK(decode(row.view(), checksum_of(row.view()), space, copy).has_value());
    internal::RowView cut = row.view();
    cut.means = cut.means.first(11);
    CHECK(decode(cut, checksum_of(cut), arm_space(), copy) ==
          "a column ends in the middle of a number");
  }
}

TEST_SUITE("law") {
  TEST_CASE("what is encoded is decoded to the same experience") {
    Rng rng(42);
    for (int i = 0; i < 200; ++i) {
      const Experience experience = random_experience(rng, static_cast<int>(rng.index(20)));
      const EncodedRow row(experience);
      Experience copy;
      const auto flaw = decode(row.view(), checksum_of(row.view()), arm_space(), copy);
      REQUIRE_MESSAGE(!flaw.has_value(), flaw.value_or(""));
      REQUIRE(is_same_content(experience, copy));
    }
  }

  TEST_CASE("every column counts for the checksum, and where one ends and the next begins") {
    const Experience original = small_experience();
    const std::int64_t checksum = checksum_of(EncodedRow(original).view());
    const std::vector<std::function<void(Experience&)>> changes = {
        [](Experience& e) { e.key[1] = 1e-300; },
        [](Experience& e) { e.sampler.means[2] += 1e-6f; },
        [](Experience& e) { e.sampler.factor_rows[0] = -1; },
        [](Experience& e) { e.sampler.factors[0] = 2; },
        [](Experience& e) { e.sampler.origins[0] = 8; },
        [](Experience& e) { std::swap(e.sampler.factor_rows, e.sampler.origins); },
        [](Experience& e) { e.provenance.seed ^= 1; },
        [](Experience& e) { e.provenance.time += " "; },
        [](Experience& e) {
          e.provenance.tool = "tools";
          e.provenance.settings = "ettings";
        }};
    for (std::size_t i = 0; i < changes.size(); ++i) {
      Experience changed = original;
      changes[i](changed);
      INFO("change " << i);
      CHECK(checksum_of(EncodedRow(changed).view()) != checksum);
    }
    Experience renumbered = original;
    renumbered.id = 99;
    CHECK(checksum_of(EncodedRow(renumbered).view()) == checksum);
  }
}

}  // namespace mneme::test
