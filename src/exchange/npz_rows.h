// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Experience as the arrays of a .npz file.
#pragma once

#include "mneme/store.h"

#include "exchange/npz_file.h"

#include <map>
#include <span>
#include <string>
#include <vector>

namespace mneme::internal {

/// Collects rows column by column.
class NpzColumns {
 public:
  explicit NpzColumns(const ExperienceSpace& space) : space_(space) {}
  void add(const Experience& row);
  /// All arrays by name, in the order of the file.
  [[nodiscard]] std::vector<std::pair<std::string, NpyArray>> arrays() const;

 private:
  /// Texts that many rows share: each once, and per row its place.
  struct Texts {
    std::map<std::string, std::int32_t> places;
    std::vector<std::string> unique;
    std::vector<std::int32_t> rows;
    void add(const std::string& text);
  };

  ExperienceSpace space_;
  std::vector<double> keys_;
  std::vector<std::int64_t> key_ends_;
  std::vector<float> means_;
  std::vector<float> factors_;
  std::vector<std::int32_t> factor_rows_;
  std::vector<std::int32_t> origins_;
  std::vector<std::int64_t> mean_ends_;
  std::vector<std::int64_t> factor_ends_;
  std::vector<std::int64_t> factor_row_ends_;
  std::vector<std::int64_t> origin_ends_;
  std::vector<std::uint64_t> seeds_;
  Texts kinds_, settings_, tools_, times_;
};

/// What the arrays of a file hold.
struct NpzRows {
  ExperienceSpace space;
  std::vector<Experience> rows;
};
/// Errors: parse, naming the array, without the file. Values are not checked against the space.
[[nodiscard]] Result<NpzRows> rows_of(const std::map<std::string, NpyArray>& arrays);

}  // namespace mneme::internal
