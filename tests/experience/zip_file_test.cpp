// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/zip_file.h"

#include "experience/fixtures.h"

#include <cstring>

namespace mneme::test {
namespace {

using internal::read_zip;

/// An archive of two members.
std::string archive(const std::string& path) {
  auto file = internal::NewFile::create(path);
  REQUIRE(file.has_value());
  internal::ZipWriter zip(*file);
  REQUIRE(zip.add("first", "head ", "body"));
  REQUIRE(zip.add("second", "", std::string(1000, 'x')));
  REQUIRE(zip.finish());
  REQUIRE(file->finish());
  return read_file(path);
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the checksum is that of the standard's example") {
    CHECK(internal::crc32("123456789") == 0xcbf43926);
    CHECK(internal::crc32("6789", internal::crc32("12345")) == 0xcbf43926);
    CHECK(internal::crc32("") == 0);
  }

  TEST_CASE("what is written is read, and depends on the members alone") {
    const TemporaryDirectory directory;
    const std::string bytes = archive(directory / "a.zip");
    CHECK(bytes == archive(directory / "b.zip"));
    const auto members = read_zip("a.zip", bytes);
    REQUIRE(members.has_value());
    REQUIRE(members->size() == 2);
    CHECK(members->at("first") == "head body");
    CHECK(members->at("second") == std::string(1000, 'x'));
  }

  TEST_CASE("a compressed member is refused with the way out") {
    const TemporaryDirectory directory;
    std::string bytes = archive(directory / "a.zip");
    bytes[bytes.find("PK\x01\x02") + 10] = 8;
    const auto members = read_zip("a.zip", bytes);
    REQUIRE(!members.has_value());
    CHECK(members.error().code == ErrorCode::unsupported);
    CHECK(members.error().message.find("numpy.savez()") != std::string::npos);
  }

  TEST_CASE("members that share their bytes are refused, as archives that swell are made of them") {
    const TemporaryDirectory directory;
    const std::string bytes = archive(directory / "a.zip");
    const std::size_t begin = bytes.find("PK\x01\x02");
    const std::size_t second = bytes.find("PK\x01\x02", begin + 1);
    const std::size_t end = bytes.find("PK\x06\x06");
    // The entry of the second member again and again, under names of its own.
    std::string directory_of_many;
    for (char name = 'a'; name <= 'z'; ++name) {
      std::string entry = bytes.substr(second, end - second);
      entry[46] = name;
      directory_of_many += entry;
    }
    std::string swelling = bytes.substr(0, begin) + directory_of_many + bytes.substr(end);
    constexpr std::size_t kCountInEnd64 = 32;
    constexpr std::size_t kOffsetInLocator = 8;
    const std::size_t end64 = swelling.find("PK\x06\x06");
    swelling[end64 + kCountInEnd64] = 26;
    const std::uint64_t offset = end64;
    std::memcpy(&swelling[swelling.find("PK\x06\x07") + kOffsetInLocator], &offset, sizeof offset);
    const auto members = read_zip("a.zip", swelling);
    REQUIRE(!members.has_value());
    CHECK(members.error().message == "a.zip: its members hold more than it has");
  }
}

TEST_SUITE("law") {
  TEST_CASE("a damaged archive is refused or read as it was") {
    const std::uint64_t seed = 7;
    const TemporaryDirectory directory;
    const std::string bytes = archive(directory / "a.zip");
    Rng rng(seed);
    for (std::size_t size = 0; size < bytes.size(); size += 3) {
      CHECK(!read_zip("a.zip", bytes.substr(0, size)).has_value());
    }
    for (int i = 0; i < 3000; ++i) {
      std::string damaged = bytes;
      const std::size_t position = rng.index(static_cast<std::uint32_t>(bytes.size()));
      damaged[position] = static_cast<char>(damaged[position] ^ (1 << rng.index(8)));
      INFO("seed " << seed << ", byte " << position);
      const auto members = read_zip("a.zip", damaged);
      if (!members) continue;
      for (const auto& [name, content] : *members) {
        CHECK((content == "head body" || content == std::string(1000, 'x')));
      }
    }
  }
}

}  // namespace mneme::test
