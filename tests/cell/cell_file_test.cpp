// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/cell.h"

#include "cell/cell_data.h"
#include "cell/cells.h"

#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <string>

namespace mneme::test {

TEST_SUITE("unit") {
  TEST_CASE("a cell reads back as it was, and a damaged one is refused") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const Cell cell = require_cell(region, 10);
    const std::string file = directory / "a.cell";
    require(cell.save(file));
    const auto loaded = require(load_cell(file));
    CHECK(loaded.is_of_this_world());
    CHECK(loaded.box_count() == cell.box_count());
    CHECK(loaded.margin() == cell.margin());
    CHECK(loaded.unproven().size() == cell.unproven().size());
    CHECK(loaded.coverage().proven == cell.coverage().proven);
    check_same_answers(region, cell, loaded);
    const std::string bytes = read_file(file);
    Rng rng(1);
    for (int i = 0; i < 40; ++i) {
      std::string damaged = bytes;
      const auto place = rng.index(static_cast<std::uint32_t>(bytes.size()));
      if (i % 4 == 0) {
        damaged.resize(place);
      } else {
        damaged[place] = static_cast<char>(damaged[place] ^ (1 << rng.index(8)));
      }
      write_file(file, damaged);
      CHECK(require_error(load_cell(file)).code == ErrorCode::corrupt);
    }
  }

  TEST_CASE("a file with a correct checksum whose parts do not fit together is refused") {
    const TemporaryDirectory directory;
    const CellRegion region = require_region(directory, region_text());
    const std::string file = directory / "forged.cell";
    using Forge = std::function<void(internal::StartCell&)>;
    const auto load_forged = [&](const Forge& forge) {
      const auto data = require(internal::make_cell_data(region, 5e-4));
      internal::StartCell& start = data->starts.emplace_back();
      start.tree.cut(0, data->frame.varying()[0], 0);
      start.tree.nodes[0].count = 1;
      internal::CellBox& box = start.boxes.emplace_back();
      const auto joints = static_cast<std::size_t>(data->chain.joint_count());
      const std::size_t parameters = data->frame.varying().size();
      box.path.rows.assign(2 * joints, 0);
      box.path.shares.assign(2, 1);
      box.shift.constant.resize(joints);
      box.shift.slopes.resize(parameters * joints);
      box.shift.curvatures.resize(parameters * parameters * joints);
      box.shift.rest.resize(joints);
      forge(start);
      require(Cell(data).save(file));
      return load_cell(file);
    };
    CHECK(require(load_forged([](const auto&) {})).box_count() == 1);
    constexpr int kLargest = std::numeric_limits<int>::max();
    for (const int first : {kLargest, kLargest - 1, 1, -1, -kLargest}) {
      CAPTURE(first);
      const auto forged = load_forged([&](internal::StartCell& start) {
        start.tree.nodes[1].first = first;
        start.tree.nodes[1].count = 2;
      });
      CHECK(require_error(forged).code == ErrorCode::corrupt);
    }
    const auto long_path = load_forged(
        [](internal::StartCell& start) { start.boxes[0].path.shares.resize(1'000'000); });
    CHECK(require_error(long_path).code == ErrorCode::corrupt);
  }

  TEST_CASE("a cell of another version is refused by its number") {
    const TemporaryDirectory directory;
    write_file(directory / "old.cell", "mneme cell, version 1\nwhatever there was");
    const Error error = require_error(load_cell(directory / "old.cell"));
    CHECK(error.code == ErrorCode::unsupported);
    CHECK(error.message.ends_with(
        "old.cell: a cell of version 1, but this mneme reads version 2; build it anew"));
  }
}

}  // namespace mneme::test
