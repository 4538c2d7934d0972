// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "support/support.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <array>
#include <string>

namespace mneme::test {

using internal::NewFile;

TEST_SUITE("unit") {
  TEST_CASE("a file has its name only once it is finished") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a";
    write_file(path, "old");
    REQUIRE(require(NewFile::create(path)).write("new"));
    CHECK(read_file(path) == "old");
    CHECK(!std::filesystem::exists(path + ".unfinished"));
    auto file = NewFile::create(path);
    REQUIRE(file->write("ne"));
    REQUIRE(file->write("w"));
    REQUIRE(file->finish());
    CHECK(read_file(path) == "new");
    CHECK(!std::filesystem::exists(path + ".unfinished"));
  }

  TEST_CASE("two who write one file at a time do not write into each other's") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a";
    auto first = NewFile::create(path);
    REQUIRE(first->write("first"));
    const Error error = require_error(NewFile::create(path));
    CHECK(error.code == ErrorCode::io);
    CHECK(error.message == path + ": is being written by another process");
    REQUIRE(first->finish());
    CHECK(read_file(path) == "first");
    auto later = NewFile::create(path);
    REQUIRE(later->write("2"));
    CHECK(read_file(path) == "first");
    REQUIRE(later->finish());
    CHECK(read_file(path) == "2");
  }

  TEST_CASE("what a killed process left unfinished is taken over") {
    const TemporaryDirectory directory;
    const std::string path = directory / "a";
    write_file(path + ".unfinished", "much that nobody needs any more");
    auto file = NewFile::create(path);
    REQUIRE(file->write("new"));
    REQUIRE(file->finish());
    CHECK(read_file(path) == "new");
    CHECK(!std::filesystem::exists(path + ".unfinished"));
  }

  TEST_CASE("a link is written through and stays a link") {
    const TemporaryDirectory directory;
    write_file(directory / "a", "old");
    std::filesystem::create_symlink(directory / "a", directory / "link");
    auto file = require(NewFile::create(directory / "link"));
    REQUIRE(file.write("new"));
    REQUIRE(file.finish());
    CHECK(std::filesystem::is_symlink(directory / "link"));
    CHECK(read_file(directory / "a") == "new");
  }

  TEST_CASE("a place that cannot be written and a full disk are errors with the name") {
    const TemporaryDirectory directory;
    CHECK(require_error(NewFile::create(directory / "none/a")).message.find(directory / "none/a") ==
          0);
    auto full = require(NewFile::create("/dev/full"));
    const Error error = require_error(full.write("x").and_then([&] { return full.finish(); }));
    CHECK(error.code == ErrorCode::io);
    CHECK(contains(error.message, "No space left"));
  }

  TEST_CASE("a pipe that no process reads is an error at once") {
    const TemporaryDirectory directory;
    const std::string path = directory / "pipe";
    REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
    CHECK(require_error(NewFile::create(path)).message ==
          path + ": is a pipe that no process reads");
    const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
    REQUIRE(reader >= 0);
    auto file = require(NewFile::create(path));
    REQUIRE(file.write("new"));
    REQUIRE(file.finish());
    std::array<char, 8> read = {};
    CHECK(::read(reader, read.data(), read.size()) == 3);
    ::close(reader);
  }
}

}  // namespace mneme::test
