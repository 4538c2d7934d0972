// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/compound_files.h"
#include "support/support.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace mneme::test {
namespace {

using internal::CloudFile;
using internal::parse_cloud;

template <class T>
std::string raw_bytes(T value, bool is_big_endian = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (is_big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string ply_header(const std::string& format, std::size_t count, const std::string& more = "") {
  return fmt::format(
      "ply\nformat {} 1.0\ncomment of a test\nelement vertex {}\nproperty uchar red\n"
      "property float x\nproperty float y\nproperty double z\n{}end_header\n",
      format, count, more);
}

std::string pcd_header(const std::string& data, int width, int height) {
  return fmt::format(
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb normal\nSIZE 4 4 4 4 4\nTYPE F F F U F\n"
      "COUNT 1 1 1 1 3\nWIDTH {}\nHEIGHT {}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\n"
      "DATA {}\n",
      width, height, width * height, data);
}

std::string binary_ply(bool is_big) {
  std::string text =
      ply_header(is_big ? "binary_big_endian" : "binary_little_endian", 2, "element face 1\n");
  for (const float x : {1.5f, -2.5f}) {
    text +=
        'r' + raw_bytes(x, is_big) + raw_bytes(x + 1, is_big) + raw_bytes(double{x} + 2, is_big);
  }
  return text + "faces are not read";
}

std::string cloud_message(const std::string& bytes) {
  const auto cloud = parse_cloud(bytes, "f.ply");
  return cloud ? "" : cloud.error().message;
}

void require_points(const std::string& bytes, const std::vector<CloudPoint>& expected,
                    std::size_t skipped = 0) {
  const auto cloud = require(parse_cloud(bytes, "f.ply"));
  CHECK(cloud.points == expected);
  CHECK(cloud.skipped == skipped);
}

TEST_SUITE("unit") {
  TEST_CASE("points of PLY are read from text and from binary records of either order") {
    const std::vector<CloudPoint> expected = {{1.5f, 2.5f, 3.5f}, {-2.5f, -1.5f, -0.5f}};
    require_points(ply_header("ascii", 2) + "255 1.5 2.5 3.5\r\n\n7 -2.5 -15e-1 -.5\n", expected);
    require_points(binary_ply(false), expected);
    require_points(binary_ply(true), expected);
  }

  TEST_CASE("points of PCD are read from text and from binary records") {
    const std::vector<CloudPoint> expected = {{1, 2, 3}, {4, 5, 6}};
    require_points(pcd_header("ascii", 2, 1) + "1 2 3 0 0 0 1\n4 5 6 0 0 0 1\n", expected);
    std::string binary = pcd_header("binary", 1, 2);
    for (const float x : {1.0f, 4.0f}) {
      for (int i = 0; i < 3; ++i) binary += raw_bytes(x + static_cast<float>(i));
      binary += std::string(16, 'n');
    }
    require_points(binary, expected);
  }

  TEST_CASE("points that are not finite are skipped and counted") {
    require_points(ply_header("ascii", 4) + "0 nan 0 0\n0 1 2 3\n0 0 inf 0\n0 0 0 1e300\n",
                   {{1, 2, 3}}, 3);
    require_points(ply_header("ascii", 1) + "0 nan 0 0\n", {}, 1);
  }

  TEST_CASE("a cloud that is cut off, goes on or is malformed is refused by line") {
    CHECK(cloud_message("") == "f.ply: expected points in a file of PLY or PCD");
    CHECK(cloud_message("ply\nformat ascii 1.0\n") == "f.ply: ends before end_header");
    CHECK(cloud_message(ply_header("ascii", 2) + "0 1 2 3\n") == "f.ply: ends after 1 of 2 points");
    CHECK(cloud_message(ply_header("ascii", 1) + "0 1 2\n") ==
          "f.ply:10: expected 4 numbers, got 3");
    CHECK(cloud_message(ply_header("ascii", 1) + "0 1 2 x\n") ==
          "f.ply:10: expected a number, got \"x\"");
    CHECK(cloud_message(ply_header("ascii", 1) + "0 1 2 3\n4\n") ==
          "f.ply:11: expected nothing after 1 points");
    CHECK(
        contains(cloud_message(binary_ply(false).substr(0, 200)), "points after the header, got"));
    const std::string truncated = pcd_header("binary", 2, 1) + std::string(30, '\0');
    CHECK(cloud_message(truncated) ==
          "f.ply: expected 56 bytes of 2 points after the header, got 30");
    CHECK(cloud_message("VERSION 0.7\nFIELDS x\nbad line\n") ==
          "f.ply:3: expected a header of PCD, got \"bad\"");
    CHECK(cloud_message("VERSION 0.8\nFIELDS x\nDATA ascii\n") ==
          "f.ply:1: expected PCD of version .5, .6 or .7, got 0.8");
  }

  TEST_CASE("a cloud of more points than memory is meant to hold is refused before it is read") {
    CHECK(cloud_message(ply_header("ascii", 10'000'000)) ==
          "f.ply: expected at most 4000000 points, got 10000000");
    CHECK(cloud_message(pcd_header("binary", 4000, 2500)) ==
          "f.ply:11: expected at most 4000000 points, got 10000000");
    CHECK(cloud_message(pcd_header("packed", 1, 1))
              .starts_with("f.ply:11: expected the data ascii, binary or binary_compressed"));
  }

  TEST_CASE("files of older versions and binary files with padding are read") {
    const std::string points = "DATA ascii\n1 2 3\n4 5 6\n";
    const std::vector<CloudPoint> expected = {{1, 2, 3}, {4, 5, 6}};
    require_points(
        "# .PCD v.5\nVERSION .5\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\n"
        "HEIGHT 1\nPOINTS 2\n" +
            points,
        expected);
    require_points("COLUMNS x y z\nPOINTS 2\n" + points, expected);
    require_points("VERSION 0.6\nFIELDS x y z\nWIDTH 2\n" + points, expected);
    const std::string binary = "FIELDS x y z\nWIDTH 1\nHEIGHT 1\nDATA binary\n" + raw_bytes(1.0f) +
                               raw_bytes(2.0f) + raw_bytes(3.0f);
    require_points(binary + std::string(4096, '\0'), {{1, 2, 3}});
  }

  TEST_CASE("what PCL ignores in a PCD file is ignored and noted") {
    const std::string header = "FIELDS x y z\nFOO 1\nWIDTH 1\nDATA ascii\n";
    const auto cloud =
        require(parse_cloud("\xef\xbb\xbf\n" + header + "1 2 3\n4 5 6\n\n7 8 9\n", "f.pcd"));
    CHECK(cloud.points == std::vector<CloudPoint>{{1, 2, 3}});
    CHECK(cloud.notes == std::vector<std::string>{"ignored the entry FOO",
                                                  "ignored 2 rows after the 1 that it announces"});
    require_points("WIDTH 1\nFIELDS x y z\nDATA ascii\n1 2 3\n", {{1, 2, 3}});
  }

  TEST_CASE("a pose of the sensor in a PCD file is noted, and moves no point") {
    const auto notes_of = [](const std::string& viewpoint) {
      const auto cloud = parse_cloud("FIELDS x y z\nWIDTH 1\nHEIGHT 1\nVIEWPOINT " + viewpoint +
                                         "\nPOINTS 1\nDATA ascii\n1 2 3\n",
                                     "f.pcd");
      REQUIRE_MESSAGE(cloud.has_value(), (cloud ? "" : cloud.error().message));
      CHECK(cloud->points == std::vector<CloudPoint>{{1, 2, 3}});
      return cloud->notes;
    };
    CHECK(notes_of("0 0 0 1 0 0 0").empty());
    CHECK(notes_of("0.0 0 -0 1.0 0 0 0").empty());
    CHECK(notes_of("1 2 3 0.7 0 0 0.7") ==
          std::vector<std::string>{
              "ignored VIEWPOINT 1 2 3 0.7 0 0 0.7: the points are taken as they are"});
    CHECK(notes_of("0 0 0").size() == 1);
  }

  TEST_CASE("compressed points of PCD are read field by field, damage is refused") {
    const std::string header = "FIELDS x y z\nWIDTH 4\nHEIGHT 1\nDATA binary_compressed\n";
    // x: 1 1 1 1, as a literal and a copy that overlaps itself; y and z: literals.
    std::string packed = std::string(1, '\x03') + raw_bytes(1.0f);
    packed += "\xe0\x03" + std::string(1, '\x03');  // copies 7 + 3 + 2 bytes from 4 back
    for (const float first : {2.0f, 10.0f}) {
      packed += '\x0f';
      for (int i = 0; i < 4; ++i) packed += raw_bytes(first + static_cast<float>(i));
    }
    const auto with = [&](const std::string& data, std::uint32_t size = 48) {
      return header + raw_bytes(static_cast<std::uint32_t>(data.size())) + raw_bytes(size) + data;
    };
    require_points(with(packed), {{1, 2, 10}, {1, 3, 11}, {1, 4, 12}, {1, 5, 13}});
    require_points(with(packed) + std::string(100, '\0'),
                   {{1, 2, 10}, {1, 3, 11}, {1, 4, 12}, {1, 5, 13}});
    CHECK(cloud_message(header + "abc") == "f.ply: ends before its compressed data");
    const std::string sizes =
        "f.ply: expected 42 bytes of compressed data for 48 bytes of points, ";
    CHECK(cloud_message(with(packed, 47)) == sizes + "at most 1073741824; got 42 and 47");
    CHECK(cloud_message(with(packed).substr(0, 90)) == sizes + "at most 1073741824; got 29 and 48");
    CHECK(cloud_message(with(packed.substr(0, 20))) == "f.ply: ends within its compressed data");
    CHECK(cloud_message(with(packed.substr(0, 8))) ==
          "f.ply: has compressed data of other than 48 bytes");
    CHECK(cloud_message(with("\x20\x05")) == "f.ply: has compressed data that is damaged");
  }

  TEST_CASE("compressed points of PCD that cannot expand to what the head announces are refused") {
    constexpr std::uint32_t kPoints = 4'000'000, kBytes = 12 * kPoints;
    const std::string data(3000, '\0');
    const std::string cloud =
        fmt::format("FIELDS x y z\nWIDTH {}\nDATA binary_compressed\n", kPoints) +
        raw_bytes(static_cast<std::uint32_t>(data.size())) + raw_bytes(kBytes) + data;
    CHECK(cloud_message(cloud) ==
          "f.ply: announces 48000000 bytes of points, but its 3000 bytes of compressed data expand "
          "to at most 264000");
    // The densest data there is: 4 copies of 264 bytes from 1 back.
    std::string dense(2, '\0');
    for (int i = 0; i < 4; ++i) dense += std::string("\xe0\xff\0", 3);
    dense += '\x0a' + std::string(11, '\0');
    require_points("FIELDS x y z\nWIDTH 89\nDATA binary_compressed\n" +
                       raw_bytes(static_cast<std::uint32_t>(dense.size())) +
                       raw_bytes(std::uint32_t{12 * 89}) + dense,
                   std::vector<CloudPoint>(89));
  }

  TEST_CASE("a cloud needs each of x, y and z once, as numbers of any type") {
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n";
    const auto with = [&](const std::string& properties) {
      return cloud_message(head + properties + "end_header\n1 2 3\n");
    };
    CHECK(with("property float y\n") == "f.ply: expected one field z");
    CHECK(with("property float x\n") == "f.ply: expected one field x");
    require_points(head + "property short y\nproperty uchar z\nend_header\n1 -2 3\n", {{1, -2, 3}});
    require_points("FIELDS x y z\nTYPE I I F\nSIZE 4 4 4\nWIDTH 1\nDATA ascii\n1 -2 3\n",
                   {{1, -2, 3}});
    CHECK(with("property list uchar int y\n") == "f.ply: expected vertices without lists");
  }
}

}  // namespace
}  // namespace mneme::test
