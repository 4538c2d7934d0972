// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The index of a database's keys in a file, so that opening need not read all rows. Only a copy:
/// whatever is wrong with it, the rows say what is right.
#pragma once

#include "experience/key_index.h"
#include "store/store.h"

#include <optional>
#include <string>

namespace mneme::internal {

/// An index, and the state of the store that it is of.
struct SavedIndex {
  StoreState state;
  GroupIndexes groups;
};

/// Beside a file with `.index` behind its name; of a server in the user's cache. Empty if there is
/// no place.
[[nodiscard]] std::string index_file_of(const std::string& url);

/// Makes the directory if it is missing. False if it cannot be written.
bool save_index(const std::string& file, const RobotSignature& signature, const StoreState& state,
                const GroupIndexes& groups);

/// Nothing if there is no file, or it is damaged, or of another robot or version.
[[nodiscard]] std::optional<SavedIndex> load_index(const std::string& file,
                                                   const RobotSignature& signature);

}  // namespace mneme::internal
