// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/fail.h"
#include "base/files.h"
#include "base/text.h"
#include "geometry/axis_box.h"
#include "scene/compound_files.h"
#include "input/elided.h"
#include "input/input.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>

namespace mneme::internal {
namespace {

/// Levels of OctoMap's trees below the root.
constexpr int kDepth = 16;
/// Longer than any header.
constexpr std::size_t kMostHeader = 65536;

Cube child_of(const Cube& cube, int i) {
  const double half = 0.5 * cube.half_extent;
  const Vec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
  return {cube.center + half * sign, half};
}

/// Reads nodes depth first into occupied and unknown leaves.
class OctreeReader {
 public:
  OctreeReader(std::string_view bytes, const OctreeFormat& format, const OctreeUse& use,
               const std::string& source)
      : rest_(bytes), format_(format), use_(use), source_(source) {}

  void read() {
    const Cube root{Vec3::Zero(), format_.resolution * (1 << (kDepth - 1))};
    if (!rest_.empty()) format_.is_binary ? read_binary(root, 0) : read_full(root, 0);
    if (!rest_.empty()) {
      fail(ErrorCode::parse, "expected the end of the file after the tree, got {} more bytes",
           rest_.size());
    }
  }

  std::vector<Cube> take() {
    for (const Cube& cube : unknown_) add_within_known(cube);
    return std::move(occupied_);
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(ErrorCode code, fmt::format_string<Args...> what, Args&&... args) const {
    throw_failure(code, "{}: {}", source_, fmt::format(what, std::forward<Args>(args)...));
  }

  std::string_view take_bytes(std::size_t count) {
    if (rest_.size() < count) fail(ErrorCode::parse, "ends within its tree");
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }

  void expect_depth(int depth) const {
    if (depth >= kDepth) {
      fail(ErrorCode::parse, "expected a tree of at most {} levels", kDepth);
    }
  }

  void read_binary(const Cube& cube, int depth) {
    expect_depth(depth);
    const std::string_view bytes = take_bytes(2);
    const unsigned kinds =
        static_cast<unsigned char>(bytes[0]) | unsigned{static_cast<unsigned char>(bytes[1])} << 8;
    // Leaves of a node come before the children of any.
    for (int i = 0; i < 8; ++i) {
      const unsigned kind = kinds >> (2 * i) & 3;
      if (kind == 0) add_unknown(child_of(cube, i));
      if (kind == 1 || kind == 2) add_leaf(child_of(cube, i), kind == 2);
    }
    for (int i = 0; i < 8; ++i) {
      if ((kinds >> (2 * i) & 3) == 3) read_binary(child_of(cube, i), depth + 1);
    }
  }

  void read_full(const Cube& cube, int depth) {
    float log_odds = 0;
    std::memcpy(&log_odds, take_bytes(sizeof log_odds).data(), sizeof log_odds);
    if (format_.is_colored) static_cast<void>(take_bytes(3));
    const unsigned children = static_cast<unsigned char>(take_bytes(1)[0]);
    if (children == 0) return add_leaf(cube, !(log_odds < 0));
    expect_depth(depth);
    for (int i = 0; i < 8; ++i) {
      if ((children >> i & 1) != 0) {
        read_full(child_of(cube, i), depth + 1);
      } else {
        add_unknown(child_of(cube, i));
      }
    }
  }

  void add(const Cube& cube, std::vector<Cube>& cubes) const {
    if (cubes.size() >= use_.most_cubes) {
      fail(ErrorCode::unsupported, "expected at most {} occupied leaves, and as many unknown ones",
           use_.most_cubes);
    }
    cubes.push_back(cube);
  }

  void add_leaf(const Cube& cube, bool is_occupied) {
    known_.include(box_of(cube));
    if (is_occupied) add(cube, occupied_);
  }

  void add_unknown(const Cube& cube) {
    if (use_.is_unknown_occupied) add(cube, unknown_);
  }

  /// Clips unknown cubes at the box of known leaves, which ends at borders of cubes.
  void add_within_known(const Cube& cube) {
    const double slack = 0.25 * format_.resolution;
    const AxisBox box = box_of(cube);
    const AxisBox inner{box.low + Vec3::Constant(slack), box.high - Vec3::Constant(slack)};
    if (intersection(inner, known_).is_empty()) return;
    if (known_.contains(inner) || cube.half_extent < format_.resolution) {
      return add(cube, occupied_);
    }
    for (int i = 0; i < 8; ++i) add_within_known(child_of(cube, i));
  }

  std::string_view rest_;
  const OctreeFormat& format_;
  const OctreeUse& use_;
  const std::string& source_;
  std::vector<Cube> occupied_, unknown_;
  AxisBox known_;
};

/// Takes a line off, if there is one.
std::optional<std::string_view> take_line(std::string_view& rest) {
  const std::size_t end = rest.substr(0, kMostHeader).find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return line;
}

std::string_view value_of(std::string_view line, std::string_view key) {
  if (!line.starts_with(key) || line.size() <= key.size() || line[key.size()] != ' ') return {};
  return line.substr(key.size() + 1);
}

OctreeFormat read_header(std::string_view& rest, const std::string& source) {
  OctreeFormat format;
  const std::string_view first = take_line(rest).value_or("");
  format.is_binary = first == "# Octomap OcTree binary file";
  if (!format.is_binary && first != "# Octomap OcTree file") {
    throw_failure(
        ErrorCode::unsupported,
        "{}: expected a file of OctoMap 1 (.bt or .ot), which begins with \"# Octomap OcTree\"",
        source);
  }
  std::string_view id;
  for (auto line = take_line(rest); line != "data"; line = take_line(rest)) {
    if (!line) {
      throw_failure(ErrorCode::parse, "{}: expected a header of OctoMap, which ends with data",
                    source);
    }
    if (const auto value = value_of(*line, "id"); !value.empty()) id = value;
    if (const auto value = value_of(*line, "res"); !value.empty()) {
      number_from(value.data(), value.data() + value.size(), format.resolution);
    }
  }
  format.is_colored = id == "ColorOcTree";
  if (id != "OcTree" && !format.is_colored) {
    throw_failure(ErrorCode::unsupported, "{}: expected the id OcTree or ColorOcTree, got \"{}\"",
                  source, elided(id, kLongestName));
  }
  return format;
}

}  // namespace

Result<std::vector<Cube>> parse_octree_data(std::string_view bytes, const OctreeFormat& format,
                                            const OctreeUse& use, const std::string& source) {
  constexpr double kLeastResolution = 1e-4, kMostResolution = 100;
  if (!(format.resolution >= kLeastResolution && format.resolution <= kMostResolution)) {
    return fail(ErrorCode::parse, "{}: expected a resolution of {} to {} m, got {}", source,
                kLeastResolution, kMostResolution, format.resolution);
  }
  return without_throwing([&] {
    OctreeReader reader(bytes, format, use, source);
    reader.read();
    return reader.take();
  });
}

Result<std::vector<Cube>> parse_octree(std::string_view bytes, const OctreeUse& use,
                                       const std::string& source) {
  const OctreeFormat format =
      MNEME_TRY(without_throwing([&] { return read_header(bytes, source); }));
  return parse_octree_data(bytes, format, use, source);
}

Result<std::vector<Cube>> read_octree(const std::string& path, const OctreeUse& use) {
  const std::string bytes = MNEME_TRY(read_regular_file(path));
  return parse_octree(bytes, use, path);
}

}  // namespace mneme::internal
