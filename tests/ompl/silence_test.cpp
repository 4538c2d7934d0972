// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ompl/planner_table.h"
#include "support/support.h"

#include <ompl/util/Console.h>

namespace mneme::test {
namespace {

struct Listener final : ::ompl::msg::OutputHandler {
  void log(const std::string&, ::ompl::msg::LogLevel, const char*, int) override { ++lines; }
  int lines = 0;
};

void log_error() { ::ompl::msg::log(__FILE__, __LINE__, ::ompl::msg::LOG_ERROR, "an error"); }

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("OMPL's log is silent as long as any silence lasts, and goes where it went before") {
    Listener listener;
    ::ompl::msg::OutputHandler* const before = ::ompl::msg::getOutputHandler();
    ::ompl::msg::useOutputHandler(&listener);
    {
      const mneme::ompl::Silence outer;
      { const mneme::ompl::Silence inner; }
      log_error();
    }
    CHECK(listener.lines == 0);
    log_error();
    CHECK(listener.lines == 1);
    ::ompl::msg::useOutputHandler(before);
  }
}

}  // namespace mneme::test
