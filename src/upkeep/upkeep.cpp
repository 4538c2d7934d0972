// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/upkeep.h"

#include "store/new_file.h"
#include "store/open_store.h"
#include "store/row_check.h"
#include "store/store_reads.h"
#include "store/store_writes.h"
#include "upkeep/salvage.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme {
namespace {

using internal::Store;

/// Damage, and how deep it goes.
struct Findings {
  std::vector<Damage> damages;
  bool is_structural = false;  ///< not only rows are damaged
};

/// Takes what says that the database is damaged as a finding; anything else ends the verification.
Result<void> note(const Error& error, Findings& findings) {
  if (error.code != ErrorCode::corrupt) return tl::unexpected(error);
  findings.damages.push_back({0, error.message, false});
  return {};
}

Result<void> verify_structure(Store& store, Findings& findings) {
  const auto checked = store.check_structure(findings.damages);
  findings.is_structural = !checked || !findings.damages.empty();
  return checked ? Result<void>() : note(checked.error(), findings);
}

Result<void> verify_rows(Store& store, const ExperienceSpace& space, Findings& findings) {
  internal::KeySizes sizes;
  const auto read =
      internal::read_changes(store, {}, internal::RowParts::all, [&](const auto& row) {
        Experience experience;
        auto flaw = internal::decode(row, space, experience);
        if (!flaw) flaw = sizes.check(experience.kind, experience.key.size());
        if (flaw) findings.damages.push_back({row.id, *flaw, false});
        return Result<void>();
      });
  return read ? Result<void>() : note(read.error(), findings);
}

Result<void> verify_orphans(Store& store, Findings& findings) {
  const auto transaction = store.begin(Store::Kind::read);
  if (!transaction) return note(transaction.error(), findings);
  const auto orphans = (*transaction)->find_orphans();
  if (!orphans) return note(orphans.error(), findings);
  for (const std::int64_t id : *orphans) {
    findings.damages.push_back({id, "its key is missing", false});
  }
  return {};
}

/// A tombstone that changed could revive a row or hide one.
Result<void> verify_tombstones(Store& store, Findings& findings) {
  const auto transaction = store.begin(Store::Kind::read);
  if (!transaction) return note(transaction.error(), findings);
  const auto read = (*transaction)->read_tombstones(0, [&](const internal::Tombstone& tombstone) {
    if (internal::checksum_of(tombstone) != tombstone.checksum) {
      findings.damages.push_back({0, fmt::format("tombstone {} is damaged", tombstone.id), false});
      findings.is_structural = true;
    }
    return Result<void>();
  });
  return read ? Result<void>() : note(read.error(), findings);
}

Result<Findings> verify(const std::string& url) {
  Findings findings;
  const auto opened = internal::inspect_store(url);
  if (!opened) {
    findings.is_structural = true;
    return note(opened.error(), findings).map([&] { return findings; });
  }
  if (opened->schema_version == 0) return findings;
  Store& store = *opened->store;
  return verify_structure(store, findings)
      .and_then([&] { return verify_rows(store, opened->space, findings); })
      .and_then([&] { return verify_orphans(store, findings); })
      .and_then([&] { return verify_tombstones(store, findings); })
      .map([&] { return findings; });
}

/// Replaces a store whose structure is damaged, or which cannot even be opened, by a sound one of
/// its live rows, as salvage_file() says. Errors: those, and unsupported on a server.
Result<void> rebuild_store(const std::string& url, std::vector<Damage>& damages) {
  const auto engine = internal::engine_of(url);
  if (!engine) return tl::unexpected(engine.error());
  if (*engine != internal::Engine::sqlite) {
    return fail(ErrorCode::unsupported,
                fmt::format("{}: what stands beneath the rows can only be repaired on the server",
                            internal::without_password(url)));
  }
  // Two at a time would take each other's unfinished copies away.
  const auto alone = internal::NewFile::create(url + ".salvage");
  if (!alone) {
    return fail(alone.error().code,
                fmt::format("{}: cannot be built anew: {}", url, alone.error().message));
  }
  // Whoever was here before may have cured it.
  if (const auto again = verify(url); again && again->damages.empty()) return {};
  return internal::salvage_file(url, damages).map([](const std::string&) {});
}

/// Leaves a store that can be used. Names in `findings` also what was found only by then.
Result<void> cure(const std::string& url, Findings& findings) {
  const auto opened = internal::inspect_store(url);
  if (!opened && opened.error().code != ErrorCode::corrupt) return tl::unexpected(opened.error());
  if (!opened || findings.is_structural) {
    return rebuild_store(url, findings.damages);
  }
  const auto store = internal::open_store(url, OpenMode::read_write);
  if (!store) return tl::unexpected(store.error());
  std::vector<internal::Burial> burials;
  for (const Damage& damage : findings.damages) {
    if (damage.id != 0) burials.push_back({damage.id, "damaged: " + damage.what});
  }
  return internal::quarantine_rows(**store, burials);
}

}  // namespace

