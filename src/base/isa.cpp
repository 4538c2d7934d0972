// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include <hwy/targets.h>

#include <cstdlib>

namespace mneme {
namespace {

struct NamedIsa {
  Isa isa;
  std::string_view name;
  std::int64_t target;
};

// From the worst to the best.
constexpr std::array<NamedIsa, 4> kIsas{{{Isa::scalar, "scalar", HWY_SCALAR},
                                         {Isa::sse, "sse", HWY_SSE4},
                                         {Isa::avx2, "avx2", HWY_AVX2},
                                         {Isa::avx512, "avx512", HWY_AVX3}}};

bool is_available(const NamedIsa& entry) {
  // The query takes tens of microseconds on virtual machines.
  static const std::int64_t supported = hwy::SupportedTargets();
  return entry.isa == Isa::scalar || (supported & entry.target) != 0;
}

Isa best_isa() {
  Isa best = Isa::scalar;
  for (const NamedIsa& entry : kIsas) {
    if (is_available(entry)) best = entry.isa;
  }
  return best;
}

std::string available_names() {
  std::string names(to_string(Isa::automatic));
  for (const NamedIsa& entry : kIsas) {
    if (is_available(entry)) names.append(", ").append(entry.name);
  }
  return names;
}

}  // namespace

Isa default_isa() {
  const char* name = std::getenv("MNEME_ISA");
  const Isa wanted = parse_isa(name == nullptr ? "" : name).value_or(Isa::automatic);
  return wanted == Isa::automatic ? best_isa() : wanted;
}

bool is_available(Isa isa) {
  for (const NamedIsa& entry : kIsas) {
    if (entry.isa == isa) return is_available(entry);
  }
  return isa == Isa::automatic;
}

std::string_view to_string(Isa isa) {
  for (const NamedIsa& entry : kIsas) {
    if (entry.isa == isa) return entry.name;
  }
  return "automatic";
}

Result<Isa> parse_isa(std::string_view name) {
  if (name == to_string(Isa::automatic)) return Isa::automatic;
  for (const NamedIsa& entry : kIsas) {
    if (entry.name != name) continue;
    if (is_available(entry)) return entry.isa;
    return fail(ErrorCode::unsupported, "this machine lacks the instruction set '" +
                                            std::string(name) + "'; it has: " + available_names());
  }
  return fail(ErrorCode::invalid, "unknown instruction set '" + std::string(name) +
                                      "'; expected one of: " + available_names());
}

}  // namespace mneme
