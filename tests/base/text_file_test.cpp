// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/text_file.h"
#include "support/support.h"

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("a file is read byte for byte") {
    const TemporaryDirectory directory;
    const std::string text = std::string("a\0b\r\n", 5) + std::string(100000, 'x');
    write_file(directory / "file", text);
    CHECK(internal::read_text_file(directory / "file").value() == text);
  }

  TEST_CASE("a file that is missing is named with the reason") {
    const auto text = internal::read_text_file("/nonexistent/file");
    REQUIRE_FALSE(text.has_value());
    CHECK(text.error().code == ErrorCode::io);
    CHECK(text.error().message == "/nonexistent/file: cannot be read: No such file or directory");
  }

  TEST_CASE("a directory is no file") {
    const auto text = internal::read_text_file("/");
    REQUIRE_FALSE(text.has_value());
    CHECK(text.error().code == ErrorCode::io);
    CHECK(text.error().message.find("Is a directory") != std::string::npos);
  }

  TEST_CASE("a file at the limit is read and a larger one is refused") {
    const TemporaryDirectory directory;
    write_file(directory / "file", "12345");
    CHECK(internal::read_text_file(directory / "file", 5).has_value());
    const auto text = internal::read_text_file(directory / "file", 4);
    REQUIRE_FALSE(text.has_value());
    CHECK(text.error().code == ErrorCode::unsupported);
    CHECK(text.error().message == (directory / "file") + ": expected a file of at most 4 bytes");
  }
}

}  // namespace
}  // namespace mneme::test
