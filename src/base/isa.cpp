// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mneme/base.h"

#include "base/fail.h"

#include <hwy/targets.h>

#include <cstdlib>
#include <optional>

namespace mneme {
namespace {

struct NamedIsa {
  Isa isa;
  std::string_view name;
  std::int64_t target;
};

// From the worst to the best.
constexpr std::array<NamedIsa, 6> kIsas{{{Isa::scalar, "scalar", HWY_SCALAR},
                                         {Isa::sse, "sse", HWY_SSE4},
                                         {Isa::avx2, "avx2", HWY_AVX2},
                                         {Isa::avx512, "avx512", HWY_AVX3},
                                         {Isa::neon, "neon", HWY_NEON},
                                         {Isa::wasm, "wasm", HWY_WASM}}};

bool is_available(const NamedIsa& entry) {
  // The query takes tens of microseconds on virtual machines. It leaves out the scalar kernels,
  // which every machine can run.
  static const std::int64_t supported = hwy::SupportedTargets() | HWY_SCALAR;
  return (supported & HWY_TARGETS & entry.target) != 0;
}

/// The name of the instruction set with four lanes that rounds products before it adds them.
constexpr std::string_view kPortable = "portable";

std::optional<Isa> portable_isa() {
  for (const Isa isa : {Isa::sse, Isa::neon, Isa::wasm}) {
    if (is_available(isa)) return isa;
  }
  return std::nullopt;
}

std::string available_names() {
  std::string names(to_string(Isa::automatic));
  if (portable_isa()) names.append(", ").append(kPortable);
  for (const Isa isa : available_isas()) names.append(", ").append(to_string(isa));
  return names;
}

}  // namespace

std::vector<Isa> available_isas() {
  std::vector<Isa> isas;
  for (const NamedIsa& entry : kIsas) {
    if (is_available(entry)) isas.push_back(entry.isa);
  }
  return isas;
}

Isa default_isa() {
  const char* name = std::getenv("MNEME_ISA");
  const Isa wanted = parse_isa(name == nullptr ? "" : name).value_or(Isa::automatic);
  if (wanted != Isa::automatic) return wanted;
  static const Isa best = available_isas().back();
  return best;
}

Isa resolve_isa(Isa isa) { return isa == Isa::automatic ? default_isa() : isa; }

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
  if (name == kPortable) {
    if (const auto isa = portable_isa()) return *isa;
  }
  for (const NamedIsa& entry : kIsas) {
    if (entry.name != name) continue;
    if (is_available(entry)) return entry.isa;
    return fail(ErrorCode::unsupported, "this machine lacks the instruction set '{}'; it has: {}",
                name, available_names());
  }
  return fail(ErrorCode::invalid, "unknown instruction set '{}'; expected one of: {}", name,
              available_names());
}

}  // namespace mneme
