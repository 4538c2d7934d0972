// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "data/cache_directory.h"

#include <cstdlib>
#include <string>

#include <doctest/doctest.h>

namespace mneme::test {
namespace {

/// Sets a variable of the environment, and puts it back at the end.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    const char* old = std::getenv(name);
    is_set_ = old != nullptr;
    if (is_set_) old_ = old;
    ::setenv(name, value, 1);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  ~Variable() { is_set_ ? ::setenv(name_, old_.c_str(), 1) : ::unsetenv(name_); }

 private:
  const char* name_;
  bool is_set_ = false;
  std::string old_;
};

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("the cache stands where the environment says, if that is an absolute path") {
    const Variable home("HOME", "/home/me");
    {
      const Variable cache("XDG_CACHE_HOME", "/var/cache/me");
      CHECK(internal::cache_directory() == "/var/cache/me/mneme");
    }
    for (const char* none : {"", "relative"}) {
      const Variable cache("XDG_CACHE_HOME", none);
      CHECK(internal::cache_directory() == "/home/me/.cache/mneme");
    }
  }

  TEST_CASE("without a home there is no cache") {
    const Variable cache("XDG_CACHE_HOME", "");
    const Variable home("HOME", "");
    CHECK(internal::cache_directory().empty());
  }
}

}  // namespace mneme::test
