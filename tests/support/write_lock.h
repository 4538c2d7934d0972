// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// A lock that another process may hold.
#pragma once

#include <doctest/doctest.h>
#include <sqlite3.h>

#include <string>

namespace mneme::test {

/// Locks a database file against writing. Waits for writers that hold it.
class WriteLock {
 public:
  explicit WriteLock(const std::string& path) {
    REQUIRE(sqlite3_open(path.c_str(), &handle_) == SQLITE_OK);
    sqlite3_busy_timeout(handle_, 60000);
    REQUIRE(sqlite3_exec(handle_, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr) == SQLITE_OK);
  }
  WriteLock(const WriteLock&) = delete;
  WriteLock& operator=(const WriteLock&) = delete;
  ~WriteLock() { sqlite3_close(handle_); }

 private:
  sqlite3* handle_ = nullptr;
};

}  // namespace mneme::test
