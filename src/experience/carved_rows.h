// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Our rows in a damaged file, known by the shape of their records and by their checksums.
#pragma once

#include "experience/page_file.h"
#include "experience/store.h"

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

}  // namespace mneme::internal
