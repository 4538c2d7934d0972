// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "base/installation.h"

namespace mneme::internal {

std::filesystem::path shared_data_of(const std::filesystem::path& file) {
  if (!file.is_absolute()) return {};
  for (std::filesystem::path at = file.parent_path(); at != at.root_path(); at = at.parent_path()) {
    if (at.filename() == "bin" || at.filename() == "lib") {
      return at.parent_path() / "share" / "mneme";
    }
  }
  return {};
}

}  // namespace mneme::internal
