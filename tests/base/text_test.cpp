// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "base/text.h"
#include "support/support.h"

#include <fmt/format.h>

#include <sys/stat.h>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("a file is read byte for byte") {
    const TemporaryDirectory directory;
    std::string text("a\0b\r\n", 5);
    text.append(100000, 'x');
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

  TEST_CASE("a pipe is refused without waiting where a regular file is expected") {
    const TemporaryDirectory directory;
    REQUIRE(mkfifo((directory / "pipe").c_str(), 0600) == 0);
    const auto text = internal::read_regular_file(directory / "pipe");
    REQUIRE_FALSE(text.has_value());
    CHECK(text.error().message == (directory / "pipe") + ": expected a regular file");
    write_file(directory / "file", "12345");
    CHECK(internal::read_regular_file(directory / "file").value() == "12345");
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

using internal::decode_utf8;

TEST_SUITE("unit") {
  TEST_CASE("text of all lengths of code points is taken apart") {
    const std::string text = "a\u007f\u0080\u07ff\u0800\uffff\U00010000\U0010ffffz";
    CHECK(decode_utf8(text) == U"a\u007f\u0080\u07ff\u0800\uffff\U00010000\U0010ffffz");
    CHECK(decode_utf8("") == U"");
    CHECK(internal::escape_bytes(text) == text);
  }

  TEST_CASE("XML that is costly to parse is recognised by its attributes, outside of comments") {
    const auto element = [](int attributes) {
      std::string text = "<a";
      for (int i = 0; i < attributes; ++i) text += " b='=<>'";
      return text + "/>";
    };
    CHECK_FALSE(internal::find_costly_xml(element(100) + element(100) + "x = 1 = 2"));
    CHECK_FALSE(internal::find_costly_xml("<!-- " + element(101) + " --><![CDATA[ <a ' ]]>"));
    CHECK_FALSE(internal::find_costly_xml("<!-- does not end"));
    CHECK(internal::find_costly_xml("<!-- ' -->" + element(101)) ==
          "has an element with more than 100 attributes");
  }

  TEST_CASE("what is not UTF-8 or holds a NUL is refused, and can be escaped") {
    for (const std::string& bad :
         {std::string("\0", 1), std::string("\x80"), std::string("\xc0\x80"), std::string("\xc3"),
          std::string("\xed\xa0\x80"), std::string("\xf4\x90\x80\x80"), std::string("\xff"),
          std::string("\xe0\x80\x80"), std::string("\xe2\x82")}) {
      CHECK(!decode_utf8("a" + bad).has_value());
      const std::string escaped = internal::escape_bytes("a" + bad + "b");
      CHECK(escaped.starts_with(fmt::format("a\\x{:02x}", static_cast<unsigned char>(bad[0]))));
      CHECK(escaped.ends_with("b"));
      CHECK(decode_utf8(escaped).has_value());
      CHECK(fail(ErrorCode::io, "a" + bad + "b").value().message == escaped);
    }
  }
}

}  // namespace mneme::test
