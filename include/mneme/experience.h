// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The database of local samplers.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/store.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme {
namespace internal {
struct OpenedStore;
}

[[nodiscard]] RobotSignature make_signature(const Robot& robot);

/// How a robot differs from the one that experience was learned with, the least first.
enum class RobotDifference {
  none,
  shapes,  ///< its collision model: spheres, fingers, tools, checked pairs; experience applies
  limits,  ///< its limits too: `adopt_database` makes experience apply
  frames,  ///< its joints, their order or their frames: another arm
};
/// `frames` where a signature without kinematics, of an older database, names another model.
[[nodiscard]] RobotDifference compare_robots(const RobotSignature& learned_with,
                                             const RobotSignature& robot);

/// A stored experience whose key is near one that was asked for.
struct KeyMatch {
  std::shared_ptr<const Experience> experience;  ///< never null
  double similarity_error = 0;                   ///< squared distance of the keys, in their unit
  std::size_t image = 0;  ///< which of the keys that were asked for is nearest
};

/// The rows of one kind.
struct KindInfo {
  std::string kind;
  int key_size = 0;  ///< numbers in a key
  std::int64_t samplers = 0;
  std::int64_t components = 0;
};

struct DatabaseInfo {
  std::string url;  ///< without a password
  RobotSignature signature;
  std::vector<KindInfo> kinds;  ///< in order of name
  std::int64_t samplers = 0;
  std::int64_t components = 0;
  std::int64_t bytes = 0;       ///< of the file and its write-ahead log, or of the server's tables
  int schema_version = 0;       ///< 0 if there is nothing in it yet
  std::int64_t generation = 0;  ///< changes so far
  std::int64_t tombstones = 0;  ///< rows set aside: damaged, or superseded in a merge
};

/// How a database is kept open.
struct DatabaseSettings {
  /// Bytes of rows in memory, without their keys; at least 0. A database whose file (or tables on a
  /// server) is larger reads only the keys when it is opened, and a row when it first matches;
  /// those that were not asked for the longest time are dropped again. A smaller one is in memory
  /// as a whole, and all of it is checked when it is opened.
  std::int64_t memory_bytes = std::int64_t{256} << 20;
};

/// An append-only set of experience in one SQLite file or on a PostgreSQL server
/// (docs/design/database.md). A URL is the path of a file or `postgresql://...`, as libpq reads it.
/// All keys are in memory while it is open, and rows as far as the settings allow. Const is
/// parallel-safe; insert() and refresh() may run in parallel with all of it and with themselves,
/// and find() does not wait for them. Another process may insert at the same time; its rows are
/// seen after the next refresh(), insert() or opening.
class Database {
 public:
  /// Opens `url`. With `create`, a missing or empty file, or a server without our tables, becomes
  /// an empty database of that robot; a file that was being created when its process was killed
  /// counts as empty. An empty file that is only read is an empty database too. Errors: wrong_robot
  /// if the database is of another robot; corrupt if it is no database, or damaged; unsupported if
  /// a newer or an older mneme wrote it, or if this mneme was built without the engine; io.
  [[nodiscard]] static Result<Database> open(const std::string& url,
                                             const RobotSignature& signature, OpenMode mode,
                                             const DatabaseSettings& settings = {});
  /// Opens for reading, whatever robot it is of.
  [[nodiscard]] static Result<Database> inspect(const std::string& url,
                                                const DatabaseSettings& settings = {});

  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;
  ~Database();

  [[nodiscard]] const RobotSignature& signature() const;
  [[nodiscard]] DatabaseInfo info() const;
  /// The kinds of rows that are there, in order of name.
  [[nodiscard]] std::vector<KindInfo> kinds() const;
  [[nodiscard]] std::int64_t size() const;
  /// Experience by position, 0 to size() - 1: kind by kind as in kinds(), paths under the same
  /// constraints together, and otherwise in order of insertion. Errors: invalid; as of find().
  [[nodiscard]] Result<Experience> get(std::int64_t position) const;
  /// Visits all experience in the order of positions. Errors: as of find().
  [[nodiscard]] Result<void> for_each(
      const std::function<void(const std::shared_ptr<const Experience>&)>& visit) const;

  /// The experiences of `kind` whose key's squared distance to the nearest of `images` is less than
  /// `threshold`, nearest first, at most `max_matches` (0: all). Ties are broken by id; each row
  /// comes once. `images` are the ways to write down one key; of another length than the kind's
  /// keys they match nothing. Looks at the boxes around some 1000 keys each, in those near enough
  /// at the boxes around some 64, and at the keys in those that are. Never at more keys than
  /// `keys_left` allows, if it is not null: those that were looked at, for all images, are taken
  /// from it, by up to 64, and without any left those that were found count. Errors, of rows that
  /// are not in memory: corrupt, naming a damaged one; io. Only paths under `constraints` are
  /// found; samplers are under 0.
  [[nodiscard]] Result<std::vector<KeyMatch>> find(std::string_view kind,
                                                   std::span<const std::vector<double>> images,
                                                   double threshold, int max_matches,
                                                   std::int64_t* keys_left = nullptr,
                                                   std::uint64_t constraints = 0) const;

  /// Appends rows in one transaction. Once it returns without an error they survive a killed
  /// process and a loss of power. A row whose kind, key and content are those of a
  /// row that is there already is not added again, so that a failed insertion can be repeated
  /// safely. The first row of a kind decides how long its keys are. Returns the ids, and
  /// in `is_new`, if it is not null, for each row whether it was added. Errors: io (disk full,
  /// read-only, locked, connection lost), invalid (wrong sizes, not finite, a number of a key
  /// beyond 1e6, text that is not UTF-8); then nothing was inserted, unless the connection was lost
  /// during the very last step.
  Result<std::vector<std::int64_t>> insert(std::vector<Experience> rows,
                                           std::vector<bool>* is_new = nullptr);

  /// Whether memory may grow again, for what planning has cost: adds `iterations` to those that
  /// came together in this process; once there are `price` of them, begins anew and says yes. With
  /// a row for each yes, K iterations insert at most K / price rows, whatever the queries are.
  [[nodiscard]] bool earns_row(std::uint64_t iterations, std::uint64_t price);

  /// Reads what other processes have added since it was opened or refreshed, and forgets rows that
  /// were set aside; Matches stay valid. Returns the number of rows that came. One small question
  /// to the database if nothing changed. Errors: io, corrupt; then nothing changed in memory.
  Result<std::int64_t> refresh();

 private:
  struct State;
  explicit Database(std::unique_ptr<State> state);
  static Result<Database> load(Result<internal::OpenedStore> opened, const std::string& url,
                               const DatabaseSettings& settings);
  std::unique_ptr<State> state_;
};

}  // namespace mneme
