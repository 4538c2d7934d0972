// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/environment.h"
#include "support/support.h"

namespace mneme {
namespace {

using test::contains;
using test::require;
using test::require_error;

constexpr Isa kAll[] = {Isa::automatic, Isa::scalar, Isa::sse, Isa::avx2,
                        Isa::avx512,    Isa::neon,   Isa::wasm};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("every machine has the scalar instruction set") {
    CHECK(is_available(Isa::scalar));
    CHECK(is_available(Isa::automatic));
  }

  TEST_CASE("the default instruction set is a concrete one that the machine has") {
    CHECK(default_isa() != Isa::automatic);
    CHECK(is_available(default_isa()));
  }

  TEST_CASE("names of available instruction sets are read back and others are refused") {
    for (const Isa isa : kAll) {
      const auto parsed = parse_isa(to_string(isa));
      CHECK(parsed.has_value() == is_available(isa));
      if (parsed) CHECK(*parsed == isa);
    }
  }

  TEST_CASE("portable is the instruction set of four lanes") {
    const auto parsed = require(parse_isa("portable"));
    CHECK((parsed == Isa::sse || parsed == Isa::neon));
    const test::EnvironmentVariable variable("MNEME_ISA", "portable");
    CHECK(default_isa() == parsed);
  }

  TEST_CASE("an unknown instruction set is an error that lists the known ones") {
    const Error error = require_error(parse_isa("mmx"));
    CHECK(error.code == ErrorCode::invalid);
    CHECK(contains(error.message, "'mmx'"));
    CHECK(contains(error.message, "scalar"));
  }

  TEST_CASE("MNEME_ISA chooses the default instruction set") {
    const test::EnvironmentVariable variable("MNEME_ISA", "scalar");
    CHECK(default_isa() == Isa::scalar);
  }

  TEST_CASE("an unknown name in MNEME_ISA leaves the best instruction set") {
    const test::EnvironmentVariable unknown("MNEME_ISA", "quantum");
    const Isa best = default_isa();
    for (const Isa isa : kAll) {
      if (is_available(isa)) CHECK(static_cast<int>(isa) <= static_cast<int>(best));
    }
    const test::EnvironmentVariable automatic("MNEME_ISA", "automatic");
    CHECK(default_isa() == best);
  }
}

}  // namespace mneme
