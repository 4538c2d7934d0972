// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/base.h"
#include "mneme/baselines.h"
#ifdef MNEME_WITH_OMPL
#include "mneme/ompl.h"
#endif

#include "commands.h"
#include "console.h"
#include "options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::app {
namespace {

constexpr const char* kExamples = R"(Examples:
  mneme plan scenes/shelf/thin.yaml --view plan.html
  mneme demo --open
  mneme learn --robot planar8 --primitives scenes/planar/grid.yaml --db planar.db
  mneme plan scenes/planar/scenario1.yaml --db planar.db --view scenario1.html
  mneme db info planar.db
Installed, the scenes of the examples are in share/mneme: see 'mneme doctor'.

Exit codes: 0 done or solved, 1 failure, 2 wrong usage, 3 no path within the limit or no proof,
  4 invalid start or goal, 5 database of another robot or corrupt, 130 interrupted)";

void set_up(CLI::App& program, Action& action) {
  add_baseline_samplers();
#ifdef MNEME_WITH_OMPL
  add_ompl_planners();
#endif
  program.name("mneme");
  program.formatter(make_help_formatter());
  program.set_version_flag("--version", fmt::format("mneme {}", version()));
  program.set_help_all_flag("--help-all", "Print this help message with all flags and exit");
  program.footer(kExamples);
  add_demo(program, action);
  add_plan(program, action);
  add_line(program, action);
  add_learn(program, action);
  add_db(program, action);
  add_robot(program, action);
  add_scene(program, action);
  add_cell(program, action);
  add_bench(program, action);
  add_view(program, action);
  add_serve(program, action);
  add_doctor(program, action);
  add_completion(program, action);
  add_manual(program, action);
  add_settings_list(program, action);
  program.require_subcommand(1);
}

/// The subcommand that was chosen, as far as it was understood.
const CLI::App& chosen_command(const CLI::App& program) {
  const std::vector<CLI::App*> chosen = program.get_subcommands();
  return chosen.empty() ? program : chosen_command(*chosen.front());
}

std::string full_name(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return parent == nullptr ? command.get_name() : full_name(*parent) + " " + command.get_name();
}

/// The first word that `command` does not know, with what it may have been meant to be; otherwise
/// what CLI11 says.
std::string describe(const std::string& error, const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  if (words.empty()) return error;
  // An unknown flag leaves its value over too: the flag is what to complain about.
  auto word = std::ranges::find_if(words, [](const auto& w) { return w.starts_with('-'); });
  if (word == words.end()) word = words.begin();
  std::vector<std::string> known;
  for (const CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; })) {
    known.push_back(subcommand->get_name());
  }
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  return fmt::format("unexpected argument '{}'{}", *word,
                     did_you_mean(word->substr(0, word->find('=')), known));
}

/// CLI11 would take the next word for the value of "--flag=".
const char* flag_without_value(std::span<char*> words) {
  for (const std::string_view word : words) {
    if (word == "--") return nullptr;
    if (word.starts_with("--") && word.find('=') == word.size() - 1) return word.data();
  }
  return nullptr;
}

int report_usage_error(const CLI::App& command, const std::string& message) {
  print_error(message);
  print_note(fmt::format("see '{} --help'", full_name(command)));
  return static_cast<int>(ExitCode::usage);
}

int act(const Action& action) {
  const Result<ExitCode> outcome = action();
  if (!outcome) {
    print_error(outcome.error().message);
    return static_cast<int>(exit_code(outcome.error().code));
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    print_error("cannot write to standard output");
    return static_cast<int>(ExitCode::failure);
  }
  return static_cast<int>(*outcome);
}

int run(int argument_count, char** arguments) {
  CLI::App program(
      "Plans motions of robot arms, proves them free of contact, and remembers solved problems.");
  Action action;
  set_up(program, action);
  if (const char* flag = flag_without_value({arguments, arguments + argument_count})) {
    return report_usage_error(program, fmt::format("{}: expected a value after '='", flag));
  }
  try {
    program.parse(argument_count, arguments);
  } catch (const CLI::Success& request) {
    const CLI::App& command = chosen_command(program);
    if (command.remaining().empty()) return program.exit(request);
    return report_usage_error(command, describe(request.what(), command));
  } catch (const CLI::ParseError& error) {
    const CLI::App& command = chosen_command(program);
    return report_usage_error(command, describe(error.what(), command));
  }
  const char* isa = std::getenv("MNEME_ISA");
  const Result<Isa> parsed = parse_isa(isa == nullptr || *isa == '\0' ? "automatic" : isa);
  if (!parsed) return report_usage_error(program, "MNEME_ISA: " + parsed.error().message);
  return act(action);
}

}  // namespace
}  // namespace mneme::app

int main(int argument_count, char** arguments) {
  try {
    return mneme::app::run(argument_count, arguments);
  } catch (const std::bad_alloc&) {
    mneme::app::print_error(
        "memory ran out; try less --max-nodes, less --threads or less geometry");
  } catch (const std::exception& error) {
    mneme::app::print_error(error.what());
  }
  return static_cast<int>(mneme::app::ExitCode::failure);
}
