// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// A file: a line of text, then values, then their checksum (XXH3, little-endian). Values of paths
// and models are multiples of kPathStep and kShiftStep. Boxes of tasks follow from the tree.
#include "base/as_index.h"
#include "base/byte_stream.h"
#include "base/fail.h"
#include "base/files.h"
#include "cell/branch.h"
#include "cell/cell_data.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace mneme {
namespace internal {
namespace {

constexpr std::string_view kMagic = "mneme cell, version 2\n";
constexpr std::string_view kFormat = kMagic.substr(0, kMagic.rfind(' ') + 1);
constexpr std::string_view kVersion =
    kMagic.substr(kFormat.size(), kMagic.size() - kFormat.size() - 1);
constexpr std::size_t kMostCellBytes = std::size_t{1} << 30;

/// The head of a file.
struct CellHead {
  std::string region_path, tasks, kinematics;
  WorldHash world;
  double margin = 0;
};

// One description for reading and writing: `f` is a ByteWriter or a ByteReader.

template <class File, class Head>
void visit_head(File& f, Head& head) {
  f.field(head.region_path);
  f.field(head.world.robot);
  f.list(head.world.obstacles, [](auto& file, auto& hash) { file.field(hash); });
  f.field(head.tasks);
  f.field(head.kinematics);
  f.field(head.margin);
}

/// Numbers of values in a box.
struct BoxShape {
  std::size_t joints = 0, parameters = 0;
};

BoxShape shape_of(const CellData& data) {
  return {as_index(data.chain.joint_count()), data.frame.varying().size()};
}

void resize(const CellBox&, std::size_t, const BoxShape&) {}
void resize(CellBox& box, std::size_t waypoints, const BoxShape& shape) {
  box.path.rows.resize(waypoints * shape.joints);
  box.path.shares.resize(waypoints);
  box.shift.parameters = static_cast<int>(shape.parameters);
  box.shift.constant.resize(shape.joints);
  box.shift.slopes.resize(shape.parameters * shape.joints);
  box.shift.curvatures.resize(shape.parameters * shape.parameters * shape.joints);
  box.shift.rest.resize(shape.joints);
}

void mirror(const GoalShift&, std::size_t, std::size_t) {}
void mirror(GoalShift& shift, std::size_t from, std::size_t to) {
  shift.curvatures[to] = shift.curvatures[from];
}

template <class File, class Shift>
void visit_shift(File& f, Shift& shift, const BoxShape& shape) {
  for (auto* values : {&shift.constant, &shift.slopes, &shift.rest}) {
    for (auto& value : *values) f.multiple(value, kShiftStep);
  }
  for (std::size_t k = 0; k < shape.parameters; ++k) {
    for (std::size_t l = k; l < shape.parameters; ++l) {
      for (std::size_t j = 0; j < shape.joints; ++j) {
        const std::size_t at = (k * shape.parameters + l) * shape.joints + j;
        f.multiple(shift.curvatures[at], kShiftStep);
        mirror(shift, at, (l * shape.parameters + k) * shape.joints + j);
      }
    }
  }
}

/// All of a box but its tasks, its branch, and the start of its path.
template <class File, class BoxOf>
void visit_box(File& f, BoxOf& box, const BoxShape& shape) {
  std::size_t waypoints = box.path.size();
  f.number(waypoints);
  // One value of each joint: the first row is not in the file, but the model's constants are.
  resize(box, f.bounded(waypoints, std::max<std::size_t>(1, shape.joints)), shape);
  auto& rows = box.path.rows;
  for (std::size_t i = shape.joints; i < rows.size(); ++i) {
    const float before = i < 2 * shape.joints ? 0 : rows[i - shape.joints];
    f.multiple(rows[i], kPathStep, before);
  }
  for (auto& share : box.path.shares) f.multiple(share, kPathStep);
  visit_shift(f, box.shift, shape);
  f.number(box.origin);
  f.number(box.is_proven);
}

void visit_state(ByteWriter& f, const LeafGap& gap) {
  f.number((gap.is_examined ? 1 : 0) + (gap.is_lost ? 2 : 0));
}
void visit_state(ByteReader& f, LeafGap& gap) {
  std::uint8_t state = 0;
  f.number(state);
  gap.is_examined = (state & 1) != 0;
  gap.is_lost = (state & 2) != 0;
}

template <class File, class Gap>
void visit_gap(File& f, Gap& gap) {
  f.number(gap.reason);
  visit_state(f, gap);
  f.number(gap.first);
  f.number(gap.other);
  f.number(gap.along);
}

template <class File, class Node>
void visit_node(File& f, Node& node) {
  f.number(node.parameter);
  f.number(node.count);
  if (node.count > 0) f.number(node.first);
  f.number(node.has_gap);
  if (node.has_gap) visit_gap(f, node.gap);
}

template <class File, class Start>
void visit_start(File& f, Start& start, const BoxShape& shape) {
  f.list(start.tree.names, [](auto& file, auto& name) { file.field(name); });
  f.list(start.tree.nodes, [](auto& file, auto& node) { visit_node(file, node); });
  f.list(start.boxes, [&](auto& file, auto& box) { visit_box(file, box, shape); });
}

template <class File, class Progress>
void visit_progress(File& f, Progress& progress) {
  f.field(progress.time_s);
  f.number(progress.boxes);
  f.field(progress.proven);
  f.field(progress.decided);
}

template <class File, class Starts, class Progress>
void visit_body(File& f, Starts& starts, Progress& progress, const BoxShape& shape) {
  f.list(starts, [&](auto& file, auto& start) { visit_start(file, start, shape); });
  f.list(progress, [](auto& file, auto& step) { visit_progress(file, step); });
}

// Checks that readers rely on, whatever is in the file.

/// Sets the children of nodes, which are in the order of their depth. False if they do not fit.
bool link_nodes(SplitTree& tree, const TaskFrame& frame) {
  std::size_t next = 1;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    SplitNode& node = tree.nodes[i];
    if (node.gap.first >= tree.names.size() || node.gap.other >= tree.names.size()) return false;
    if (as_index(static_cast<int>(node.gap.reason)) >= kCellGaps) return false;
    if (node.is_leaf()) continue;
    if (std::ranges::count(frame.varying(), node.parameter) == 0) return false;
    node.below = static_cast<int>(next);
    next += 2;
    if (next > tree.nodes.size() || as_index(node.below) <= i) return false;
  }
  return next == tree.nodes.size();
}

/// Gives boxes the tasks of their nodes. False if a box has not one node.
bool place_boxes(StartCell& start, const TaskFrame& frame) {
  const std::vector<TaskBox> places = start.tree.place(frame.whole());
  std::vector<bool> is_placed(start.boxes.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const SplitNode& node = start.tree.nodes[i];
    const auto size = std::ssize(start.boxes);
    if (node.first < 0 || node.first > size - node.count) return false;
    for (int k = node.first; k < node.first + node.count; ++k) {
      if (is_placed[as_index(k)]) return false;
      is_placed[as_index(k)] = true;
      start.boxes[as_index(k)].tasks = places[i];
    }
  }
  return std::ranges::count(is_placed, false) == 0;
}

/// Completes what the file says of a start. False if its parts do not fit together.
bool complete(StartCell& start, const CellStart& from, const CellData& data) {
  if (!link_nodes(start.tree, data.frame) || !place_boxes(start, data.frame)) return false;
  for (CellBox& box : start.boxes) {
    if (box.path.size() < 2 || as_index(box.origin) >= start.boxes.size()) return false;
    std::ranges::transform(from.q, box.path.rows.begin(),
                           [](double value) { return static_cast<float>(value); });
    box.was_proven = box.is_proven;
    box.is_proven = box.is_proven && data.is_of_this_world;
  }
  return true;
}

/// The obstacles of the scene that were not there when the file was written.
Scene find_changed(const CellHead& head, const CellData& data) {
  Scene changed;
  const std::vector<Obstacle>& obstacles = data.region.problem.scene.obstacles;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    if (std::ranges::count(head.world.obstacles, data.world.obstacles[i]) == 0) {
      changed.obstacles.push_back(obstacles[i]);
    }
  }
  return changed;
}

