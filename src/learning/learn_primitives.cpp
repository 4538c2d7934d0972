// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "store/store.h"
#include "learning/run.h"

#include <cstring>
#include <set>
#include <utility>

namespace mneme {
namespace {

struct Lesson {
  PrimitiveKey key;
  std::uint64_t seed = 0;    ///< depends on the job's seed and the key
  std::uint64_t number = 0;  ///< depends on the settings, too: Provenance::lesson
};

/// Depends on the primitive, not on its position in a list.
std::uint64_t lesson_seed(std::uint64_t job_seed, const PrimitiveKey& key) {
  std::uint64_t seed = job_seed;
  for (const double value : key) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    seed = derive_seed(seed, bits);
  }
  return seed;
}

/// The lessons of a job, without repeated primitives. Refers to its arguments.
class Lessons {
 public:
  Lessons(const Robot& robot, const LearnJob& job)
      : robot_(robot), job_(job), settings_text_(describe(job.settings)) {}

  void add(const PrimitiveKey& key) {
    ++requested_;
    const std::uint64_t seed = lesson_seed(job_.seed, key);
    const auto number = static_cast<std::uint64_t>(
        internal::ColumnDigest().add(settings_text_).add(static_cast<std::int64_t>(seed)).value());
    if (seeds_.insert(seed).second) lessons_.push_back({key, seed, number});
  }

  Result<LearnSummary> run(Database& database) const {
    const std::int64_t generation = database.info().generation;
    std::vector<std::size_t> open = MNEME_TRY(open_tasks(database));
    const internal::Tasks tasks = {std::move(open), requested_,
                                   [this](std::size_t task) { return learn(lessons_[task]); }};
    if (!job_.shared) return internal::run_local(database, tasks, job_);
    return internal::run_shared(database, tasks, *job_.shared, job_number(), generation, job_);
  }

 private:
  /// Lessons that were not learned with these settings yet.
  Result<std::vector<std::size_t>> open_tasks(const Database& database) const {
    const auto finished = MNEME_TRY(database.finished_lessons());
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < lessons_.size(); ++i) {
      if (!finished.contains(lessons_[i].number)) open.push_back(i);
    }
    return open;
  }

  Result<internal::Learned> learn(const Lesson& lesson) const {
    const MemoryKind& kind = *memory_kinds().front();
    LearnResult result =
        MNEME_TRY(kind.learn(robot_, lesson.key, job_.settings, lesson.seed, 0, job_.cancel));
    Experience row;
    row.kind = kind.version;
    row.key = lesson.key;
    row.content = std::move(result.sampler);
    row.provenance = {
        "mneme " + std::string(version()), settings_text_, lesson.seed, {}, lesson.number};
    return internal::Learned{{std::move(row)}, {}};
  }

  /// The same for all processes with the same settings, seed and primitives.
  [[nodiscard]] std::int64_t job_number() const {
    std::vector<std::int64_t> numbers = {
        internal::hash_bytes(std::as_bytes(std::span(settings_text_)))};
    for (const Lesson& lesson : lessons_) numbers.push_back(static_cast<std::int64_t>(lesson.seed));
    return internal::hash_numbers(numbers);
  }

  const Robot& robot_;
  const LearnJob& job_;
  std::string settings_text_;
  std::vector<Lesson> lessons_;
  std::set<std::uint64_t> seeds_;
  std::int64_t requested_ = 0;
};

}  // namespace

Result<LearnSummary> learn_primitives(const Robot& robot, std::span<const PrimitiveKey> keys,
                                      Database& database, const LearnJob& job) {
  MNEME_TRY(check_robot(robot, database));
  Lessons lessons(robot, job);
  for (const PrimitiveKey& key : keys) lessons.add(key);
  return lessons.run(database);
}

}  // namespace mneme
