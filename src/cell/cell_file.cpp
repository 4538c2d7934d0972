// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// A file: a line of text, then numbers as they stand in memory (little-endian), then their
// checksum.
#include "base/as_index.h"
#include "base/fail.h"
#include "base/files.h"
#include "cell/cell_data.h"

#include <xxhash.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>
#include <type_traits>

static_assert(std::endian::native == std::endian::little);

namespace mneme {
namespace internal {
namespace {

constexpr std::string_view kMagic = "mneme cell, version 1\n";
constexpr std::size_t kMostCellBytes = std::size_t{1} << 30;

/// Appends values.
class CellWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void field(const T& value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void field(const std::string& text) {
    field(std::uint64_t{text.size()});
    bytes_.append(text);
  }
  template <class T, class Each>
  void list(const std::vector<T>& items, const Each& each) {
    field(std::uint64_t{items.size()});
    for (const T& item : items) each(*this, item);
  }
  void list(const std::vector<float>& values) {
    field(std::uint64_t{values.size()});
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_ = std::string(kMagic);
};

/// Reads values. After a read beyond the end all values are 0.
class CellReader {
 public:
  explicit CellReader(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  requires std::is_trivially_copyable_v<T>
  void field(T& value) { read(&value, sizeof value); }
  void field(std::string& text) {
    text.resize(count(1));
    read(text.data(), text.size());
  }
  template <class T, class Each>
  void list(std::vector<T>& items, const Each& each) {
    items.resize(count(1));
    for (T& item : items) each(*this, item);
  }
  void list(std::vector<float>& values) {
    values.resize(count(sizeof(float)));
    read(values.data(), values.size() * sizeof(float));
  }
  [[nodiscard]] bool is_complete() const { return is_good_ && bytes_.empty(); }

 private:
  /// The number of items of at least this size.
  std::size_t count(std::size_t size) {
    std::uint64_t count = 0;
    field(count);
    is_good_ = is_good_ && count <= bytes_.size() / size;
    return is_good_ ? static_cast<std::size_t>(count) : 0;
  }
  void read(void* to, std::size_t size) {
    is_good_ = is_good_ && size <= bytes_.size();
    if (!is_good_) {
      std::memset(to, 0, size);
      return;
    }
    std::memcpy(to, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }

  std::string_view bytes_;
  bool is_good_ = true;
};

/// The head of a file.
struct CellHead {
  std::string region_path, world, tasks, kinematics;
  double margin = 0;
};

// One description for reading and writing: `f` is a CellWriter or a CellReader.

template <class File, class Head>
void visit_head(File& f, Head& head) {
  f.field(head.region_path);
  f.field(head.world);
  f.field(head.tasks);
  f.field(head.kinematics);
  f.field(head.margin);
}

template <class File, class Shift>
void visit_shift(File& f, Shift& shift) {
  f.field(shift.parameters);
  f.list(shift.constant);
  f.list(shift.slopes);
  f.list(shift.curvatures);
  f.list(shift.rest);
}

template <class File, class BoxOf>
void visit_box(File& f, BoxOf& box) {
  f.field(box.tasks.center);
  f.field(box.tasks.half);
  f.list(box.path.rows);
  f.list(box.path.shares);
  visit_shift(f, box.shift);
  f.field(box.origin);
  f.field(box.is_proven);
}

template <class File, class Node>
void visit_node(File& f, Node& node) {
  f.field(node.parameter);
  f.field(node.at);
  f.field(node.below);
  f.field(node.above);
  f.list(node.boxes, [](auto& file, auto& index) { file.field(index); });
}

template <class File, class Gap>
void visit_gap(File& f, Gap& gap) {
  f.field(gap.center);
  f.field(gap.half_extents);
  f.field(gap.gap);
  f.field(gap.share);
  f.field(gap.first);
  f.field(gap.other);
  f.field(gap.along);
}

template <class File, class Start>
void visit_start(File& f, Start& start) {
  f.list(start.boxes, [](auto& file, auto& box) { visit_box(file, box); });
  f.list(start.tree, [](auto& file, auto& node) { visit_node(file, node); });
  f.list(start.unproven, [](auto& file, auto& gap) { visit_gap(file, gap); });
}

template <class File, class Starts, class Progress>
void visit_body(File& f, Starts& starts, Progress& progress) {
  f.list(starts, [](auto& file, auto& start) { visit_start(file, start); });
  f.list(progress, [](auto& file, auto& step) { file.field(step); });
}

// What a reader relies on, whatever is in the file.

bool are_finite(std::span<const float> values) {
  return std::ranges::all_of(values, [](float value) { return std::isfinite(value); });
}

bool is_sound(const CellBox& box, std::size_t joints, std::size_t parameters) {
  const GoalShift& shift = box.shift;
  return box.path.size() >= 2 && box.path.rows.size() == joints * box.path.size() &&
         as_index(shift.parameters) == parameters && shift.constant.size() == joints &&
         shift.slopes.size() == parameters * joints &&
         shift.curvatures.size() == parameters * parameters * joints &&
         shift.rest.size() == joints && are_finite(box.path.rows) && are_finite(box.path.shares);
}

bool is_sound(const StartCell& start, std::size_t joints, std::size_t parameters) {
  const auto nodes = static_cast<int>(start.tree.size());
  const auto boxes = static_cast<int>(start.boxes.size());
  for (int i = 0; i < nodes; ++i) {
    const SplitNode& node = start.tree[as_index(i)];
    for (const int box : node.boxes) {
      if (box < 0 || box >= boxes) return false;
    }
    if (node.parameter < 0) continue;
    // Children come later, so that a walk down the tree ends.
    const bool is_inner = node.below > i && node.above > i && node.below < nodes &&
                          node.above < nodes && as_index(node.parameter) < kTaskSize;
    if (!is_inner) return false;
  }
  return nodes > 0 && std::ranges::all_of(start.boxes, [&](const CellBox& box) {
           return is_sound(box, joints, parameters);
         });
}

Result<std::string_view> check_bytes(std::string_view bytes, const std::string& path) {
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
}  // namespace internal

Result<void> Cell::save(const std::string& path) const {
  internal::CellWriter writer;
  internal::CellHead head{std::filesystem::absolute(data_->region.path).lexically_normal().string(),
                          data_->world, internal::hash_tasks(data_->region),
                          data_->region.problem.robot.kinematics_hash(), data_->margin};
  if (!data_->is_of_this_world) head.world.clear();
  internal::visit_head(writer, head);
  internal::visit_body(writer, data_->starts, data_->progress);
  const std::uint64_t checksum = XXH3_64bits(writer.bytes().data(), writer.bytes().size());
  auto file = MNEME_TRY(internal::NewFile::create(path));
  MNEME_TRY(file.write(writer.bytes()));
  MNEME_TRY(file.write({reinterpret_cast<const char*>(&checksum), sizeof checksum}));
  return file.finish();
}

Result<Cell> load_cell(const std::string& path, const std::string& region_path,
                       const ProblemOptions& options) {
  const std::string bytes = MNEME_TRY(internal::read_regular_file(path, internal::kMostCellBytes));
  internal::CellReader reader(MNEME_TRY(internal::check_bytes(bytes, path)));
  internal::CellHead head;
  internal::visit_head(reader, head);
  const CellRegion region =
      MNEME_TRY(load_region(region_path.empty() ? head.region_path : region_path, options));
  MNEME_TRY(internal::check_head(head, region, path));
  auto data = MNEME_TRY(internal::make_cell_data(region, head.margin));
  data->is_of_this_world = head.world == data->world;
  internal::visit_body(reader, data->starts, data->progress);
  const auto joints = internal::as_index(region.problem.robot.joint_count());
  const std::size_t parameters = data->frame.varying().size();
  bool is_sound = reader.is_complete() && data->starts.size() == region.starts.size();
  for (internal::StartCell& start : data->starts) {
    is_sound = is_sound && internal::is_sound(start, joints, parameters);
    if (!is_sound) break;
    for (internal::CellBox& box : start.boxes) {
      const internal::JointVector none =
          internal::JointVector::Zero(region.problem.robot.joint_count());
      box.branch = internal::make_branch(data->chain, box.path.waypoint(box.path.size() - 1, none));
      box.is_proven = box.is_proven && data->is_of_this_world;
    }
  }
  if (!is_sound) {
    return fail(ErrorCode::corrupt, "{}: the cell does not fit together; build it anew", path);
  }
  return Cell(std::move(data));
}

}  // namespace mneme