Result<std::string_view> check_bytes(std::string_view bytes, const std::string& path) {
  if (bytes.starts_with(kFormat) && !bytes.starts_with(kMagic)) {
    const std::string_view version = bytes.substr(kFormat.size());
    return fail(ErrorCode::unsupported,
                "{}: a cell of version {}, but this mneme reads version {}; build it anew", path,
                version.substr(0, version.find_first_not_of("0123456789")), kVersion);
  }
  if (!bytes.starts_with(kMagic)) {
    return fail(ErrorCode::corrupt, "{}: expected a cell, which begins with \"{}\"", path,
                kMagic.substr(0, kMagic.size() - 1));
  }
  std::uint64_t checksum = 0;
  const std::size_t body = bytes.size() - std::min(bytes.size(), sizeof checksum);
  std::memcpy(&checksum, bytes.data() + body, bytes.size() - body);
  if (XXH3_64bits(bytes.data(), body) != checksum) {
    return fail(ErrorCode::corrupt, "{}: the cell is damaged: its checksum is wrong; build it anew",
                path);
  }
  return bytes.substr(kMagic.size(), body - kMagic.size());
}

Result<void> check_head(const CellHead& head, const CellRegion& region, const std::string& path) {
  if (head.kinematics != region.problem.robot.kinematics_hash()) {
    return fail(ErrorCode::wrong_robot,
                "{}: the cell was built for another robot, or other joints, than robot {} of {}",
                path, region.problem.robot.name(), region.path);
  }
  if (head.tasks != hash_tasks(region)) {
    return fail(ErrorCode::invalid,
                "{}: the cell was built for other tasks or starts than those of {}; build it anew",
                path, region.path);
  }
  return {};
}

}  // namespace

