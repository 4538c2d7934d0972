// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "store/fixtures.h"

#include <set>

namespace mneme::test {
namespace {

constexpr int kRowCount = 40;

std::string sound_file(const std::string& path) {
  Rng rng(81);
  {
    Database database = open_database(path);
    for (int i = 0; i < kRowCount / 4; ++i) REQUIRE(database.insert(random_rows(rng, 4, 30)));
  }
  return read_file(path);
}

void remove_database(const std::string& path) {
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
    std::filesystem::remove(path + suffix);
  }
}

bool has_same_rows(const Database& a, const Database& b) {
  if (a.size() != b.size()) return false;
  for (std::int64_t i = 0; i < a.size(); ++i) {
    if (a.get(i)->id != b.get(i)->id || !is_same_content(*a.get(i), *b.get(i))) return false;
  }
  return true;
}

/// True if the bytes of `values` stand somewhere in `file`.
template <typename Values>
bool holds(const std::string& file, const Values& values) {
  return file.find(std::string_view(reinterpret_cast<const char*>(values.data()),
                                    values.size() * sizeof values[0])) != std::string::npos;
}

bool has_row(const Database& database, std::int64_t id) {
  for (std::int64_t i = 0; i < database.size(); ++i) {
    if (database.get(i)->id == id) return true;
  }
  return false;
}

/// True if the file is either refused, and then known to be damaged, or as good as the sound one.
bool is_refused_or_sound(const std::string& path, const Database& sound) {
  const auto opened = Database::open(path, arm_space(), OpenMode::read_only);
  const auto damages = verify_database(path);
  if (opened) return has_same_rows(*opened, sound);
  const bool is_known_reason =
      opened.error().code == ErrorCode::corrupt || opened.error().code == ErrorCode::unsupported;
  return is_known_reason && (!damages || !damages->empty());
}

/// True if a row can be added without harm to those there are, or is refused. What nobody reads,
/// such as the index of contents, may be damaged unnoticed until it is verified.
bool can_grow_or_is_refused(const std::string& path, const Experience& row) {
  {
    auto opened = Database::open(path, arm_space(), OpenMode::read_write);
    if (!opened || !opened->insert({row})) return true;
  }
  (void)verify_database(path, VerifyMode::quarantine);
  const auto reopened = Database::open(path, arm_space(), OpenMode::read_only);
  return reopened && reopened->size() == kRowCount + 1 && verify_database(path)->empty();
}

/// Puts `verify` with quarantine to the test: afterwards the file is sound and holds nothing but
/// rows of the original, or it is refused.
bool is_cured_or_refused(const std::string& path, const Database& sound, std::int64_t& lost) {
  const auto damages = verify_database(path, VerifyMode::quarantine);
  const auto opened = Database::open(path, arm_space(), OpenMode::read_only);
  if (!damages) return !opened;
  if (!opened) return !damages->empty() && !damages->front().is_quarantined;
  std::set<std::int64_t> ids;
  for (std::int64_t i = 0; i < opened->size(); ++i) {
    const std::int64_t id = opened->get(i)->id;
    if (id < 1 || id > kRowCount || !ids.insert(id).second) return false;
    if (!is_same_content(*opened->get(i), *sound.get(id - 1))) return false;
  }
  lost += kRowCount - opened->size();
  std::set<std::int64_t> named;
  for (const Damage& damage : *damages) named.insert(damage.id);
  // Whatever is not there any more was named.
  for (std::int64_t id = 1; id <= kRowCount; ++id) {
    if (!ids.contains(id) && !named.contains(id)) return false;
  }
  return verify_database(path)->empty();
}

std::string flipped(std::string bytes, std::size_t position, int bit) {
  bytes[position] = static_cast<char>(bytes[position] ^ (1 << bit));
  return bytes;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("after a flipped bit the sound rows can be saved, and the others are named") {
    const std::uint64_t seed = 84;
    const TemporaryDirectory directory;
    const std::string bytes = sound_file(directory / "sound.db");
    const Database sound = open_database(directory / "sound.db", OpenMode::read_only);
    Rng rng(seed);
    std::int64_t lost = 0;
    int opened = 0;
    const int count = rounds(100);
    for (int i = 0; i < count; ++i) {
      const std::size_t position = i < 100 && i % 2 == 0
                                       ? static_cast<std::size_t>(i)
                                       : rng.index(static_cast<std::uint32_t>(bytes.size()));
      const int bit = static_cast<int>(rng.index(8));
      write_file(directory / "a.db", flipped(bytes, position, bit));
      INFO("seed " << seed << ", bit " << bit << " of byte " << position);
      REQUIRE(is_cured_or_refused(directory / "a.db", sound, lost));
      opened += Database::open(directory / "a.db", arm_space(), OpenMode::read_only) ? 1 : 0;
      remove_database(directory / "a.db");
      remove_database(directory / "a.db.damaged");
    }
    // Few flips make the file useless, and one flip costs at most the rows of a page.
    CHECK(opened > count * 3 / 4);
    CHECK(lost < 4 * count);
  }

  TEST_CASE("a flipped bit on the page of header and schema costs no row") {
    const std::uint64_t seed = 85;
    const TemporaryDirectory directory;
    const std::string bytes = sound_file(directory / "sound.db");
    const Database sound = open_database(directory / "sound.db", OpenMode::read_only);
    Rng rng(seed);
    const std::size_t schema = bytes.find("STRICT") - 2000;
    for (int i = 0; i < rounds(36); ++i) {
      // Most of the page between header and schema is empty.
      const std::size_t position =
          i % 3 == 0   ? rng.index(100)
          : i % 3 == 1 ? schema + rng.index(static_cast<std::uint32_t>(8192 - schema))
                       : rng.index(8192);
      const int bit = static_cast<int>(rng.index(8));
      write_file(directory / "a.db", flipped(bytes, position, bit));
      INFO("seed " << seed << ", bit " << bit << " of byte " << position);
      const auto damages = verify_database(directory / "a.db", VerifyMode::quarantine);
      REQUIRE(damages.has_value());
      REQUIRE(verify_database(directory / "a.db")->empty());
      REQUIRE(has_same_rows(open_database(directory / "a.db", OpenMode::read_only), sound));
      remove_database(directory / "a.db");
      remove_database(directory / "a.db.damaged");
    }
  }

  TEST_CASE("a file that was cut short keeps every row of which all bytes are left") {
    const TemporaryDirectory directory;
    const std::string bytes = sound_file(directory / "sound.db");
    const Database sound = open_database(directory / "sound.db", OpenMode::read_only);
    Rng rng(86);
    std::vector<std::size_t> sizes = {bytes.size() - 1, bytes.size() - 4096};
    for (std::size_t size = 8192; size < bytes.size(); size += 8192) sizes.push_back(size);
    for (int i = 0; i < 5; ++i) {
      sizes.push_back(1 + rng.index(static_cast<std::uint32_t>(bytes.size()) - 1));
    }
    for (const std::size_t size : sizes) {
      const std::string left = bytes.substr(0, size / 8192 * 8192);
      write_file(directory / "a.db", bytes.substr(0, size));
      INFO(size << " of " << bytes.size() << " bytes");
      std::int64_t lost = 0;
      REQUIRE(is_cured_or_refused(directory / "a.db", sound, lost));
      const auto opened = Database::open(directory / "a.db", arm_space(), OpenMode::read_only);
      REQUIRE((opened || !holds(left, arm_space().robot_hash)));
      for (std::int64_t i = 0; opened && i < sound.size(); ++i) {
        const Experience row = *sound.get(i);
        if (!holds(left, row.key) || !holds(left, row.sampler.means)) continue;
        REQUIRE(has_row(*opened, row.id));
      }
      remove_database(directory / "a.db");
      remove_database(directory / "a.db.damaged");
    }
  }

  TEST_CASE("a flipped bit is noticed or does no harm") {
    const std::uint64_t seed = 82;
    const TemporaryDirectory directory;
    const std::string bytes = sound_file(directory / "sound.db");
    const Database sound = open_database(directory / "sound.db", OpenMode::read_only);
    Rng rng(seed);
    int refused = 0;
    for (int i = 0; i < rounds(250); ++i) {
      // Half of the flips hit the first pages, where the file is described.
      const std::size_t range = i % 2 == 0 ? bytes.size() : 4 * 8192;
      const std::size_t position = i < 100 ? static_cast<std::size_t>(i) : rng.index(range);
      const int bit = static_cast<int>(rng.index(8));
      write_file(directory / "a.db", flipped(bytes, position, bit));
      INFO("seed " << seed << ", bit " << bit << " of byte " << position);
      REQUIRE(is_refused_or_sound(directory / "a.db", sound));
      if (!Database::open(directory / "a.db", arm_space(), OpenMode::read_only)) ++refused;
      if (i < 100 || i % 10 == 0) {
        REQUIRE(can_grow_or_is_refused(directory / "a.db", random_experience(rng, 30)));
      }
      remove_database(directory / "a.db");
      remove_database(directory / "a.db.damaged");
    }
    CHECK(refused > 50);
  }

  TEST_CASE("a file that was cut short is refused unless nothing is left of it") {
    const std::uint64_t seed = 83;
    const TemporaryDirectory directory;
    const std::string bytes = sound_file(directory / "sound.db");
    Rng rng(seed);
    // SQLite takes a file of one byte for an empty one.
    std::vector<std::size_t> sizes = {2, 15, 16, 50, 99, 100, 511, 512, 4096, bytes.size() - 1};
    for (std::size_t size = 8192; size < bytes.size(); size += 8192) sizes.push_back(size);
    for (int i = 0; i < 60; ++i) {
      sizes.push_back(1 + rng.index(static_cast<std::uint32_t>(bytes.size()) - 1));
    }
    for (const std::size_t size : sizes) {
      write_file(directory / "a.db", bytes.substr(0, size));
      INFO("seed " << seed << ", " << size << " of " << bytes.size() << " bytes");
      REQUIRE(open_error(directory / "a.db").code == ErrorCode::corrupt);
      REQUIRE(open_error(directory / "a.db", OpenMode::create).code == ErrorCode::corrupt);
      REQUIRE(!first_damage(directory / "a.db").empty());
      remove_database(directory / "a.db");
    }
  }
}

namespace {

/// What tests/store/schema3.db was made from.
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
    std::filesystem::copy_file(source_file("tests/store/schema3.db"), path);
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
