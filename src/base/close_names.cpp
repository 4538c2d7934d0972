// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "base/text.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace mneme::internal {
namespace {

char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// RRTConnect, rrt-connect and rrt_connect are one name.
std::string letters_of(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (c != '_' && c != '-' && c != ' ') letters += lower_case(c);
  }
  return letters;
}

}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (const char letter : a) {
    int diagonal = row[0]++;
    for (std::size_t j = 1; j < row.size(); ++j) {
      const int replaced = diagonal + (lower_case(letter) == lower_case(b[j - 1]) ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

std::vector<std::string> close_names(const std::string& name, std::vector<std::string> names,
                                     std::size_t count) {
  std::vector<std::pair<int, std::string>> ranked;
  for (std::string& candidate : names) {
    ranked.emplace_back(edit_distance(name, candidate), std::move(candidate));
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> result;
  for (std::size_t i = 0; i < std::min(count, ranked.size()); ++i) {
    result.push_back(std::move(ranked[i].second));
  }
  return result;
}

}  // namespace mneme::internal

namespace mneme {

std::string did_you_mean(std::string_view word, std::span<const std::string> names) {
  const std::string wanted = internal::letters_of(word);
  const std::string* nearest = nullptr;
  const auto letters = static_cast<int>(wanted.size());
  int least = std::min(letters, 2 + letters / 3);
  for (const std::string& name : names) {
    const int distance = internal::edit_distance(wanted, internal::letters_of(name));
    if (distance >= least) continue;
    least = distance;
    nearest = &name;
  }
  return nearest == nullptr ? "" : "; did you mean '" + *nearest + "'?";
}

}  // namespace mneme
