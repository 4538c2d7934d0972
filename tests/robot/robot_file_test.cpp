// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "robot/robot_file.h"

#include <string>

#include "robot/small_robots.h"
#include "support/support.h"

namespace mneme {
namespace {

using internal::read_robot_file;
using test::contains;

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("a file is read byte by byte, whatever its length") {
    const test::TemporaryDirectory directory;
    const std::string text = std::string(200000, 'x') + "\r\n\xff" + std::string(1, '\0');
    test::write_file(directory / "robot", text);
    CHECK(read_robot_file(directory / "robot") == text);
    test::write_file(directory / "empty", "");
    CHECK(read_robot_file(directory / "empty") == "");
  }

  TEST_CASE("what cannot be read is named") {
    const test::TemporaryDirectory directory;
    const auto absent = read_robot_file(directory / "absent");
    REQUIRE_FALSE(absent.has_value());
    CHECK(absent.error().code == ErrorCode::io);
    CHECK(contains(absent.error().message, "absent: cannot be read: No such file"));
    CHECK(read_robot_file(directory / "").error().code == ErrorCode::io);
  }
}

}  // namespace mneme
