// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Saving what can be read of a file whose pages do not fit together: our rows are known by the
/// shape of their records and by their checksums.
#pragma once

#include "mneme/store.h"

#include "upkeep/page_file.h"
#include "store/store.h"

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mneme::internal {

/// Finds everything of ours that a file holds. Not thread-safe.
class CarvedRows {
 public:
  /// Errors: io; corrupt if the one sound row that names the robot is not there.
  [[nodiscard]] static Result<CarvedRows> read(const std::string& path);

  [[nodiscard]] const ExperienceSpace& space() const { return space_; }
  /// Nothing if it is lost.
  [[nodiscard]] const std::optional<StoreState>& head() const { return head_; }
  /// Rows with a sound tombstone.
  [[nodiscard]] const std::set<std::int64_t>& dead() const { return dead_; }
  /// Ids of which anything was found, dead ones included, in order.
  [[nodiscard]] std::vector<std::int64_t> ids() const;
  /// The row of one of ids(); without its parts that are missing or damaged, it has a flaw. Valid
  /// until the next call. Errors: io.
  [[nodiscard]] Result<StoredRow> row(std::int64_t id);

 private:
  struct Part {
    std::int64_t id = 0;
    RecordPlace place;
    bool is_sound = false;
  };
  explicit CarvedRows(PageFile file) : file_(std::move(file)) {}
  void take(const LeafRecord& record, RecordPlace place);
  void take_space(const LeafRecord& record);
  void take_head(const LeafRecord& record);
  void take_tombstone(const LeafRecord& record);
  /// False if there is no part of that id.
  [[nodiscard]] Result<bool> read_part(const std::vector<Part>& parts, std::int64_t id,
                                       LeafRecord& record);

  PageFile file_;
  std::vector<Part> keys_;
  std::vector<Part> mixtures_;
  std::vector<ExperienceSpace> spaces_;
  ExperienceSpace space_;
  std::optional<StoreState> head_;
  std::set<std::int64_t> dead_;
  LeafRecord key_;
  LeafRecord mixture_;
};

/// Replaces the file by one of the present schema with the sound live rows of the old one, each
/// under its id, in one transaction. Rows are read from the leaves they stand in, so that a damaged
/// header or schema, or lost pages, cost no other rows. Adds what cannot be saved to `damages`,
/// unless it is named there already, and takes out of it what could be saved. Returns the name of a
/// copy of the old file. If others write to the file meanwhile, starts over. Errors: corrupt, and
/// nothing is changed, if not even the space can be read; io, also if others go on writing.
[[nodiscard]] Result<std::string> salvage_file(const std::string& path,
                                               std::vector<Damage>& damages);

}  // namespace mneme::internal
