// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Opens the database engine that a URL selects.
#pragma once

#include "mneme/base.h"

#include "store/store.h"
#include "engines/task_queue.h"

#include <string>

namespace mneme::internal {

/// Opens the store at `url`. Errors: unsupported if the engine is unknown or was not built in;
/// those of the engine.
[[nodiscard]] Result<std::unique_ptr<Store>> open_store(const std::string& url, OpenMode mode,
                                                        const OpenOptions& options = {});

struct OpenedStore {
  std::unique_ptr<Store> store;
  RobotSignature signature;
  int schema_version = 0;
};
/// Opens a store of the robot `signature`; creates it if `mode` allows. A file is not created
/// before the first row. Error: wrong_robot.
[[nodiscard]] Result<OpenedStore> open_store_of(const std::string& url,
                                                const RobotSignature& signature, OpenMode mode,
                                                const OpenOptions& options = {});
/// Opens a store of any robot for reading. The signature of an empty store has 0 joints.
[[nodiscard]] Result<OpenedStore> inspect_store(const std::string& url,
                                                const OpenOptions& options = {});

/// Opens the shared task queue of the database at `url`. Error: unsupported if it is not on a
/// PostgreSQL server.
[[nodiscard]] Result<std::unique_ptr<TaskQueue>> open_tasks(const std::string& url,
                                                            const RobotSignature& signature,
                                                            TaskOwner owner);

/// The error; if its code is corrupt, with advice to run `mneme db verify`.
[[nodiscard]] Error with_advice(Error error, const std::string& url);
/// The result, its error passed through with_advice().
template <class T>
[[nodiscard]] Result<T> advised(Result<T> result, const std::string& url) {
  if (!result) return tl::unexpected(with_advice(std::move(result).error(), url));
  return result;
}

/// The shell command that saves the readable rows of a damaged file into a new file next to it.
/// Uses sqlite3's .recover, or .dump where SQLite is built without the table that .recover needs.
[[nodiscard]] std::string saving_command(const std::string& path);

enum class Engine { sqlite, postgresql };

/// Engine of a URL. Everything that does not start with letters and "://" is the path of an SQLite
/// file. Error: unsupported for schemes other than postgresql and postgres.
[[nodiscard]] Result<Engine> engine_of(const std::string& url);

/// The URL with an absolute path, valid after the process changes its directory.
[[nodiscard]] std::string lasting_url(const std::string& url);

/// The URL with its password replaced by asterisks, for messages.
[[nodiscard]] std::string without_password(const std::string& url);

}  // namespace mneme::internal
