// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Experience to store, and child processes to kill.
#pragma once

#include "mneme/memory.h"
#include "mneme/upkeep.h"

#include "support/support.h"

#include <sqlite3.h>

#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <cmath>
#include <csignal>
#include <functional>

namespace mneme::test {

inline RobotSignature arm_signature() { return {"arm", "", "0123456789abcdef", 3}; }

inline constexpr const char* kPairs = "pairs/1";

/// A canonical key of a pair with a gap.
inline PrimitiveKey random_key(Rng& rng) {
  const double a = rng.uniform(1, 2);
  const double b = rng.uniform(1, 2);
  const double half = 0.5 * (a + b + rng.uniform(0.1, 1));
  const double x = rng.uniform(1, 9);
  const double angle = rng.uniform(-3, 3);
  const double dx = half * std::cos(angle);
  const double dy = half * std::sin(angle);
  return make_primitive({x + dx, dy, a, x - dx, -dy, b}).key;
}

/// `components` random means, some of them with a covariance of their own.
inline Experience random_experience(Rng& rng, int components = 5) {
  Experience experience;
  experience.kind = kPairs;
  experience.key = random_key(rng);
  experience.sampler().joint_count = 3;
  for (int i = 0; i < 3 * components; ++i) {
    experience.sampler().means.push_back(static_cast<float>(rng.uniform(-3, 3)));
  }
  for (int i = 0; i < components; ++i) {
    experience.sampler().factor_rows.push_back(i % 2 == 0 ? -1 : 0);
    experience.sampler().sources.push_back(i);
  }
  for (int i = 0; i < 6; ++i) {
    experience.sampler().factors.push_back(static_cast<float>(rng.uniform(0, 1)));
  }
  experience.provenance = {"test", "starts=3", rng.next(), "2020-01-02T03:04:05Z"};
  return experience;
}

/// A path of five waypoints.
inline Experience random_path(Rng& rng) {
  Experience experience;
  experience.kind = "paths/1";
  for (int i = 0; i < 7; ++i) experience.key.push_back(rng.uniform(-3, 3));
  RememberedPath& path = experience.content.emplace<RememberedPath>();
  path.joint_count = 3;
  for (int i = 0; i < 15; ++i) path.waypoints.push_back(static_cast<float>(rng.uniform(-3, 3)));
  path.constraints = rng.next();
  path.planning_states = rng.next();
  for (int i = 0; i < 5; ++i) path.clearances.push_back(static_cast<float>(rng.uniform(0, 1)));
  for (int i = 0; i < 6; ++i) path.near_misses.push_back(static_cast<float>(rng.uniform(-3, 3)));
  experience.provenance = {"test", "solved", rng.next(), "2020-01-02T03:04:05Z"};
  return experience;
}

inline std::vector<Experience> random_rows(Rng& rng, int count, int components = 5) {
  std::vector<Experience> rows;
  for (int i = 0; i < count; ++i) rows.push_back(random_experience(rng, components));
  return rows;
}

inline bool is_same_provenance(const Provenance& a, const Provenance& b) {
  return a.tool == b.tool && a.settings == b.settings && a.seed == b.seed && a.time == b.time;
}

inline bool is_same_content(const Experience& a, const Experience& b) {
  if (a.kind != b.kind || a.key != b.key || a.is_path() != b.is_path()) return false;
  if (!is_same_provenance(a.provenance, b.provenance)) return false;
  if (a.is_path()) {
    return a.path().joint_count == b.path().joint_count &&
           a.path().waypoints == b.path().waypoints &&
           a.path().constraints == b.path().constraints &&
           a.path().clearances == b.path().clearances &&
           a.path().near_misses == b.path().near_misses &&
           a.path().planning_states == b.path().planning_states;
  }
  const LocalSampler &one = a.sampler(), &other = b.sampler();
  return one.joint_count == other.joint_count && one.means == other.means &&
         one.factor_rows == other.factor_rows && one.factors == other.factors &&
         one.sources == other.sources && one.is_complete == other.is_complete;
}

inline Database open_database(const std::string& path, OpenMode mode = OpenMode::create) {
  return require(Database::open(path, arm_signature(), mode));
}

/// All ways to write down a key.
inline std::vector<PrimitiveKey> keys_of(const PrimitiveKey& canonical) {
  std::vector<PrimitiveKey> keys;
  for (const KeyImage& image : memory_kind_of(kPairs)->images(canonical)) keys.push_back(image.key);
  return keys;
}

/// The rows that are like a pair of circles.
inline Result<std::vector<KeyMatch>> find_like(const Database& database,
                                               const LocalPrimitive& primitive, double threshold,
                                               int max_matches) {
  return database.find(kPairs, keys_of(primitive.key), threshold, max_matches);
}

/// Why opening fails; it must.
inline Error open_error(const std::string& path, OpenMode mode = OpenMode::read_only,
                        const RobotSignature& space = arm_signature()) {
  const Error error = require_error(Database::open(path, space, mode));
  CHECK(contains(error.message, path));
  return error;
}

inline std::string first_damage(const std::string& path) {
  const auto damages = verify_database(path);
  if (!damages) return damages.error().message;
  return damages->empty() ? "" : damages->front().what;
}

/// Does to a file what mneme would not.
inline void run_sql(const std::string& path, const std::string& sql) {
  sqlite3* handle = nullptr;
  REQUIRE(sqlite3_open(path.c_str(), &handle) == SQLITE_OK);
  char* message = nullptr;
  sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, &message);
  CHECK_MESSAGE(message == nullptr, message);
  sqlite3_free(message);
  sqlite3_close(handle);
}

/// Starts `body` in a process of its own, which ends with its result.
inline pid_t start_child(const std::function<int()>& body) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body());
  return child;
}

/// The exit status of a child, or -1 if it was killed.
inline int wait_for(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Lets time pass without sleep, which would wake up too late.
inline void spin(std::chrono::microseconds duration) {
  const auto end = std::chrono::steady_clock::now() + duration;
  while (std::chrono::steady_clock::now() < end) {
  }
}

}  // namespace mneme::test
