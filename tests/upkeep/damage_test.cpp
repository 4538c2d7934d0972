// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "engines/fixtures.h"

#include <algorithm>
#include <cstdlib>
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
  for (const char* suffix : {"", "-wal", "-shm", "-journal", ".tally"}) {
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

/// True if the file is either refused, and then known to be damaged, or as good as the sound one.
bool is_refused_or_sound(const std::string& path, const Database& sound) {
  const auto opened = Database::open(path, arm_signature(), OpenMode::read_only);
  const auto damages = verify_database(path);
  if (opened) return has_same_rows(*opened, sound);
  const bool is_known_reason =
      opened.error().code == ErrorCode::corrupt || opened.error().code == ErrorCode::unsupported;
  return is_known_reason && (!damages || !damages->empty());
}

/// True if a row can be added without harm to those there are, or is refused.
bool can_grow_or_is_refused(const std::string& path, const Experience& row) {
  {
    auto opened = Database::open(path, arm_signature(), OpenMode::read_write);
    if (!opened || !opened->insert({row})) return true;
  }
  const auto reopened = Database::open(path, arm_signature(), OpenMode::read_only);
  return reopened && reopened->size() == kRowCount + 1;
}

/// True if every row of a database is one of the sound one's rows.
bool holds_sound_rows(const Database& database, const Database& sound) {
  std::set<std::int64_t> ids;
  for (std::int64_t i = 0; i < database.size(); ++i) {
    const std::int64_t id = database.get(i)->id;
    if (id < 1 || id > kRowCount || !ids.insert(id).second) return false;
    if (!is_same_content(*database.get(i), *sound.get(id - 1))) return false;
  }
  return true;
}

/// Puts `verify` with quarantine to the test: afterwards the file is sound and holds nothing but
/// rows of the original, and what it lost is named, or it is refused.
bool is_cured_or_refused(const std::string& path, const Database& sound) {
  const auto damages = verify_database(path, VerifyMode::quarantine);
  const auto opened = Database::open(path, arm_signature(), OpenMode::read_only);
  if (!damages) return !opened;
  if (!damages->empty() && !damages->front().is_quarantined) return damages->size() > 1;
  if (!opened || !holds_sound_rows(*opened, sound)) return false;
  std::set<std::int64_t> kept, named;
  for (std::int64_t i = 0; i < opened->size(); ++i) kept.insert(opened->get(i)->id);
  for (const Damage& damage : *damages) named.insert(damage.id);
  for (std::int64_t id = 1; id <= kRowCount; ++id) {
    if (!kept.contains(id) && !named.contains(id)) return false;
  }
  return verify_database(path)->empty();
}

std::string flipped(std::string bytes, std::size_t position, int bit) {
  bytes[position] = static_cast<char>(bytes[position] ^ (1 << bit));
  return bytes;
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("after a flipped bit rows are set aside and named, or nothing is touched") {
    const std::uint64_t seed = 84;
    const TemporaryDirectory directory;
    const std::string bytes = sound_file(directory / "sound.db");
    const Database sound = open_database(directory / "sound.db", OpenMode::read_only);
    Rng rng(seed);
    for (int i = 0; i < rounds(100); ++i) {
      const std::size_t position = i < 100 && i % 2 == 0
                                       ? static_cast<std::size_t>(i)
                                       : rng.index(static_cast<std::uint32_t>(bytes.size()));
      const int bit = static_cast<int>(rng.index(8));
      write_file(directory / "a.db", flipped(bytes, position, bit));
      INFO("seed " << seed << ", bit " << bit << " of byte " << position);
      REQUIRE(is_cured_or_refused(directory / "a.db", sound));
      remove_database(directory / "a.db");
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
      if (!Database::open(directory / "a.db", arm_signature(), OpenMode::read_only)) ++refused;
      if (i < 100 || i % 10 == 0) {
        REQUIRE(can_grow_or_is_refused(directory / "a.db", random_experience(rng, 30)));
      }
      remove_database(directory / "a.db");
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

/// The command in the last entry of what verify reports.
std::string saving_command_of(const std::vector<Damage>& damages) {
  const std::string& what = damages.back().what;
  const std::size_t begin = what.find("sqlite3 ");
  REQUIRE_MESSAGE(begin != std::string::npos, what);
  return what.substr(begin, what.find("; mneme") - begin);
}

/// Runs the command for a.db; the database that it leaves, set in order.
Database saved_database(const TemporaryDirectory& directory, const std::string& command) {
  CAPTURE(command);
  REQUIRE(std::system((command + " >/dev/null 2>&1").c_str()) == 0);
  const std::string saved = directory / "a.db.saved";
  require(verify_database(saved, VerifyMode::quarantine));
  CHECK(verify_database(saved)->empty());
  return open_database(saved, OpenMode::read_write);
}

}  // namespace

TEST_SUITE("flow") {
  TEST_CASE("what can be read of a damaged file is saved by the command that verify prints") {
    if (std::system("sqlite3 --version >/dev/null 2>&1") != 0) {
      MESSAGE("skipped: no sqlite3");
      return;
    }
    const TemporaryDirectory directory;
    const std::string bytes = sound_file(directory / "sound.db");
    const Database sound = open_database(directory / "sound.db", OpenMode::read_only);
    const std::vector<float> means = sound.get(20)->sampler().means;
    const std::size_t row = bytes.find(std::string_view(reinterpret_cast<const char*>(means.data()),
                                                        means.size() * sizeof means[0]));
    REQUIRE(row != std::string::npos);
    std::string damaged = bytes;
    std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(row / 8192 * 8192), 8192, '\0');
    for (const std::string& file : {damaged, bytes.substr(0, bytes.size() - 8192)}) {
      write_file(directory / "a.db", file);
      CHECK(open_error(directory / "a.db").code == ErrorCode::corrupt);
      const auto damages = require(verify_database(directory / "a.db", VerifyMode::quarantine));
      Database saved = saved_database(directory, saving_command_of(damages));
      CHECK(holds_sound_rows(saved, sound));
      CHECK(saved.size() > kRowCount / 2);
      CHECK(saved.size() < kRowCount);
      Rng rng(87);
      CHECK(saved.insert(random_rows(rng, 1)));
      remove_database(directory / "a.db");
      remove_database(directory / "a.db.saved");
    }
  }
}

}  // namespace mneme::test
