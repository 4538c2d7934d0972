// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "base/fail.h"
#include "engines/open_store.h"
#include "store/lost_rows.h"
#include "store/row_check.h"
#include "store/store.h"
#include "upkeep/store_upkeep.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

namespace mneme {
namespace {

using internal::Store;

/// Damage found by a verification.
struct Findings {
  std::vector<Damage> damages;
  std::vector<std::int64_t> tombstones;  ///< ids of damaged ones
  bool is_structural = false;            ///< the file itself is damaged
};

/// Records a corrupt error as damage; other errors end the verification.
Result<void> note(const Result<void>& done, Findings& findings) {
  if (done || done.error().code != ErrorCode::corrupt) return done;
  findings.damages.push_back({0, done.error().message, false});
  return {};
}

Result<void> verify_structure(Store& store, Findings& findings) {
  const std::size_t before = findings.damages.size();
  const auto checked = store.check_structure(findings.damages);
  findings.is_structural = !checked || findings.damages.size() > before;
  return note(checked, findings);
}

Result<void> verify_rows(Store& store, const RobotSignature& signature, Findings& findings) {
  internal::KeySizes sizes;
  const auto read =
      internal::read_changes(store, {}, internal::RowParts::all, [&](const auto& row) {
        Experience experience;
        auto flaw = internal::decode(row, signature, experience);
        if (!flaw) flaw = sizes.check(experience.kind, experience.key.size());
        if (flaw) findings.damages.push_back({row.id, *flaw, false});
        return Result<void>();
      });
  return read.map([](const internal::StoreChanges&) {});
}

Result<void> verify_orphans(Store& store, Findings& findings) {
  const auto transaction = MNEME_TRY(store.begin(Store::Kind::read));
  const auto orphans = MNEME_TRY(transaction->find_orphans());
  for (const std::int64_t id : orphans) {
    findings.damages.push_back({id, "its key is missing", false});
  }
  return {};
}

/// A changed tombstone could revive a row or hide one.
Result<void> verify_tombstones(Store& store, Findings& findings) {
  const auto transaction = MNEME_TRY(store.begin(Store::Kind::read));
  return transaction->read_tombstones(0, [&](const internal::Tombstone& tombstone) {
    if (internal::checksum_of(tombstone) != tombstone.checksum) {
      findings.damages.push_back({0, fmt::format("tombstone {} is damaged", tombstone.id), false});
      findings.tombstones.push_back(tombstone.id);
    }
    return Result<void>();
  });
}

Result<Findings> verify(const std::string& url) {
  Findings findings;
  const auto opened = internal::inspect_store(url, {internal::LossCheck::note});
  if (!opened) {
    findings.is_structural = true;
    MNEME_TRY(note(tl::unexpected(opened.error()), findings));
    return findings;
  }
  Store& store = *opened->store;
  if (store.loss()) findings.damages.push_back({0, *store.loss(), false});
  if (opened->schema_version == 0) {
    findings.is_structural = store.loss().has_value();
    return findings;
  }
  MNEME_TRY(verify_structure(store, findings));
  MNEME_TRY(note(verify_rows(store, opened->signature, findings), findings));
  MNEME_TRY(note(verify_orphans(store, findings), findings));
  MNEME_TRY(note(verify_tombstones(store, findings), findings));
  return findings;
}

/// Sets damaged rows aside and deletes damaged tombstones, whose rows are verified again.
Result<void> quarantine(const std::string& url, const Findings& findings) {
  const auto store =
      MNEME_TRY(internal::open_store(url, OpenMode::read_write, {internal::LossCheck::note}));
  return internal::quarantine_rows(*store, findings.damages, findings.tombstones);
}

/// Advice for a database whose file is damaged.
std::string advice_for(const std::string& url) {
  if (internal::engine_of(url) != internal::Engine::sqlite) {
    return "the server's files are damaged; repair them on the server";
  }
  // SQLite would delete the log beside a missing or empty file.
  std::error_code missing;
  const auto size = std::filesystem::file_size(url, missing);
  if (missing || size == 0) return "the file itself has no content; restore it from a copy";
  return "the file itself is damaged; to save what can be read: " + internal::saving_command(url);
}

}  // namespace

Result<std::vector<Damage>> verify_database(const std::string& url, VerifyMode mode) {
  Findings found = MNEME_TRY(verify(url));
  if (found.damages.empty()) return found.damages;
  if (found.is_structural) {
    found.damages.push_back({0, "nothing was set aside: " + advice_for(url), false});
    return found.damages;
  }
  if (mode == VerifyMode::report) return found.damages;
  // The first pass revives the rows of damaged tombstones; the second verifies them.
  Findings left = found;
  for (int pass = 0; pass < 2 && !left.damages.empty(); ++pass) {
    if (const auto done = quarantine(url, left); !done) {
      found.damages.push_back({0, "nothing was set aside: " + done.error().message, false});
      return found.damages;
    }
    left = MNEME_TRY(verify(url));
    if (pass == 0)
      found.damages.insert(found.damages.end(), left.damages.begin(), left.damages.end());
  }
  for (Damage& damage : found.damages) damage.is_quarantined = left.damages.empty();
  return found.damages;
}

std::optional<std::string> describe_record_flaw(const std::string& url) {
  std::error_code error;
  const bool is_file = internal::engine_of(url) == internal::Engine::sqlite &&
                       std::filesystem::is_regular_file(url, error);
  if (!is_file || std::filesystem::file_size(url, error) == 0) return std::nullopt;
  const std::string record = internal::record_path(url);
  std::string flaw;
  if (!std::filesystem::exists(record, error) && !internal::read_record(url)) {
    flaw = fmt::format(
        "there is no {}, as beside a copy: whether the last rows of the file were lost is not "
        "known",
        record);
  } else if (const auto opened = internal::inspect_store(url)) {
    flaw = opened->store->record_flaw();
  }
  if (flaw.empty()) return std::nullopt;
  return fmt::format("{}: {}. The next insertion writes it", url, flaw);
}

Result<MergeSummary> merge_databases(const std::string& into, const std::string& from) {
  const auto source = MNEME_TRY(internal::advised(internal::inspect_store(from), from));
  MergeSummary summary;
  if (source.schema_version == 0) return summary;
  const auto list = MNEME_TRY(internal::advised(internal::list_by_content(*source.store), from));
  const auto visit_all = [&](const internal::RowsVisitor& visit) {
    return internal::advised(internal::visit_rows(*source.store, source.signature, list, visit),
                             from);
  };
  // Read everything before changing anything: a damaged source must not be merged in part.
  MNEME_TRY(visit_all([](auto) { return Result<void>(); }));
  const auto target = MNEME_TRY(
      internal::advised(internal::open_store_of(into, source.signature, OpenMode::create), into));
  MNEME_TRY(
      visit_all([&](auto rows) { return internal::merge_rows(*target.store, rows, summary); }));
  MNEME_TRY(internal::merge_lessons(*target.store, *source.store));
  return summary;
}

namespace {

Result<void> check_adoption(const std::string& url, const RobotSignature& found,
                            const RobotSignature& wanted, bool is_forced) {
  if (internal::is_same_robot(found, wanted) || internal::has_same_frames(found, wanted)) return {};
  const bool has_no_kinematics = found.kinematics_hash.empty();
  const bool can_fit = has_no_kinematics && found.joint_count == wanted.joint_count;
  if (can_fit && is_forced) return {};
  auto refused = internal::refuse_robot(url, found, wanted);
  if (can_fit) {
    refused.value().message +=
        "; an older mneme stored no joint frames; if the frames are equal, use --force";
  }
  return refused;
}

}  // namespace

Result<RobotSignature> adopt_database(const std::string& url, const RobotSignature& signature,
                                      bool is_forced) {
  const auto found = MNEME_TRY(internal::advised(internal::inspect_store(url), url));
  if (found.schema_version == 0) {
    return fail(ErrorCode::invalid, "{}: the database is empty", internal::without_password(url));
  }
  MNEME_TRY(check_adoption(found.store->name(), found.signature, signature, is_forced));
  const auto store = MNEME_TRY(internal::open_store(url, OpenMode::read_write));
  MNEME_TRY(store->set_signature(signature));
  return found.signature;
}

Result<CompactSummary> compact_database(const std::string& url) {
  const auto opened = MNEME_TRY(internal::advised(internal::inspect_store(url), url));
  CompactSummary summary;
  if (opened.schema_version == 0) return summary;
  const auto store =
      MNEME_TRY(internal::advised(internal::open_store(url, OpenMode::read_write), url));
  summary.bytes_before = store->bytes().value_or(0);
  // Nothing is removed while something is wrong.
  MNEME_TRY(internal::advised(internal::list_by_content(*store), url));
  summary.removed = MNEME_TRY(internal::advised(internal::compact_store(*store), url));
  summary.bytes_after = store->bytes().value_or(0);
  return summary;
}

}  // namespace mneme
