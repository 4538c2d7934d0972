// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "exchange/npz_file.h"
#include "exchange/npz_rows.h"
#include "store/fixtures.h"

#include <cstring>

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

namespace {

using internal::NpyArray;
using internal::parse_npy;

std::string file_of(const NpyArray& array) { return internal::npy_header(array) + array.bytes; }

std::string error_of(const std::string& file) {
  const auto parsed = parse_npy(file);
  return parsed ? "" : parsed.error().message;
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a header is what NumPy writes") {
    const std::vector<float> numbers = {1, 2, 3, 4, 5, 6};
    const std::string header =
        internal::npy_header(internal::to_npy(std::span<const float>(numbers), {2, 3}));
    CHECK(header.size() % 64 == 0);
    CHECK(header.starts_with(std::string("\x93NUMPY\x01\0", 8)));
    CHECK(header.find("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }") == 10);
    CHECK(header.ends_with(" \n"));
    const auto scalar = internal::to_npy(std::span<const float>(numbers).first(1), {});
    CHECK(internal::npy_header(scalar).find("'shape': (), }") != std::string::npos);
    const auto list = internal::to_npy(std::span<const float>(numbers), {6});
    CHECK(internal::npy_header(list).find("'shape': (6,), }") != std::string::npos);
  }

  TEST_CASE("numbers of all types and texts come back") {
    const std::vector<double> doubles = {1, -2.5, 1e300};
    const auto parsed =
        parse_npy(file_of(internal::to_npy(std::span<const double>(doubles), {3, 1})));
    REQUIRE(parsed.has_value());
    CHECK(parsed->shape == std::vector<std::size_t>{3, 1});
    CHECK(internal::from_npy<double>(*parsed) == doubles);
    CHECK(internal::from_npy<float>(*parsed).empty());
    const std::vector<std::uint64_t> large = {0, UINT64_MAX};
    CHECK(internal::from_npy<std::uint64_t>(*parse_npy(
              file_of(internal::to_npy(std::span<const std::uint64_t>(large), {2})))) == large);
    const std::vector<std::string> texts = {"a\u20acb", "", "\U0001f916"};
    const auto array = parse_npy(file_of(internal::to_npy(texts)));
    REQUIRE(array.has_value());
    CHECK(array->type == "<U3");
    CHECK(*internal::texts_of(*array) == texts);
    CHECK(internal::texts_of(*parsed)->empty());
    CHECK(parse_npy(file_of(internal::to_npy(std::vector<std::string>{})))->bytes.empty());
  }

  TEST_CASE("what is no array of ours is refused with the reason") {
    const std::vector<float> numbers = {1, 2};
    const std::string sound = file_of(internal::to_npy(std::span<const float>(numbers), {2, 1}));
    const auto with = [&](const std::string& from, const std::string& to) {
      std::string file = sound;
      return file.replace(file.find(from), from.size(), to);
    };
    CHECK(error_of(sound).empty());
    CHECK(error_of("text").find("no NumPy array") != std::string::npos);
    CHECK(error_of(sound.substr(0, 40)).find("no NumPy array") != std::string::npos);
    CHECK(error_of(sound.substr(0, sound.size() - 1)).find("7 bytes") != std::string::npos);
    CHECK(error_of(with("<f4", ">f4")).find(">f4") != std::string::npos);
    CHECK(error_of(with("<f4", "|O8")).find("expected") != std::string::npos);
    CHECK(error_of(with("False", "True ")).find("Fortran") != std::string::npos);
    CHECK(error_of(with("(2, 1)", "(2, x)")).find("expected") != std::string::npos);
    CHECK(!error_of(with("(2, 1)", "(9999999999999999999, 99)")).empty());
    const std::vector<std::string> text = {"a"};
    std::string bad = file_of(internal::to_npy(text));
    bad.back() = '\x7f';
    CHECK(internal::texts_of(*parse_npy(bad)).error().message.find("no Unicode") !=
          std::string::npos);
  }
}

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
