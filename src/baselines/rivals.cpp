// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/baselines.h"

#include "baselines/solvers.h"

#include <algorithm>
#include <array>

namespace mneme {
namespace {

constexpr std::array<Rival, 4> kRivals = {{
    {"cache", "the fastest remembered path whose ends are within the tolerance, as it is",
     internal::fetch_fastest},
    {"cache_nearest", "the remembered path whose ends are nearest, as it is",
     internal::fetch_nearest},
    {"cache_checked", "the fastest remembered path within the tolerance that is free, as it is",
     internal::fetch_free},
    {"ert_connect", "two trees grown by pieces of the most similar remembered path",
     internal::solve_by_ert_connect},
}};

}  // namespace

std::span<const Rival> rivals() { return kRivals; }

const Rival* find_rival(std::string_view name) {
  const auto found = std::ranges::find(kRivals, name, &Rival::name);
  return found == kRivals.end() ? nullptr : &*found;
}

}  // namespace mneme
