// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme manual: the manual page, from the help of the subcommands.
#include "command_line.h"
#include "commands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace mneme::app {
namespace {

constexpr const char* kEnvironment = R"(.SH ENVIRONMENT
.TP
.B MNEME_ROBOT_PATH
directories, separated by colons, that are searched for robots by name
.TP
.B MNEME_ISA
instruction set of the kernels: scalar, sse, avx2, avx512 or portable
.TP
.B ROS_PACKAGE_PATH
directories of the packages of package:// in robot files
.TP
.B NO_COLOR
if set, messages have no colours
.SH FILES
.TP
.I $XDG_CACHE_HOME/mneme
spheres that approximate the meshes of robots; may be removed
.SH SEE ALSO
.BR sqlite3 (1),
.BR psql (1),
.BR xacro (1),
.BR check_urdf (1)
.PP
The documents of the source tree, README.md first, and the schemas of all files in
.IR share/mneme/schema .
)";

/// Text that troff prints as it is.
std::string escaped(std::string_view text) {
  std::string result;
  bool is_line_start = true;
  for (const char c : text) {
    if (is_line_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
    is_line_start = c == '\n';
  }
  return result;
}

std::string page_of(const FlagDescription& flag) {
  std::string head =
      fmt::format("\\fB{}\\fR", escaped(fmt::format("{}", fmt::join(flag.names, ", "))));
  if (!flag.value.empty()) head += fmt::format(" \\fI{}\\fR", escaped(flag.value));
  return fmt::format(".TP\n{}\n{}\n", head, escaped(flag.sentence));
}

std::string page_of(const CommandDescription& command) {
  std::string page;
  if (!command.words.empty()) {
    page = fmt::format(".SS mneme {}\n{}.\n", command.words, escaped(command.sentence));
  }
  for (const FlagDescription& argument : command.arguments) page += page_of(argument);
  for (const FlagDescription& flag : command.flags) page += page_of(flag);
  if (!command.footer.empty()) {
    page += fmt::format(".PP\n.nf\n{}\n.fi\n", escaped(command.footer));
  }
  return page;
}

std::string manual(const CLI::App& program) {
  const std::vector<CommandDescription> commands = describe_commands(program);
  std::string page = fmt::format(
      ".TH MNEME 1 \"\" \"mneme {}\" \"User commands\"\n"
      ".SH NAME\nmneme \\- motion planning from memory\n"
      ".SH SYNOPSIS\n.B mneme\n.I COMMAND\n.RI [ ARGUMENT ...]\n"
      ".SH DESCRIPTION\n{}\n",
      version(), escaped(commands.front().sentence));
  page += page_of(commands.front());
  page += ".SH COMMANDS\n";
  std::for_each(commands.begin() + 1, commands.end(),
                [&](const CommandDescription& command) { page += page_of(command); });
  return page + kEnvironment;
}

}  // namespace

void add_manual(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("manual", "Print the manual page");
  command->footer("Example:\n  mneme manual | man -l -");
  command->callback([&program, &action] {
    action = [&program]() -> Result<ExitCode> {
      fmt::print("{}", manual(program));
      return ExitCode::done;
    };
  });
}

}  // namespace mneme::app
