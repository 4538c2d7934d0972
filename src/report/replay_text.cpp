// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/report.h"

#include <fmt/format.h>

#include <algorithm>

namespace mneme {
namespace {

/// "0.031 rad away, is blocked at 62 %: link 'wrist' touches obstacle 'box_3'"
std::string describe(const BlockedPath& path, const Contact& contact) {
  std::string why = "nearer to contact than the margin";
  if (!contact.link.empty()) {
    why = fmt::format("link '{}' touches {} '{}'", contact.link,
                      contact.is_self ? "link" : "obstacle", contact.other);
  }
  return fmt::format("{:.3f} rad away, is blocked at {:.0f} %: {}", path.distance,
                     100 * path.fraction, why);
}

}  // namespace

std::vector<Contact> find_what_blocks(const Problem& problem, const Replay& replay) {
  std::vector<Contact> found(replay.blocked.size());
  const auto checker = CollisionChecker::make(problem.robot, problem.scene);
  if (!checker) return found;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::vector<Contact> contacts = checker->contacts(replay.blocked[i].state);
    const auto deepest = std::ranges::min_element(contacts, {}, &Contact::distance);
    if (deepest != contacts.end()) found[i] = *deepest;
  }
  return found;
}

std::string describe_replay(const Problem& problem, const Replay& replay) {
  if (replay.time_s == 0) return {};
  if (replay.is_hit() && !replay.is_repaired) {
    return fmt::format("replayed row {}, {:.3f} rad away", replay.row, replay.distance);
  }
  if (replay.blocked.empty()) {
    if (replay.cheap_row) {
      return fmt::format("not replayed: planning row {} took less than its check would",
                         *replay.cheap_row);
    }
    if (!replay.nearest) return "not replayed: no task is known";
    return fmt::format("not replayed: the nearest known task is {:.3f} rad away", *replay.nearest);
  }
  const std::vector<Contact> contacts = find_what_blocks(problem, replay);
  const auto repaired = std::ranges::find(replay.blocked, replay.row, &BlockedPath::row);
  const bool is_hit = repaired != replay.blocked.end();
  const std::size_t i = is_hit ? static_cast<std::size_t>(repaired - replay.blocked.begin()) : 0;
  return fmt::format("{} row {}, {}", is_hit ? "repaired" : "not replayed:", replay.blocked[i].row,
                     describe(replay.blocked[i], contacts[i]));
}

}  // namespace mneme
