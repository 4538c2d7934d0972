// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/fixtures.h"
#include "store/row_codec.h"
#include "store/store.h"
#include "support/support.h"

namespace mneme::test {
namespace {

using internal::decode;
using internal::EncodedRow;

Experience small_experience() {
  Experience experience;
  experience.kind = "pairs/1";
  experience.key = {1, 0, 0.5, 2, 0, 0.25};
  experience.sampler() = {{3, {1, -2, 0.5}, {0}, {1, 0, 1, 0, 0, 1}, {7}}};
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
    CHECK(numbers(row.view().sources) == std::vector<int>{7, 0, 0, 0});
  }

  TEST_CASE("the checksum of a given row never changes, or old databases would be refused") {
    const Experience experience = small_experience();
    CHECK(internal::tally_mark(1, 2) == 571542372673154031);
  }

  TEST_CASE("the hashes that stand in a row never change either") {
    const Experience experience = small_experience();
    const EncodedRow row(experience);
    CHECK(internal::to_hex(row.content()) == "ce96cb77b71e38636d0208a4b016389e");
    CHECK(row.stored(1, 2).cell == 3478204592965225839);
    CHECK(row.stored(1, 2).key_checksum == -8915780391647370358);
    CHECK(row.stored(1, 2).mixture_checksum == -7632092406060501043);
  }

  TEST_CASE("a row whose checksums do not fit, or whose parts are of two rows, is refused") {
    const Experience experience = small_experience();
    const EncodedRow row(experience);
    const internal::StoredRow sound = row.stored(5, 1);
    Experience copy;
    CHECK(!decode(sound, arm_signature(), copy).has_value());
    CHECK(copy.id == 5);
    const std::vector<std::function<void(internal::StoredRow&)>> changes = {
        [](auto& r) { ++r.id; },
        [](auto& r) { ++r.generation; },
        [](auto& r) { ++r.cell; },
        [](auto& r) { ++r.components; },
        [](auto& r) { ++r.key_checksum; },
        [](auto& r) { ++r.mixture_checksum; },
        [](auto& r) { ++r.columns.seed; },
        [](auto& r) { r.columns.time = "later"; },
        [](auto& r) { r.content = r.content.first(15); },
        [](auto& r) { r.flaw = "known before"; }};
    for (std::size_t i = 0; i < changes.size(); ++i) {
      INFO("change " << i);
      internal::StoredRow changed = sound;
      changes[i](changed);
      CHECK(decode(changed, arm_signature(), copy).has_value());
    }
    // Each record is sound, but they do not belong together.
    Experience other = experience;
    other.sampler().means[0] = 3;
    const EncodedRow other_row(other);
    internal::StoredRow mixed = sound;
    mixed.columns.means = other_row.view().means;
    mixed.mixture_checksum = internal::mixture_checksum(mixed);
    CHECK(contains(decode(mixed, arm_signature(), copy).value_or(""), "does not match"));
  }

  TEST_CASE("a key can be decoded without its mixture") {
    const Experience experience = small_experience();
    const EncodedRow row(experience);
    internal::StoredRow key = row.stored(5, 1);
    key.columns.means = {};
    Experience copy;
    CHECK(!internal::decode_key(key, copy).has_value());
    CHECK(copy.id == 5);
    CHECK(copy.key == experience.key);
    CHECK(copy.kind == experience.kind);
    key.columns.kind = "trios/1";
    CHECK(internal::decode_key(key, copy).has_value());
  }

  TEST_CASE("columns of another shape are refused") {
    const Experience experience = small_experience();
    const EncodedRow row(experience);
    RobotSignature space = arm_signature();
    space.joint_count = 2;
    Experience copy;
    CHECK(decode(row.stored(5, 1), space, copy).has_value());
    internal::StoredRow cut = row.stored(5, 1);
    cut.columns.means = cut.columns.means.first(11);
    cut.mixture_checksum = internal::mixture_checksum(cut);
    CHECK(decode(cut, arm_signature(), copy) == "a column ends in the middle of a number");
  }

