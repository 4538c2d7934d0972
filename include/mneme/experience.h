// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The database of experience: local samplers and remembered paths, found by their keys.
#pragma once

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/store.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace mneme {
namespace internal {
struct OpenedStore;
struct OpenOptions;
}  // namespace internal

[[nodiscard]] RobotSignature make_signature(const Robot& robot);

/// Difference between a robot and the one that experience was learned with, in increasing order.
enum class RobotDifference {
  none,
  shapes,  ///< collision model differs: spheres, fingers, tools, checked pairs; experience applies
  limits,  ///< joint limits differ; experience applies after adopt_database()
  frames,  ///< joints, their order or frames differ: another arm
};
/// Compares two signatures. Returns `frames` if an older database stores no kinematics hash and its
/// model hash differs.
[[nodiscard]] RobotDifference compare_robots(const RobotSignature& learned_with,
                                             const RobotSignature& robot);

/// A stored experience with a key near the queried one.
struct KeyMatch {
  std::shared_ptr<const Experience> experience;  ///< never null
  double similarity_error = 0;                   ///< squared distance of the keys, unit of the keys
                                                 ///< squared
  std::size_t image = 0;                         ///< index of the queried image with the nearest
                                                 ///< key
};

/// The rows of one kind of memory.
struct KindInfo {
  std::string kind;
  int key_size = 0;  ///< numbers in a key
  std::int64_t samplers = 0;
  std::int64_t components = 0;
};

struct DatabaseInfo {
  std::string url;  ///< without the password
  RobotSignature signature;
  std::vector<KindInfo> kinds;  ///< in order of name
  std::int64_t samplers = 0;
  std::int64_t components = 0;
  std::int64_t bytes = 0;        ///< size of the file and its write-ahead log, or of the server's
                                 ///< tables
  int schema_version = 0;        ///< 0 if the database is empty
  std::int64_t generation = 0;   ///< number of changes so far
  std::int64_t tombstones = 0;   ///< rows set aside (searches skip them): damaged, or superseded in
                                 ///< a merge
  std::string record_flaw = {};  ///< why losses of the last rows of a file would not be found: its
                                 ///< FILE.tally is damaged, of another database, or read-only;
                                 ///< empty for a sound one, and where there is none
};

/// Settings of an open database.
struct DatabaseSettings {
  /// Memory for rows, bytes, without their keys; at least 0. A smaller database is read and checked
  /// as a whole when it is opened. A larger database is opened with its keys only. Each row is read
  /// when it first matches, and the least recently used rows are dropped from memory.
  std::int64_t memory_bytes = std::int64_t{256} << 20;
  /// Seconds that a call waits for a server that does not answer; more than 0. Work that takes a
  /// server long, such as migration, may take longer.
  double answer_timeout_s = 10;
};

/// Rows of Database::insert_later().
struct QueuedRows {
  std::int64_t waiting = 0;  ///< not stored yet; rows that are still to be made count as one
  std::int64_t stored = 0;   ///< new rows that survive a killed process and a loss of power
  std::int64_t lost = 0;     ///< dropped: not made, refused, or too many were waiting
  std::string failure = {};  ///< error of the last attempt; empty once all its rows are stored
};

/// An append-only set of experience in one SQLite file or on a PostgreSQL server
/// (docs/design/database.md). A URL is the path of a file or `postgresql://...` for libpq. While a
/// database is open, all keys are in RAM, and rows up to DatabaseSettings::memory_bytes.
/// Thread-safe; find() does not wait for insert() and refresh(). Other processes may insert at the
/// same time; refresh(), insert() and opening make their rows visible.
class Database {
 public:
  /// Opens `url`. `create` turns a missing or empty file, or a server without mneme's tables, into
  /// an empty database of the robot. A file whose creation was interrupted counts as empty. Errors:
  /// wrong_robot; corrupt for a file that is damaged or no database; unsupported for a database of
  /// a newer or older mneme, and for an engine that is not built in; io.
  [[nodiscard]] static Result<Database> open(const std::string& url,
                                             const RobotSignature& signature, OpenMode mode,
                                             const DatabaseSettings& settings = {});
  /// Opens a database of any robot for reading.
  [[nodiscard]] static Result<Database> inspect(const std::string& url,
                                                const DatabaseSettings& settings = {});

  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;
  ~Database();

  [[nodiscard]] const RobotSignature& signature() const;
  [[nodiscard]] DatabaseInfo info() const;
  /// The kinds of rows in the database, in order of name.
  [[nodiscard]] std::vector<KindInfo> kinds() const;
  [[nodiscard]] std::int64_t size() const;
  /// Returns a row by position, 0 to size() - 1. Rows are ordered by kind, as in kinds(), then by
  /// constraints, then by insertion. Errors: invalid; those of find().
  [[nodiscard]] Result<Experience> get(std::int64_t position) const;
  /// Visits all rows in the order of positions. Errors: those of find().
  [[nodiscard]] Result<void> for_each(
      const std::function<void(const std::shared_ptr<const Experience>&)>& visit) const;

  /// Returns the rows of `kind` with a squared key distance below `threshold` to the nearest of
  /// `images`: nearest first, ties by id, each row once, at most `max_matches` (0: all). `images`
  /// are equivalent forms of one key; keys of another length match nothing. Finds only paths stored
  /// under `constraints`, the hash of the query's; samplers are stored under 0. `keys_left`, if not
  /// null, limits the keys inspected and is reduced by their number, in steps of up to 64; at 0 the
  /// search ends with the matches found so far. Errors: corrupt, naming a damaged row; io. Cost:
  /// two levels of bounding-box pruning, then a scan of the remaining leaves.
  [[nodiscard]] Result<std::vector<KeyMatch>> find(std::string_view kind,
                                                   std::span<const std::vector<double>> images,
                                                   double threshold, int max_matches,
                                                   std::int64_t* keys_left = nullptr,
                                                   std::uint64_t constraints = 0) const;

  /// Appends rows in one transaction. After success they survive a killed process and a loss of
  /// power. A row whose kind, key and content are already stored is not added again, so a failed
  /// insertion can be repeated. The first row of a kind sets its key length. Returns the ids.
  /// Writes for each row whether it was added into `is_new`, unless that is null. Errors: io (disk
  /// full, read-only, locked, connection lost); invalid (wrong sizes, not finite, a key number
  /// beyond 1e6, text that is not UTF-8). After an error nothing was inserted, unless the
  /// connection was lost during the commit.
  Result<std::vector<std::int64_t>> insert(std::vector<Experience> rows,
                                           std::vector<bool>* is_new = nullptr);

  /// Returns the hashes of the lessons (units of learning, Provenance::lesson) that need not be
  /// learned again: all their rows are in the database and usable. Errors: io, corrupt. Cost: reads
  /// one record per row of a lesson.
  [[nodiscard]] Result<std::unordered_set<std::uint64_t>> finished_lessons() const;

  /// Queues rows for a thread that inserts them, many in one transaction. find() returns them once
  /// they are stored. While a server or disk fails, the rows wait and are tried again. A killed
  /// process loses rows that still wait. Cost: some microseconds. Errors: io if the database is
  /// open for reading only; invalid, as in insert(). Then no row was queued.
  Result<void> insert_later(std::vector<Experience> rows);
  /// Makes rows; ends early, with an error, once `stop` is true.
  using MakeRows = std::function<Result<std::vector<Experience>>(const std::atomic<bool>& stop)>;
  /// Queues a function that makes rows. It runs on the thread that inserts them. Error: io as
  /// above; rows that are refused later count as lost.
  Result<void> insert_later(MakeRows make);
  /// Waits until all queued rows are stored or dropped, for at most `timeout_s` seconds. Error: io
  /// if rows still wait then; the message says how many.
  Result<void> flush(double timeout_s = 1e6);
  [[nodiscard]] QueuedRows queued_rows() const;
  /// Ends calls that wait for a server, or for another process that locks the file, within 20 ms,
  /// and lets all later calls that must wait fail. Without
  /// stop_waiting(), the destructor waits up to 30 s for queued rows.
  void stop_waiting();

  /// Rate limit on insertion: adds `iterations` to a count of this process. Returns true, and
  /// resets the count, once it reaches `price`. A caller that inserts one row per true result
  /// inserts at most K / price rows in K iterations.
  [[nodiscard]] bool earns_row(std::uint64_t iterations, std::uint64_t price);

  /// Books what a query spent on a kind of memory and what the kind saved it, in checked states.
  /// The account belongs to this object and is not stored.
  void book(std::string_view kind, std::uint64_t spent, std::uint64_t saved);
  /// Returns how far `kind` has paid: 1 while it has saved what it spent beyond a credit, otherwise
  /// less, down to 0.05.
  [[nodiscard]] double trust(std::string_view kind) const;
  /// True if `kind` has saved more than it spent.
  [[nodiscard]] bool pays(std::string_view kind) const;

  /// Reads rows that other processes added, and drops rows that they set aside. Results of find()
  /// stay valid. Returns the number of new rows. Cost: one small query if nothing changed. Errors:
  /// io, corrupt; then nothing changed in memory.
  Result<std::int64_t> refresh();

 private:
  struct State;
  explicit Database(std::unique_ptr<State> state);
  using Opener = std::function<Result<internal::OpenedStore>(const internal::OpenOptions&)>;
  static Result<Database> load(const Opener& open_with, const std::string& url, OpenMode mode,
                               const DatabaseSettings& settings);
  std::unique_ptr<State> state_;
};

/// Fails with wrong_robot if the database has experience of another robot: if compare_robots()
/// finds more than other shapes. A database without rows fits every robot.
[[nodiscard]] Result<void> check_robot(const Robot& robot, const Database& database);

}  // namespace mneme
