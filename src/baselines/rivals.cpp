// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/baselines.h"

#include "baselines/solvers.h"

#include <algorithm>
#include <array>

namespace mneme {
namespace {

constexpr std::array<Rival, 4> kRivals = {{
    {"cache", "fastest remembered path with ends within the tolerance, unchecked",
     internal::fetch_fastest},
    {"cache_nearest", "remembered path with the nearest ends, unchecked", internal::fetch_nearest},
    {"cache_checked", "fastest remembered path within the tolerance that is free",
     internal::fetch_free},
    {"ert_connect", "two trees that grow by pieces of the most similar remembered path",
     internal::solve_by_ert_connect},
}};

}  // namespace

std::span<const Rival> rivals() { return kRivals; }

const Rival* find_rival(std::string_view name) {
  const auto found = std::ranges::find(kRivals, name, &Rival::name);
  return found == kRivals.end() ? nullptr : &*found;
}

}  // namespace mneme
