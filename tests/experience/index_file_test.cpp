// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engines/fixtures.h"
#include "experience/index_file.h"
#include "support/environment.h"

namespace mneme::test {
namespace {

using internal::ExperienceIndex;
using internal::GroupIndexes;
using internal::StoreState;

constexpr StoreState kState = {7, 2, 300, 4, 290, 5, 4, 6};

GroupIndexes make_index() {
  Rng rng(91);
  GroupIndexes kinds;
  ExperienceIndex& pairs = kinds.try_emplace({kPairs}, 6).first->second;
  for (int i = 0; i < 300; ++i) pairs.append({{i + 1}, {3}, random_key(rng)});
  ExperienceIndex& others = kinds.try_emplace({kPairs, 7}, 6).first->second;
  for (int i = 0; i < 50; ++i) others.append({{i + 301}, {4}, random_key(rng)});
  kinds.try_emplace({"trios/1"}, 3).first->second.append({{351}, {2}, {1, 2, 3}});
  return kinds;
}

bool is_same(const ExperienceIndex& a, const ExperienceIndex& b) {
  Rng rng(92);
  if (a.size() != b.size() || a.components() != b.components() || a.key_size() != b.key_size()) {
    return false;
  }
  for (int i = 0; i < 20 && a.key_size() == 6; ++i) {
    const auto query = keys_of(random_key(rng));
    const auto one = a.find(query, 3, 9);
    const auto other = b.find(query, 3, 9);
    if (!std::ranges::equal(one, other, {}, &internal::IndexMatch::id, &internal::IndexMatch::id)) {
      return false;
    }
  }
  return true;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("an index that was saved is the same when it is read, and so is the state") {
    const TemporaryDirectory directory;
    const std::string file = internal::index_file_of(directory / "a.db");
    CHECK(file == directory / "a.db.index");
    CHECK(!internal::load_index(file, arm_signature()).has_value());
    const GroupIndexes kinds = make_index();
    REQUIRE(internal::save_index(file, arm_signature(), kState, kinds));
    const auto saved = require(internal::load_index(file, arm_signature()));
    CHECK(saved.state == kState);
    REQUIRE(saved.groups.size() == 3);
    for (const auto& [kind, index] : kinds) CHECK(is_same(saved.groups.at(kind), index));
  }

  TEST_CASE("the index of another space is not used") {
    const TemporaryDirectory directory;
    REQUIRE(internal::save_index(directory / "i", arm_signature(), kState, make_index()));
    RobotSignature other = arm_signature();
    other.model_hash = "another";
    CHECK(!internal::load_index(directory / "i", other).has_value());
    other = arm_signature();
    other.joint_count = 7;
    CHECK(!internal::load_index(directory / "i", other).has_value());
  }

  TEST_CASE("where nothing can be written, nothing is saved") {
    const TemporaryDirectory directory;
    write_file(directory / "none", "");
    CHECK(!internal::save_index(directory / "none/i", arm_signature(), kState, make_index()));
  }

  TEST_CASE("the index of a server stands in the user's cache, and no password in its name") {
    const TemporaryDirectory directory;
    const EnvironmentVariable cache("XDG_CACHE_HOME", directory / "cache");
    const std::string file = internal::index_file_of("postgresql://me:secret@host/arm");
    CHECK(file.starts_with(directory / "cache/mneme/index-"));
    CHECK(file == internal::index_file_of("postgresql://me:other@host/arm"));
    CHECK(file != internal::index_file_of("postgresql://me:other@host/leg"));
    REQUIRE(internal::save_index(file, arm_signature(), kState, make_index()));
    CHECK(internal::load_index(file, arm_signature()).has_value());
  }
}

TEST_SUITE("law") {
  TEST_CASE("an index file with any bit flipped, or cut short anywhere, is not used") {
    const std::uint64_t seed = 93;
    const TemporaryDirectory directory;
    REQUIRE(internal::save_index(directory / "i", arm_signature(), kState, make_index()));
    const std::string sound = read_file(directory / "i");
    Rng rng(seed);
    for (int i = 0; i < 300; ++i) {
      std::string bytes = sound;
      const std::size_t at = rng.index(bytes.size());
      if (i % 3 == 0) {
        bytes.resize(at);
      } else {
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << rng.index(8)));
      }
      write_file(directory / "i", bytes);
      INFO("seed " << seed << ", change " << i);
      REQUIRE(!internal::load_index(directory / "i", arm_signature()).has_value());
    }
  }
}

}  // namespace mneme::test
