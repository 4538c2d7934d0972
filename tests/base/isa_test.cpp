// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <optional>
#include <string>

#include "support/support.h"

namespace mneme {
namespace {

/// Sets MNEME_ISA for one scope.
class IsaVariable {
 public:
  explicit IsaVariable(const char* value) {
    if (const char* old = std::getenv("MNEME_ISA")) old_ = old;
    ::setenv("MNEME_ISA", value, 1);
  }
  ~IsaVariable() {
    if (old_) {
      ::setenv("MNEME_ISA", old_->c_str(), 1);
    } else {
      ::unsetenv("MNEME_ISA");
    }
  }

 private:
  std::optional<std::string> old_;
};

constexpr Isa kAll[] = {Isa::automatic, Isa::scalar, Isa::sse, Isa::avx2, Isa::avx512};

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

  TEST_CASE("an unknown instruction set is an error that lists the known ones") {
    const auto parsed = parse_isa("mmx");
    REQUIRE_FALSE(parsed.has_value());
    CHECK(parsed.error().code == ErrorCode::invalid);
    CHECK(parsed.error().message.find("'mmx'") != std::string::npos);
    CHECK(parsed.error().message.find("scalar") != std::string::npos);
  }

  TEST_CASE("MNEME_ISA chooses the default instruction set") {
    const IsaVariable variable("scalar");
    CHECK(default_isa() == Isa::scalar);
  }

  TEST_CASE("an unknown name in MNEME_ISA leaves the best instruction set") {
    const IsaVariable unknown("quantum");
    const Isa best = default_isa();
    for (const Isa isa : kAll) {
      if (is_available(isa)) CHECK(static_cast<int>(isa) <= static_cast<int>(best));
    }
    const IsaVariable automatic("automatic");
    CHECK(default_isa() == best);
  }
}

}  // namespace mneme
