// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz_input.h"

#include <vector>

#include "commands.h"

/// Arguments are lines. They are parsed; what they ask for is not done.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMaxArguments = 100;
  std::vector<std::string> arguments = {"mneme", ""};
  for (const char c : mneme::fuzz::as_text(data, size)) {
    if (c == '\n' && arguments.size() < kMaxArguments) {
      arguments.emplace_back();
    } else if (c != '\0') {
      arguments.back() += c;
    }
  }
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  CLI::App program("mneme");
  mneme::app::Action action;
  for (const auto add :
       {mneme::app::add_demo, mneme::app::add_plan, mneme::app::add_learn, mneme::app::add_db,
        mneme::app::add_robot, mneme::app::add_scene, mneme::app::add_bench, mneme::app::add_view,
        mneme::app::add_doctor, mneme::app::add_completion, mneme::app::add_manual}) {
    add(program, action);
  }
  program.require_subcommand(1);
  try {
    program.parse(static_cast<int>(pointers.size()), pointers.data());
  } catch (const CLI::Error&) {
  }
  return 0;
}
