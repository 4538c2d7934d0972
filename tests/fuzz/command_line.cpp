// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.h"

#include "commands.h"
#include "fuzz/fuzz_input.h"
#include "options.h"

#include <sstream>
#include <string_view>
#include <vector>

namespace {

struct Program {
  Program() {
    app.formatter(mneme::app::make_help_formatter());
    app.set_help_all_flag("--help-all");
    for (const auto add :
         {mneme::app::add_demo, mneme::app::add_plan, mneme::app::add_learn, mneme::app::add_db,
          mneme::app::add_robot, mneme::app::add_scene, mneme::app::add_bench, mneme::app::add_view,
          mneme::app::add_doctor, mneme::app::add_completion, mneme::app::add_manual,
          mneme::app::add_settings_list}) {
      add(app, action);
    }
    app.require_subcommand(1);
  }
  CLI::App app{"mneme"};
  mneme::app::Action action;
};

/// Arguments are lines.
std::vector<std::string> split(std::string_view text) {
  constexpr std::size_t kMaxArguments = 100;
  std::vector<std::string> arguments = {"mneme", ""};
  for (const char c : text) {
    if (c == '\n' && arguments.size() < kMaxArguments) {
      arguments.emplace_back();
    } else if (c != '\0') {
      arguments.back() += c;
    }
  }
  return arguments;
}

}  // namespace

/// Arguments are parsed, or refused with advice; what they ask for is not done.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Parsing clears what the last input left; putting the program together takes far longer.
  static Program program;
  std::vector<std::string> arguments = split(mneme::fuzz::as_text(data, size));
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  try {
    program.app.parse(static_cast<int>(pointers.size()), pointers.data());
  } catch (const CLI::Success& request) {
    std::ostringstream text;
    (void)program.app.exit(request, text, text);
  } catch (const CLI::Error& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
  return 0;
}