std::uint64_t hash_cell(const CellData& data) {
  std::uint64_t hash = 0;
  const auto add = [&](const auto& values) {
    hash = XXH3_64bits_withSeed(values.data(), values.size() * sizeof(values[0]), hash);
  };
  add(hash_tasks(data.region));
  add(data.world.robot);
  for (const std::string& obstacle : data.world.obstacles) add(obstacle);
  add(std::array{data.margin});
  std::vector<float> numbers;
  for (const StartCell& start : data.starts) {
    add(std::array{start.boxes.size()});
    for (const CellBox& box : start.boxes) {
      numbers.clear();
      for (const auto* values : {&box.path.rows, &box.path.shares, &box.shift.constant,
                                 &box.shift.slopes, &box.shift.curvatures, &box.shift.rest}) {
        // Files have no negative zero.
        for (const float value : *values) numbers.push_back(value + 0.0f);
      }
      add(numbers);
    }
  }
  return std::max<std::uint64_t>(hash, 1);
}

}  // namespace internal

Result<void> check_cell_output(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};
  if (std::filesystem::file_size(path, ignored) == 0) return {};
  std::string head(internal::kFormat.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (file && head == internal::kFormat) return {};
  return fail(ErrorCode::invalid,
              "{}: the output exists and is no cell; choose another file, or remove this one",
              path);
}

Result<void> Cell::save(const std::string& path) const {
  MNEME_TRY(check_cell_output(path));
  internal::ByteWriter writer(internal::kMagic);
  internal::CellHead head{std::filesystem::absolute(data_->region.path).lexically_normal().string(),
                          internal::hash_tasks(data_->region),
                          data_->region.problem.robot.kinematics_hash(), data_->world,
                          data_->margin};
  if (!data_->is_of_this_world) head.world = {};
  internal::visit_head(writer, head);
  internal::visit_body(writer, data_->starts, data_->progress, internal::shape_of(*data_));
  const std::uint64_t checksum = XXH3_64bits(writer.bytes().data(), writer.bytes().size());
  auto file = MNEME_TRY(internal::NewFile::create(path));
  MNEME_TRY(file.write(writer.bytes()));
  MNEME_TRY(file.write({reinterpret_cast<const char*>(&checksum), sizeof checksum}));
  return file.finish();
}

Result<Cell> load_cell(const std::string& path, const std::string& region_path,
                       const ProblemOptions& options) {
  const std::string bytes = MNEME_TRY(internal::read_regular_file(path, internal::kMostCellBytes));
  internal::ByteReader reader(MNEME_TRY(internal::check_bytes(bytes, path)));
  internal::CellHead head;
  internal::visit_head(reader, head);
  const CellRegion region =
      MNEME_TRY(load_region(region_path.empty() ? head.region_path : region_path, options));
  MNEME_TRY(internal::check_head(head, region, path));
  auto data = MNEME_TRY(internal::make_cell_data(region, head.margin));
  data->is_of_this_world = head.world == data->world;
  if (!data->is_of_this_world) {
    // What was built has tools; what has changed may be refused.
    if (const auto& made = data->make_tools(); !made) return tl::unexpected(made.error());
    if (head.world.robot == data->world.robot) data->changed = internal::find_changed(head, *data);
  }
  internal::visit_body(reader, data->starts, data->progress, internal::shape_of(*data));
  bool is_sound = reader.is_complete() && data->starts.size() == region.starts.size();
  for (std::size_t i = 0; i < data->starts.size() && is_sound; ++i) {
    is_sound = internal::complete(data->starts[i], region.starts[i], *data);
  }
  if (!is_sound) {
    return fail(ErrorCode::corrupt, "{}: the cell does not fit together; build it anew", path);
  }
  data->hash = internal::hash_cell(*data);
  return Cell(std::move(data));
}

}  // namespace mneme
