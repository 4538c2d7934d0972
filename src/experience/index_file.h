// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The index of a database's keys in a file, so that opening need not read all rows. It is only a
/// copy: an invalid one is ignored.
#pragma once

#include "experience/key_index.h"
#include "store/store.h"

#include <optional>
#include <string>

namespace mneme::internal {

/// An index and the state of the store it was built from.
struct SavedIndex {
  StoreState state;
  GroupIndexes groups;
};

/// Path of the index: the database's path with `.index` appended, or for a server a file in the
/// user's cache directory. Empty if there is no such directory.
[[nodiscard]] std::string index_file_of(const std::string& url);

/// Writes the index; creates the directory if missing. Returns false on failure.
bool save_index(const std::string& file, const RobotSignature& signature, const StoreState& state,
                const GroupIndexes& groups);

/// Reads the index. Nothing if the file is missing, damaged, or of another robot or version.
[[nodiscard]] std::optional<SavedIndex> load_index(const std::string& file,
                                                   const RobotSignature& signature);

}  // namespace mneme::internal