  TEST_CASE("keys within a metre share a cell, and those beyond do not") {
    CHECK(internal::cell_of({0.1, 5, -0.2}) == internal::cell_of({0.9, 5.5, -0.9}));
    CHECK(internal::cell_of({0.1, 5, -0.2}) != internal::cell_of({0.1, 5, 0.2}));
    CHECK(internal::cell_of({1, 2}) != internal::cell_of({2, 1}));
  }
}

TEST_SUITE("law") {
  TEST_CASE("what is encoded is decoded to the same experience") {
    Rng rng(42);
    for (int i = 0; i < 200; ++i) {
      const Experience experience = random_experience(rng, static_cast<int>(rng.index(20)));
      const EncodedRow row(experience);
      Experience copy;
      const auto flaw = decode(row.stored(i + 1, 1), arm_signature(), copy);
      REQUIRE_MESSAGE(!flaw.has_value(), flaw.value_or(""));
      REQUIRE(is_same_content(experience, copy));
    }
  }

  TEST_CASE("every column counts for the checksums, and where one ends and the next begins") {
    const Experience original = small_experience();
    const auto checksums = [](const Experience& experience) {
      const EncodedRow row(experience);
      const internal::StoredRow stored = row.stored(1, 1);
      return std::pair(stored.key_checksum, stored.mixture_checksum);
    };
    const auto sound = checksums(original);
    const std::vector<std::function<void(Experience&)>> changes = {
        [](Experience& e) { e.kind += "2"; },
        [](Experience& e) { e.key[1] = 1e-300; },
        [](Experience& e) { e.sampler().means[2] += 1e-6f; },
        [](Experience& e) { e.sampler().factor_rows[0] = -1; },
        [](Experience& e) { e.sampler().factors[0] = 2; },
        [](Experience& e) { e.sampler().sources[0] = 8; },
        [](Experience& e) { std::swap(e.sampler().factor_rows, e.sampler().sources); },
        [](Experience& e) { e.sampler().is_complete = false; },
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
      const auto [key, mixture] = checksums(changed);
      CHECK((key != sound.first || i > 1));
      CHECK((mixture != sound.second || i < 2));
    }
  }

  TEST_CASE("the content hash is that of kind, key and content, and of no provenance") {
    const Experience original = small_experience();
    const auto hash = EncodedRow(original).content();
    const auto hash_after = [&](const std::function<void(Experience&)>& change) {
      Experience changed = original;
      change(changed);
      return EncodedRow(changed).content();
    };
    CHECK(hash == hash_after([](Experience& e) { e.id = 7; }));
    CHECK(hash == hash_after([](Experience& e) { e.provenance.tool = "mneme 9"; }));
    CHECK(hash == hash_after([](Experience& e) { e.provenance.time = "2030"; }));
    CHECK(hash != hash_after([](Experience& e) { e.kind = "other/1"; }));
    CHECK(hash != hash_after([](Experience& e) { e.key[2] += 1e-12; }));
    CHECK(hash != hash_after([](Experience& e) { e.sampler().means[0] = -1; }));
    CHECK(hash != hash_after([](Experience& e) { e.sampler().factor_rows.clear(); }));
    CHECK(hash != hash_after([](Experience& e) { e.sampler().factors[1] = 2; }));
    CHECK(hash != hash_after([](Experience& e) { e.sampler().sources[0] = 0; }));
    CHECK(hash != hash_after([](Experience& e) { e.sampler().is_complete = false; }));
    CHECK(hash == hash_after([](Experience& e) { e.provenance.settings += "x"; }));
    CHECK(hash == hash_after([](Experience& e) { ++e.provenance.seed; }));
    RememberedPath path{3, original.sampler().means, 0, {}};
    const auto path_hash = [&] { return hash_after([&](Experience& e) { e.content = path; }); };
    const auto hash_of_path = path_hash();
    CHECK(hash_of_path != hash);
    path.planning_states = 7;
    CHECK(path_hash() == hash_of_path);
    path.constraints = 8;
    CHECK(path_hash() != hash_of_path);
    path.constraints = 0;
    path.clearances.assign(static_cast<std::size_t>(path.waypoint_count()), 0.25f);
    CHECK(path_hash() != hash_of_path);
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a state is its numbers in the order of the columns") {
    const internal::StoreState state{1, 2, 3, 4, 5, 6, 7, 8};
    const auto numbers = internal::to_numbers(state);
    CHECK(numbers == std::array<std::int64_t, 8>{1, 2, 3, 4, 5, 6, 7, 8});
    CHECK(internal::to_state(numbers) == state);
  }

  TEST_CASE("every part of a tombstone and of a signature counts for its checksum") {
    const internal::Tombstone tombstone{1, 2, 3, "reason", "time", 0};
    for (const internal::Tombstone& other : {internal::Tombstone{2, 2, 3, "reason", "time", 0},
                                             {1, 1, 3, "reason", "time", 0},
                                             {1, 2, 4, "reason", "time", 0},
                                             {1, 2, 3, "other", "time", 0},
                                             {1, 2, 3, "reason", "late", 0}}) {
      CHECK(checksum_of(other) != checksum_of(tombstone));
    }
    const RobotSignature robot{"arm", "89", "0123", 3};
    for (const RobotSignature& other : {RobotSignature{"leg", "89", "0123", 3},
                                        {"arm", "8", "90123", 3},
                                        {"arm", "89", "0124", 3},
                                        {"arm", "89", "0123", 4}}) {
      CHECK(internal::checksum_of(other) != internal::checksum_of(robot));
    }
  }
}

}  // namespace mneme::test
