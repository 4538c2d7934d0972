// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// What a database's URL names.
#pragma once

#include "mneme/base.h"

#include <string>

namespace mneme::internal {

enum class Engine { sqlite, postgresql };

/// A path is SQLite's, whatever characters are in it, unless it begins like a URL: letters and
/// "://". Errors: unsupported for other schemes than postgresql and postgres.
[[nodiscard]] Result<Engine> engine_of(const std::string& url);

/// A PostgreSQL URL for messages: with asterisks for the password.
[[nodiscard]] std::string without_password(const std::string& url);

}  // namespace mneme::internal
