// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "covering/cover_robot.h"
#include "covering/solids.h"

#include <filesystem>

namespace mneme::test {
namespace {

using internal::cover_key;
using internal::CoverCache;

const std::string kKey = "0123456789abcdef0123456789abcdef";

LinkCover make_cover() {
  return {"arm", {{{0.1, -0.2, 1e-5}, 0.3}, {{0, 0, 0}, 1.0 / 3}}, 0, 0.01, 0.02};
}

std::vector<std::string> files_in(const std::string& directory) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    files.push_back(entry.path().string());
  }
  return files;
}

TEST_SUITE("unit") {
  TEST_CASE("a cover comes back as it was stored, in directories that had to be made") {
    const TemporaryDirectory files;
    const CoverCache cache(files / "a/b");
    CHECK_FALSE(cache.find(kKey).has_value());
    REQUIRE(cache.store(kKey, make_cover()));
    const auto found = cache.find(kKey);
    REQUIRE(found.has_value());
    REQUIRE(found->spheres.size() == 2);
    CHECK(found->spheres[0].center == Vec3(0.1, -0.2, 1e-5));
    CHECK(found->spheres[1].radius == 1.0 / 3);
    CHECK(found->mean_excess == 0.01);
    CHECK(found->max_excess == 0.02);
    CHECK(files_in(files / "a/b").size() == 1);
  }

  TEST_CASE("a damaged file is not found, and is replaced") {
    const TemporaryDirectory files;
    const CoverCache cache(files / "cache");
    REQUIRE(cache.store(kKey, make_cover()));
    const std::string path = files_in(files / "cache").front();
    const std::string good = read_file(path);
    std::string other_number = good;
    other_number[other_number.find("0.3")] = '9';
    for (const std::string& bad :
         {std::string(), good.substr(0, good.size() / 2), good.substr(0, good.size() - 2),
          other_number, "{}\n" + good, std::string(1000, '\0')}) {
      write_file(path, bad);
      CHECK_FALSE(cache.find(kKey).has_value());
    }
    REQUIRE(cache.store(kKey, make_cover()));
    CHECK(cache.find(kKey).has_value());
  }

  TEST_CASE("an entry under another key's name is not found") {
    const TemporaryDirectory files;
    const CoverCache cache(files / "cache");
    REQUIRE(cache.store(kKey, make_cover()));
    const std::string path = files_in(files / "cache").front();
    std::string other = kKey;
    other[0] = 'f';
    std::string other_path = path;
    other_path.replace(path.find(kKey), kKey.size(), other);
    std::filesystem::rename(path, other_path);
    CHECK_FALSE(cache.find(other).has_value());
  }

  TEST_CASE("where nothing can be written, storing says so") {
    const TemporaryDirectory files;
    write_file(files / "file", "");
    CHECK_FALSE(CoverCache(files / "file").store(kKey, make_cover()));
    CHECK_FALSE(CoverCache(files / "file/below").store(kKey, make_cover()));
    CHECK_FALSE(CoverCache("").store(kKey, make_cover()));
    CHECK_FALSE(CoverCache("").find(kKey).has_value());
    std::filesystem::create_directories(files / ("cache/cover-" + kKey + ".json/in the way"));
    CHECK_FALSE(CoverCache(files / "cache").store(kKey, make_cover()));
    CHECK(files_in(files / "cache").size() == 1);
  }

  TEST_CASE("the key depends on the surface and on each setting") {
    const auto mesh = internal::triangulate(make_box({1, 2, 3}));
    auto other = mesh;
    other[3].a.y() += 1e-9;
    const std::string key = cover_key(mesh, {});
    CHECK(key.size() == 32);
    CHECK(key == cover_key(mesh, {}));
    CHECK(key != cover_key(other, {}));
    CHECK(key != cover_key(mesh, {0.02, 16}));
    CHECK(key != cover_key(mesh, {0.025, 17}));
  }
}

}  // namespace
}  // namespace mneme::test
