// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/motion_memory.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <tuple>
#include <utility>

namespace mneme::internal {
namespace {

bool holds_motions(const KindSettings& kind) { return kind.kind->is_placed_by_checking; }

const MemoryKind& kind_of_motions(const Query& query) {
  return *std::ranges::find_if(query.kinds, holds_motions)->kind;
}

/// All rows of motions. A database that cannot be read has none: motions are a hint.
std::vector<std::shared_ptr<const Experience>> read_motions(const Query& query) {
  std::vector<std::shared_ptr<const Experience>> rows;
  const MemoryKind& kind = kind_of_motions(query);
  const std::vector<PrimitiveKey> anywhere = {
      PrimitiveKey(static_cast<std::size_t>(kind.key_size(query.problem.robot)), 0.0)};
  auto found =
      query.database->find(kind.version, anywhere, std::numeric_limits<double>::infinity(), 0);
  if (!found) return rows;
  for (KeyMatch& match : *found) {
    if (match.experience->is_path()) rows.push_back(std::move(match.experience));
  }
  return rows;
}

}  // namespace

bool MotionMemory::is_used(const Query& query) {
  return query.database != nullptr && query.sampler.uses_memory &&
         std::ranges::any_of(query.kinds, holds_motions);
}

bool MotionMemory::knows_places() const {
  return resolved_.cell != nullptr && !resolved_.cell->places().empty();
}

double MotionMemory::trust() const {
  const Query& query = resolved_.query;
  return query.database->trust(kind_of_motions(query).version);
}

void MotionMemory::load(std::vector<PlacedMotion>& placed) {
  finder_.emplace(resolved_.checker);
  const MotionPlaces known = resolved_.cell ? resolved_.cell->places().copy() : MotionPlaces();
  for (auto& row : read_motions(resolved_.query)) {
    rows_.push_back({EncodedRow(*row).content(), std::move(row)});
  }
  // Expensive searches first, each twice as expensive as the next; otherwise in random order, which
  // spreads the motions of one passage: any one of them will do.
  std::ranges::sort(rows_, {}, [](const Row& row) {
    const std::uint64_t states = row.experience->path().planning_states.value_or(0);
    // libstdc++ 12 returns an unsigned width, which has no negative.
    return std::tuple(-static_cast<int>(std::bit_width(states)), row.content);
  });
  const auto is_known = [&](const Row& row) { return known.contains(row.content); };
  next_ = static_cast<std::size_t>(std::stable_partition(rows_.begin(), rows_.end(), is_known) -
                                   rows_.begin());
  for (std::size_t i = 0; i < next_; ++i) place(i, known.at(rows_[i].content), placed);
}

void MotionMemory::place(std::size_t row, const std::vector<float>& places,
                         std::vector<PlacedMotion>& placed) const {
  for (const float one : places) {
    placed.push_back({finder_->placed(rows_[row].experience->path(), one), static_cast<int>(row)});
  }
}

bool MotionMemory::find_more(std::vector<PlacedMotion>& placed, CheckCounters& counters) {
  if (!finder_) {
    load(placed);
  } else if (next_ < rows_.size()) {
    const std::size_t row = next_++;
    std::vector<float> places = finder_->find(rows_[row].experience->path(), counters);
    place(row, places, placed);
    found_.places.emplace(rows_[row].content, std::move(places));
  }
  return next_ < rows_.size();
}

void MotionMemory::report(std::uint64_t states, std::span<const int> followed) {
  const MemoryKind& kind = kind_of_motions(resolved_.query);
  found_.kind = kind.version;
  found_.states = states;
  for (const int row : followed) {
    const RememberedPath& motion = rows_[static_cast<std::size_t>(row)].experience->path();
    found_.saved += motion.planning_states.value_or(kind.least_work);
  }
}

}  // namespace mneme::internal