Result<std::vector<Damage>> verify_database(const std::string& url, VerifyMode mode) {
  auto found = verify(url);
  if (!found) return tl::unexpected(found.error());
  if (found->damages.empty() || mode == VerifyMode::report) return found->damages;
  const auto cured = cure(url, *found);
  if (!cured) {
    found->damages.push_back({0, "nothing was set aside: " + cured.error().message, false});
    return found->damages;
  }
  const auto again = verify(url);
  if (!again) return tl::unexpected(again.error());
  for (Damage& damage : found->damages) damage.is_quarantined = again->damages.empty();
  return found->damages;
}

Result<MergeSummary> merge_databases(const std::string& into, const std::string& from) {
  const auto source = internal::inspect_store(from);
  if (!source) return tl::unexpected(internal::with_advice(source.error(), from));
  MergeSummary summary;
  if (source->schema_version == 0) return summary;
  const auto list = internal::list_by_content(*source->store);
  if (!list) return tl::unexpected(internal::with_advice(list.error(), from));
  // All of it, before anything is made or changed: what is damaged adds nothing.
  const auto sound = internal::visit_rows(*source->store, source->space, *list,
                                          [](auto) { return Result<void>(); });
  if (!sound) return tl::unexpected(internal::with_advice(sound.error(), from));
  const auto target = internal::open_store_of(into, source->space, OpenMode::create);
  if (!target) return tl::unexpected(internal::with_advice(target.error(), into));
  const auto merged = internal::visit_rows(*source->store, source->space, *list, [&](auto rows) {
    return internal::merge_rows(*target->store, rows, summary);
  });
  if (!merged) return tl::unexpected(internal::with_advice(merged.error(), from));
  return summary;
}

namespace {

Result<void> check_adoption(const std::string& url, const ExperienceSpace& found,
                            const ExperienceSpace& wanted, bool is_forced) {
  if (internal::is_same_space(found, wanted) || internal::has_same_frames(found, wanted)) return {};
  const bool is_unsaid = internal::kinematics_of(found).empty();
  const bool can_fit = is_unsaid && found.joint_count == wanted.joint_count;
  if (can_fit && is_forced) return {};
  auto refused = internal::refuse_space(url, found, wanted);
  if (can_fit) {
    refused.value().message +=
        "; an older mneme made it, which did not note the joints' frames: --force if they are the "
        "same";
  }
  return refused;
}

}  // namespace

Result<ExperienceSpace> adopt_database(const std::string& url, const ExperienceSpace& space,
                                       bool is_forced) {
  const auto found = internal::inspect_store(url);
  if (!found) return tl::unexpected(internal::with_advice(found.error(), url));
  if (found->schema_version == 0) {
    return fail(ErrorCode::invalid,
                fmt::format("{}: there is no experience in it", internal::without_password(url)));
  }
  const auto checked = check_adoption(found->store->name(), found->space, space, is_forced);
  if (!checked) return tl::unexpected(checked.error());
  return internal::open_store(url, OpenMode::read_write)
      .and_then([&](const std::unique_ptr<Store>& store) { return store->set_space(space); })
      .map([&] { return found->space; });
}

Result<CompactSummary> compact_database(const std::string& url) {
  const auto opened = internal::inspect_store(url);
  if (!opened) return tl::unexpected(internal::with_advice(opened.error(), url));
  CompactSummary summary;
  if (opened->schema_version == 0) return summary;
  const auto store = internal::open_store(url, OpenMode::read_write);
  if (!store) return tl::unexpected(internal::with_advice(store.error(), url));
  const auto bytes = [&] { return (*store)->bytes().value_or(0); };
  summary.bytes_before = bytes();
  // Nothing is removed while something is wrong.
  const auto list = internal::list_by_content(**store);
  if (!list) return tl::unexpected(internal::with_advice(list.error(), url));
  const auto removed = internal::compact_store(**store);
  if (!removed) return tl::unexpected(internal::with_advice(removed.error(), url));
  summary.removed = *removed;
  summary.bytes_after = bytes();
  return summary;
}

}  // namespace mneme
