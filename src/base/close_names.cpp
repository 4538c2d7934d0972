// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "base/text.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace mneme::internal {
namespace {

/// In bytes. An edit distance costs the product of two lengths, and names come from the input.
constexpr std::size_t kLongestCompared = 64;

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
    const bool is_long = std::max(name.size(), candidate.size()) > kLongestCompared;
    const int distance = is_long ? std::numeric_limits<int>::max() : edit_distance(name, candidate);
    ranked.emplace_back(distance, std::move(candidate));
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
  if (word.size() > internal::kLongestCompared) return "";
  const std::string wanted = internal::letters_of(word);
  const std::string* nearest = nullptr;
  const auto letters = static_cast<int>(wanted.size());
  int least = std::min(letters, 2 + letters / 3);
  for (const std::string& name : names) {
    if (name.size() > internal::kLongestCompared) continue;
    const int distance = internal::edit_distance(wanted, internal::letters_of(name));
    if (distance >= least) continue;
    least = distance;
    nearest = &name;
  }
  return nearest == nullptr ? "" : "; did you mean '" + *nearest + "'?";
}

}  // namespace mneme
