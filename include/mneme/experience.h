// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The database of local samplers.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mneme/base.h"
#include "mneme/primitive.h"
#include "mneme/sampling.h"

namespace mneme {

/// The parameters of p_i(x | lw_i) in the canonical frame of its primitive.
using LocalSampler = GaussianMixture;

/// Where a row of experience came from.
struct Provenance {
  std::string tool;      ///< such as "mneme 0.1.0"
  std::string settings;  ///< of the learning, as text
  std::uint64_t seed = 0;
  std::string time;  ///< UTC, ISO 8601; filled in by insert() if empty
};

/// A row of the database: key -> local sampler. An empty sampler says that the primitive was tried
/// and that nothing passes it.
struct Experience {
  std::int64_t id = 0;  ///< given by the database
  PrimitiveKey key;
  LocalSampler sampler;
  Provenance provenance;
};

/// What decides whether experience applies at all.
struct ExperienceSpace {
  std::string robot_name;  ///< for messages only
  std::string robot_hash;  ///< Robot::hash()
  std::string decomposer;  ///< decomposer_version()
  int joint_count = 0;
  int key_size = 0;
};
/// An empty `decomposer` is the robot's own.
[[nodiscard]] Result<ExperienceSpace> make_space(const Robot& robot,
                                                 const std::string& decomposer = "");

/// A stored experience that is similar to a query.
struct Match {
  const Experience* experience = nullptr;  ///< valid as long as the database
  double similarity_error = 0;             ///< squared distance of the keys
  Symmetry to_scene;                       ///< takes the stored means to the query's scene
};

struct DatabaseInfo {
  std::string url;
  ExperienceSpace space;
  std::int64_t samplers = 0;
  std::int64_t components = 0;
  std::int64_t bytes = 0;  ///< of the file and its write-ahead log
  int schema_version = 0;
};

/// One damaged row, or damage to the file itself (id 0).
struct Damage {
  std::int64_t id = 0;
  std::string what;
};

enum class OpenMode { read_only, read_write, create };

/// An append-only store of experience in one SQLite file (docs/database.md). All rows are in memory
/// while it is open. find() and get() may run in parallel with each other; insert() may run in
/// parallel with them and with itself. Another process may insert at the same time; its rows are
/// seen at the next opening.
class Database {
 public:
  /// Opens `path`. With `create`, a missing or empty file becomes an empty database of `space`; a
  /// file that was being created when its process was killed counts as empty. An empty file that is
  /// only read is an empty database too. Errors: wrong_robot if the database is not of `space`;
  /// corrupt if it is no database, or damaged; unsupported if a newer mneme wrote it; io.
  [[nodiscard]] static Result<Database> open(const std::string& path, const ExperienceSpace& space,
                                             OpenMode mode);
  /// Opens for reading whatever space it is of, to look at it.
  [[nodiscard]] static Result<Database> inspect(const std::string& path);

  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;
  ~Database();

  [[nodiscard]] const ExperienceSpace& space() const;
  [[nodiscard]] DatabaseInfo info() const;
  [[nodiscard]] std::int64_t size() const;
  /// Experience by position, 0 to size() - 1, in order of insertion.
  [[nodiscard]] const Experience& get(std::int64_t position) const;

  /// The experiences whose similarity error to `primitive` is less than `threshold`, nearest first,
  /// at most `max_matches` (0: all). Ties are broken by id. O(log size) for few matches.
  [[nodiscard]] std::vector<Match> find(const LocalPrimitive& primitive, double threshold,
                                        int max_matches) const;

  /// Appends rows in one transaction. Once it returns without an error they survive a killed
  /// process and a loss of power. Returns the ids. Errors: io (disk full, read-only, locked),
  /// invalid (wrong sizes, not finite, a number of a key beyond 1e6); then nothing was inserted.
  Result<std::vector<std::int64_t>> insert(std::vector<Experience> rows);

 private:
  struct State;
  explicit Database(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Checks the file's structure and every row's checksum. Empty if all is well. Errors: io;
/// unsupported if a newer mneme wrote the file.
[[nodiscard]] Result<std::vector<Damage>> verify_database(const std::string& path);

}  // namespace mneme
