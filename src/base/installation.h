// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace mneme::internal {

/// share/mneme of the prefix that `file` is installed under: the directory that holds the innermost
/// bin or lib on its path. Empty if there is none, or if the path is relative.
[[nodiscard]] std::filesystem::path shared_data_of(const std::filesystem::path& file);

}  // namespace mneme::internal
