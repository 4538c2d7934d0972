// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The engine that a URL asks for.
#pragma once

#include "mneme/base.h"

#include "store/store.h"
#include "engines/task_queue.h"

#include <string>
#include <vector>

namespace mneme::internal {

/// Errors: unsupported if the engine is unknown or was not built in; those of the engine.
[[nodiscard]] Result<std::unique_ptr<Store>> open_store(const std::string& url, OpenMode mode);

/// Opens a store that must hold experience of `signature`, and creates it if `mode` says so;
/// returns it with its schema version. Errors: wrong_robot.
struct OpenedStore {
  std::unique_ptr<Store> store;
  RobotSignature signature;
  int schema_version = 0;
};
[[nodiscard]] Result<OpenedStore> open_store_of(const std::string& url,
                                                const RobotSignature& signature, OpenMode mode);
/// Opens a store for reading, whatever signature it is of; the signature of an empty one has no
/// joints.
[[nodiscard]] Result<OpenedStore> inspect_store(const std::string& url);

/// The tasks that processes share beside the database of `signature` at `url`. Errors: unsupported
/// if it is not on a PostgreSQL server.
[[nodiscard]] Result<std::unique_ptr<TaskQueue>> open_tasks(const std::string& url,
                                                            const RobotSignature& signature,
                                                            TaskOwner owner);

/// The same error; if it says that `url` is damaged, with the command that helps.
[[nodiscard]] Error with_advice(Error error, const std::string& url);
/// The same result, its error with_advice().
template <class T>
[[nodiscard]] Result<T> advised(Result<T> result, const std::string& url) {
  if (!result) return tl::unexpected(with_advice(std::move(result).error(), url));
  return result;
}

enum class Engine { sqlite, postgresql };

/// A path is SQLite's, whatever characters are in it, unless it begins like a URL: letters and
/// "://". Errors: unsupported for other schemes than postgresql and postgres.
[[nodiscard]] Result<Engine> engine_of(const std::string& url);

/// The same database by a name that stays right when the process changes its directory.
[[nodiscard]] std::string lasting_url(const std::string& url);

/// A PostgreSQL URL for messages: with asterisks for the password.
[[nodiscard]] std::string without_password(const std::string& url);

}  // namespace mneme::internal
