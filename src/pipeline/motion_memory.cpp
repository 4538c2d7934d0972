// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/motion_memory.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace mneme::internal {
namespace {

bool holds_motions(const KindSettings& kind) { return kind.kind->is_placed_by_checking; }

/// All rows of motions, the most expensive searches first. A database that cannot be read has none:
/// motions are a hint.
std::vector<std::shared_ptr<const Experience>> read_motions(const Query& query) {
  std::vector<std::shared_ptr<const Experience>> rows;
  const MemoryKind& kind = *std::ranges::find_if(query.kinds, holds_motions)->kind;
  const std::vector<PrimitiveKey> anywhere = {
      PrimitiveKey(static_cast<std::size_t>(kind.key_size(query.problem.robot)), 0.0)};
  auto found =
      query.database->find(kind.version, anywhere, std::numeric_limits<double>::infinity(), 0);
  if (!found) return rows;
  for (KeyMatch& match : *found) {
    if (match.experience->is_path()) rows.push_back(std::move(match.experience));
  }
  std::ranges::sort(rows, {}, [](const std::shared_ptr<const Experience>& row) {
    return std::tuple(~row->path().planning_states.value_or(0), row->id);
  });
  return rows;
}

}  // namespace

bool MotionMemory::is_used(const Query& query) {
  return query.database != nullptr && query.sampler.uses_memory &&
         std::ranges::any_of(query.kinds, holds_motions);
}

void MotionMemory::load(std::vector<std::vector<float>>& placed) {
  finder_.emplace(resolved_.checker);
  const MotionPlaces known = resolved_.cell ? resolved_.cell->places().copy() : MotionPlaces();
  for (auto& row : read_motions(resolved_.query)) {
    const ContentHash content = EncodedRow(*row).content();
    if (const auto places = known.find(content); places != known.end()) {
      place(row->path(), places->second, placed);
    } else {
      rows_.push_back({content, std::move(row)});
    }
  }
}

void MotionMemory::place(const RememberedPath& motion, const std::vector<float>& places,
                         std::vector<std::vector<float>>& placed) const {
  for (const float one : places) placed.push_back(finder_->placed(motion, one));
}

bool MotionMemory::find_more(std::vector<std::vector<float>>& placed, CheckCounters& counters) {
  if (!finder_) {
    load(placed);
  } else if (next_ < rows_.size()) {
    const Row& row = rows_[next_++];
    const RememberedPath& motion = row.experience->path();
    std::vector<float> places = finder_->find(motion, counters);
    place(motion, places, placed);
    found_.emplace(row.content, std::move(places));
  }
  return next_ < rows_.size();
}

}  // namespace mneme::internal
