// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/text_table.h"

#include "report/markup.h"

#include <algorithm>

namespace mneme::internal {

std::string text_table(const std::vector<std::vector<std::string>>& lines,
                       std::size_t name_columns) {
  std::vector<int> widths;
  for (const auto& cells : lines) {
    widths.resize(std::max(widths.size(), cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      widths[i] = std::max(widths[i], character_count(cells[i]));
    }
  }
  std::string text;
  for (const auto& cells : lines) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string padding(static_cast<std::size_t>(widths[i] - character_count(cells[i])),
                                ' ');
      text += i < name_columns ? cells[i] + padding : padding + cells[i];
      if (i + 1 < cells.size()) text += "  ";
    }
    text += '\n';
  }
  return text;
}

}  // namespace mneme::internal
