// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Columns of the tables, in one order for both engines. A Source has integer(column),
/// text(column), blob(column) and is_null(column); a Sink has add(value), called in the order of
/// the columns.
#pragma once

#include "store/store.h"

#include <bit>
#include <optional>
#include <string>
#include <string_view>

namespace mneme::internal {

inline constexpr std::string_view kKeyColumns =
    "e.id, e.generation, e.cell, e.kind, e.content, e.components, e.constraint_hash, e.key, "
    "e.checksum";
inline constexpr std::string_view kMixtureColumns =
    "m.is_path, m.means, m.factor_rows, m.factors, m.sources, m.is_complete, m.planning_states, "
    "m.tool, m.settings, m.seed, m.time, m.checksum, m.id";
inline constexpr int kKeyWidth = 9, kMixtureWidth = 14, kTombstoneWidth = 6;
inline constexpr std::string_view kHeadColumns =
    "generation, epoch, last_row, last_tombstone, row_count, row_digest, tombstone_count, "
    "tombstone_digest, checksum";
inline constexpr std::string_view kRobotColumns =
    "robot_name, kinematics_hash, model_hash, joint_count, checksum";

/// Reads a row of kKeyColumns and, unless only keys are read, kMixtureColumns.
template <class Source>
StoredRow read_row(const Source& source, RowParts parts) {
  StoredRow row;
  RowView& columns = row.columns;
  int i = 0;
  row.id = source.integer(i++);
  row.generation = source.integer(i++);
  row.cell = source.integer(i++);
  columns.kind = source.text(i++);
  row.content = source.blob(i++);
  row.components = source.integer(i++);
  columns.constraints = source.integer(i++);
  columns.key = source.blob(i++);
  row.key_checksum = source.integer(i++);
  if (parts == RowParts::keys) return row;
  columns.is_path = source.integer(i++) != 0;
  columns.means = source.blob(i++);
  columns.factor_rows = source.blob(i++);
  columns.factors = source.blob(i++);
  columns.sources = source.blob(i++);
  columns.is_complete = source.integer(i++) != 0;
  if (!source.is_null(i)) columns.planning_states = source.integer(i);
  columns.tool = source.text(++i);
  columns.settings = source.text(++i);
  columns.seed = source.integer(++i);
  columns.time = source.text(++i);
  row.mixture_checksum = source.integer(++i);
  if (source.is_null(++i)) row.flaw = "its mixture is missing";
  return row;
}

/// Writes the columns of `experience`.
template <class Sink>
void write_key(Sink& sink, const StoredRow& row) {
  const RowView& columns = row.columns;
  sink.add(row.id).add(row.generation).add(row.cell).add(columns.kind).add(row.content);
  sink.add(row.components).add(columns.constraints).add(columns.key).add(row.key_checksum);
}

/// Writes the columns of `mixture`.
template <class Sink>
void write_mixture(Sink& sink, const StoredRow& row) {
  const RowView& columns = row.columns;
  sink.add(row.id).add(row.cell).add(std::int64_t{columns.is_path}).add(columns.means);
  sink.add(columns.factor_rows).add(columns.factors).add(columns.sources);
  sink.add(std::int64_t{columns.is_complete}).add(columns.planning_states).add(columns.tool);
  sink.add(columns.settings).add(columns.seed).add(columns.time).add(row.mixture_checksum);
}

/// Reads id, tool, settings, seed and time of a row with that content.
template <class Source>
KnownRow read_known_row(const Source& source, const ContentHash& content) {
  const Provenance provenance{std::string(source.text(1)), std::string(source.text(2)),
                              static_cast<std::uint64_t>(source.integer(3)),
                              std::string(source.text(4))};
  return {content, source.integer(0), provenance};
}

/// Reads the columns of a LessonMark: lesson, content, and whether a usable row has that content.
template <class Source>
LessonMark read_lesson(const Source& source) {
  return {std::bit_cast<std::uint64_t>(source.integer(0)), to_content_hash(source.blob(1)),
          source.integer(2) != 0};
}

template <class Source>
Tombstone read_tombstone(const Source& source) {
  return {source.integer(0),           source.integer(1),           source.integer(2),
          std::string(source.text(3)), std::string(source.text(4)), source.integer(5)};
}

template <class Sink>
void write_tombstone(Sink& sink, const Tombstone& tombstone) {
  sink.add(tombstone.id).add(tombstone.row).add(tombstone.generation);
  sink.add(std::string_view(tombstone.reason)).add(std::string_view(tombstone.time));
  sink.add(tombstone.checksum);
}

/// Reads a row of kHeadColumns; nothing if it is damaged.
template <class Source>
std::optional<StoreState> parse_head(const Source& source) {
  std::array<std::int64_t, kHeadSize> numbers{};
  for (int i = 0; i < kHeadSize; ++i) numbers[static_cast<std::size_t>(i)] = source.integer(i);
  if (source.integer(kHeadSize) != hash_numbers(numbers)) return std::nullopt;
  return to_state(numbers);
}

/// Reads a row of kRobotColumns; nothing if it is damaged.
template <class Source>
std::optional<RobotSignature> parse_robot(const Source& source) {
  RobotSignature robot{std::string(source.text(0)), std::string(source.text(1)),
                       std::string(source.text(2)), static_cast<int>(source.integer(3))};
  const bool is_sound = source.integer(4) == checksum_of(robot) && robot.joint_count >= 1;
  return is_sound ? std::optional(std::move(robot)) : std::nullopt;
}

}  // namespace mneme::internal
