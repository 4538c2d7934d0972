// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "base/text.h"
#include "support/support.h"

#include <fmt/format.h>

#include <sys/stat.h>
#include <cmath>
#include <limits>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

namespace mneme::test {
namespace {

TEST_SUITE("unit") {
  TEST_CASE("times are UTC in ISO 8601") {
    CHECK(internal::utc_text(1769860800) == "2026-01-31T12:00:00Z");
    CHECK(internal::current_time() > "2026-01-01T00:00:00Z");
    CHECK(internal::current_time().size() == 20);
  }

  TEST_CASE("a file is read byte for byte") {
    const TemporaryDirectory directory;
    std::string text("a\0b\r\n", 5);
    text.append(100000, 'x');
    write_file(directory / "file", text);
    CHECK(internal::read_text_file(directory / "file").value() == text);
  }

  TEST_CASE("a file that is missing is named with the reason") {
    const Error error = require_error(internal::read_text_file("/nonexistent/file"));
    CHECK(error.code == ErrorCode::io);
    CHECK(error.message == "/nonexistent/file: cannot be read: No such file or directory");
  }

  TEST_CASE("codes of URLs are decoded, and a % before anything else stands for itself") {
    CHECK(internal::percent_decoded("a%20b%2Bc+%c3%a4") == "a b+c+\u00e4");
    CHECK(internal::percent_decoded("50%, %zz, %2") == "50%, %zz, %2");
    CHECK(internal::percent_decoded("").empty());
  }

  TEST_CASE("words are what is between spaces, and trimmed text has none at its ends") {
    using Words = std::vector<std::string_view>;
    CHECK(internal::split_words(" a\tbc\r\n d ") == Words{"a", "bc", "d"});
    CHECK(internal::split_words(" \n").empty());
    CHECK(internal::trimmed("\n a b\t") == "a b");
    CHECK(internal::trimmed(" ").empty());
  }

  TEST_CASE("numbers beyond the largest are infinite, those below the least 0") {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    CHECK(internal::parse_number_or_infinity("1e400") == kInfinity);
    CHECK(internal::parse_number_or_infinity("-1e400") == -kInfinity);
    CHECK(internal::parse_number_or_infinity("1e-400") == 0.0);
    CHECK(internal::parse_number_or_infinity("1.5") == 1.5);
    const std::string zeros(400, '0');
    CHECK(internal::parse_number_or_infinity("0." + zeros + "1") == 0.0);
    CHECK(internal::parse_number_or_infinity("-1" + zeros + "e-1") == -kInfinity);
    for (const char* text : {"", "x", "1e400x", "1 2"}) {
      CHECK_FALSE(internal::parse_number_or_infinity(text).has_value());
    }
  }

  TEST_CASE("a directory is no file") {
    const Error error = require_error(internal::read_text_file("/"));
    CHECK(error.code == ErrorCode::io);
    CHECK(contains(error.message, "Is a directory"));
  }

  TEST_CASE("a pipe is refused without waiting where a regular file is expected") {
    const TemporaryDirectory directory;
    REQUIRE(mkfifo((directory / "pipe").c_str(), 0600) == 0);
    const Error error = require_error(internal::read_regular_file(directory / "pipe"));
    CHECK(error.message == (directory / "pipe") + ": expected a regular file");
    CHECK(internal::read_text_file(directory / "pipe").error().message == error.message);
    CHECK(internal::read_text_file("/dev/zero").error().message ==
          "/dev/zero: expected a regular file");
    write_file(directory / "file", "12345");
    CHECK(internal::read_regular_file(directory / "file").value() == "12345");
  }

  TEST_CASE("a file at the limit is read and a larger one is refused") {
    const TemporaryDirectory directory;
    write_file(directory / "file", "12345");
    CHECK(internal::read_text_file(directory / "file", 5).has_value());
    const Error error = require_error(internal::read_text_file(directory / "file", 4));
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(error.message == (directory / "file") + ": expected a file of at most 4 bytes");
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

  TEST_CASE("numbers end where other text begins, and are left alone if there is none") {
    const auto read = [](std::string_view text, double& value) {
      const auto [end, error] =
          internal::number_from(text.data(), text.data() + text.size(), value);
      return std::pair(end - text.data(), error);
    };
    double value = 7;
    for (const std::string_view none : {"", "+1", " 1", "x", "-", "."}) {
      CHECK(read(none, value) == std::pair(std::ptrdiff_t{0}, std::errc::invalid_argument));
    }
    CHECK(value == 7);
    CHECK(read("1e999", value) == std::pair(std::ptrdiff_t{5}, std::errc::result_out_of_range));
    CHECK(value == 7);
    const std::tuple<std::string_view, double, int> numbers[] = {{"-0.25", -0.25, 5},
                                                                 {"1.5e-3,2", 1.5e-3, 6},
                                                                 {"0x10", 0, 1},
                                                                 {"2e", 2, 1},
                                                                 {"3 4", 3, 1},
                                                                 {"0.1", 0.1, 3},
                                                                 {"4.9e-324", 4.9e-324, 8},
                                                                 {"1-2", 1, 1},
                                                                 {"inf", HUGE_VAL, 3}};
    for (const auto& [shown, expected, size] : numbers) {
      const std::string_view text = shown;
      CAPTURE(text);
      CHECK(read(text, value) == std::pair(std::ptrdiff_t{size}, std::errc()));
      CHECK(value == expected);
    }
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
