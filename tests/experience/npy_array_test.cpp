// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "experience/npy_array.h"

#include "experience/fixtures.h"

namespace mneme::test {
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

}  // namespace mneme::test
