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
#include <string_view>
#include <vector>

#include "mneme/base.h"
#include "mneme/robot.h"
#include "mneme/sampling.h"

namespace mneme {
namespace internal {
struct OpenedStore;
}

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
  std::string kind;     ///< what the key means, such as "pairs/1": 1 to 64 bytes of UTF-8 without
                        ///< control characters
  std::vector<double> key;  ///< as many numbers as the other keys of its kind
  LocalSampler sampler;
  Provenance provenance;
};

/// What decides whether experience applies at all.
struct ExperienceSpace {
  std::string robot_name;  ///< for messages only
  std::string robot_hash;  ///< Robot::hash()
  int joint_count = 0;
};
[[nodiscard]] ExperienceSpace make_space(const Robot& robot);

/// A stored experience whose key is near one that was asked for.
struct KeyMatch {
  std::shared_ptr<const Experience> experience;  ///< never null
  double similarity_error = 0;                   ///< squared distance of the keys
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
  ExperienceSpace space;
  std::vector<KindInfo> kinds;  ///< in order of name
  std::int64_t samplers = 0;
  std::int64_t components = 0;
  std::int64_t bytes = 0;       ///< of the file and its write-ahead log, or of the server's tables
  int schema_version = 0;       ///< 0 if there is nothing in it yet
  std::int64_t generation = 0;  ///< changes so far
  std::int64_t tombstones = 0;  ///< rows set aside: damaged, or superseded in a merge
};

/// One damaged row, or damage to the database itself (id 0).
struct Damage {
  std::int64_t id = 0;
  std::string what;
  bool is_quarantined = false;  ///< it is set aside, and the rest can be used
};

enum class OpenMode { read_only, read_write, create };

/// How a database is kept open.
struct DatabaseSettings {
  /// Bytes of rows in memory, without their keys; at least 0. A database whose file (or tables on a
  /// server) is larger reads only the keys when it is opened, and a row when it first matches;
  /// those that were not asked for the longest time are dropped again. A smaller one is in memory
  /// as a whole, and all of it is checked when it is opened.
  std::int64_t memory_bytes = std::int64_t{256} << 20;
};

/// An append-only set of experience in one SQLite file or on a PostgreSQL server
/// (docs/database.md). A URL is the path of a file or `postgresql://...`, as libpq reads it. All
/// keys are in memory while it is open, and rows as far as the settings allow. Const is
/// parallel-safe; insert() and refresh() may run in parallel with all of it and with themselves,
/// and find() does not wait for them. Another process may insert at the same time; its rows are
/// seen after the next refresh(), insert() or opening.
class Database {
 public:
  /// Opens `url`. With `create`, a missing or empty file, or a server without our tables, becomes
  /// an empty database of `space`; a file that was being created when its process was killed counts
  /// as empty. An empty file that is only read is an empty database too. Errors: wrong_robot if the
  /// database is not of `space`; corrupt if it is no database, or damaged; unsupported if a newer
  /// or an older mneme wrote it, or if this mneme was built without the engine; io.
  [[nodiscard]] static Result<Database> open(const std::string& url, const ExperienceSpace& space,
                                             OpenMode mode, const DatabaseSettings& settings = {});
  /// Opens for reading whatever space it is of, to look at it.
  [[nodiscard]] static Result<Database> inspect(const std::string& url,
                                                const DatabaseSettings& settings = {});

  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;
  ~Database();

  [[nodiscard]] const ExperienceSpace& space() const;
  [[nodiscard]] DatabaseInfo info() const;
  /// The kinds of rows that are there, in order of name.
  [[nodiscard]] std::vector<KindInfo> kinds() const;
  [[nodiscard]] std::int64_t size() const;
  /// Experience by position, 0 to size() - 1: kind by kind as in kinds(), each in order of
  /// insertion. Errors: invalid; as of find().
  [[nodiscard]] Result<Experience> get(std::int64_t position) const;
  /// Visits all experience in the order of positions. Errors: as of find().
  [[nodiscard]] Result<void> for_each(
      const std::function<void(const std::shared_ptr<const Experience>&)>& visit) const;

  /// The experiences of `kind` whose key's squared distance to the nearest of `images` is less than
  /// `threshold`, nearest first, at most `max_matches` (0: all). Ties are broken by id; each row
  /// comes once. `images` are the ways to write down one key; of another length than the kind's
  /// keys they match nothing. O(log size) for few matches. Errors, of rows that are not in memory:
  /// corrupt, naming a damaged one; io.
  [[nodiscard]] Result<std::vector<KeyMatch>> find(std::string_view kind,
                                                   std::span<const std::vector<double>> images,
                                                   double threshold, int max_matches) const;

  /// Appends rows in one transaction. Once it returns without an error they survive a killed
  /// process and a loss of power. A row whose kind, key, mixture, settings and seed are those of a
  /// row that is there already is not added again, so that a failed insertion can be repeated
  /// safely. The first row of a kind decides how long its keys are. Returns the ids. Errors: io
  /// (disk full, read-only, locked, connection lost), invalid (wrong sizes, not finite, a number of
  /// a key beyond 1e6, text that is not UTF-8); then nothing was inserted, unless the connection
  /// was lost during the very last step.
  Result<std::vector<std::int64_t>> insert(std::vector<Experience> rows);

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

enum class VerifyMode {
  report,      ///< changes nothing
  quarantine,  ///< sets damaged rows aside, so that the rest can be used
};
/// Checks the structure and every row's checksums. Empty if all is well. In quarantine, a file
/// whose pages do not fit together is replaced by one of its sound rows, after a copy. What could
/// not be cured says so by `is_quarantined`. Errors: io; unsupported if a newer or an older mneme
/// wrote it.
[[nodiscard]] Result<std::vector<Damage>> verify_database(const std::string& url,
                                                          VerifyMode mode = VerifyMode::report);

struct MergeSummary {
  std::int64_t read = 0;      ///< rows of the source
  std::int64_t added = 0;     ///< that the target did not have
  std::int64_t replaced = 0;  ///< that the target had, learned later; the earlier provenance stays
};
/// Adds the rows of `from` to `into`, which is created if it is missing: a union of sets, in which
/// rows are the same if their kinds, keys, mixtures, settings and seeds are. Idempotent, and what
/// results does not depend on the order of merging. In transactions of some hundred rows: repeat it
/// if it was interrupted. Errors: wrong_robot if the two are not of one space; those of
/// Database::open().
[[nodiscard]] Result<MergeSummary> merge_databases(const std::string& into,
                                                   const std::string& from);

/// Writes all rows to a file in an order that depends on their content alone, so that equal sets
/// give equal bytes: JSON lines (`.jsonl`), or NumPy arrays (`.npz`). Returns their number.
/// docs/database.md describes both. Errors: invalid if the name ends otherwise; io.
[[nodiscard]] Result<std::int64_t> export_database(const std::string& url, const std::string& path);
/// Adds the rows of a file that export_database() or another program wrote, as merge_databases()
/// does. Errors: parse, naming line or array; wrong_robot; those of Database::open().
[[nodiscard]] Result<MergeSummary> import_database(const std::string& url, const std::string& path);

struct CompactSummary {
  std::int64_t removed = 0;  ///< rows that were set aside
  std::int64_t bytes_before = 0;
  std::int64_t bytes_after = 0;
};
/// Removes rows that were set aside, and gives the space back. Other processes may go on.
[[nodiscard]] Result<CompactSummary> compact_database(const std::string& url);

}  // namespace mneme
