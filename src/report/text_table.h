// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Tables of text with aligned columns.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mneme::internal {

/// Lines of cells, as many in each: the first `name_columns` of them are aligned left, the others
/// right. Cells hold well-formed UTF-8 without line breaks.
[[nodiscard]] std::string text_table(const std::vector<std::vector<std::string>>& lines,
                                     std::size_t name_columns);

}  // namespace mneme::internal
