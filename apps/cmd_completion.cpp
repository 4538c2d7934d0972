// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme completion: what a shell completes, from the help of the subcommands.
#include "command_line.h"
#include "commands.h"
#include "options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

namespace mneme::app {
namespace {

using Commands = std::vector<CommandDescription>;

/// A pattern for each command but the program itself: " db", " db info".
std::string command_patterns(const Commands& commands) {
  std::vector<std::string> patterns;
  for (const CommandDescription& command : commands) {
    if (!command.words.empty()) patterns.push_back(fmt::format("\" {}\"", command.words));
  }
  return fmt::format("{}", fmt::join(patterns, "|"));
}

std::string case_of(const CommandDescription& command) {
  return fmt::format("\"{}{}\"", command.words.empty() ? "" : " ", command.words);
}

std::vector<std::string> flag_names(const CommandDescription& command) {
  std::vector<std::string> names;
  for (const FlagDescription& flag : command.flags) {
    names.insert(names.end(), flag.names.begin(), flag.names.end());
  }
  return names;
}

std::string bash_completion(const Commands& commands) {
  std::string script = fmt::format(R"(# bash completion for mneme
_mneme() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} command="" word subcommands="" flags=""
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$command $word" in
      {}) command="$command $word" ;;
    esac
  done
  case "$command" in
)",
                                   command_patterns(commands));
  for (const CommandDescription& command : commands) {
    std::vector<std::string> names;
    for (const auto& [name, sentence] : command.subcommands) names.push_back(name);
    script += fmt::format("    {}) subcommands=\"{}\" flags=\"{}\" ;;\n", case_of(command),
                          fmt::join(names, " "), fmt::join(flag_names(command), " "));
  }
  script += R"(  esac
  [[ $current == -* ]] && subcommands=$flags
  COMPREPLY=($(compgen -W "$subcommands" -- "$current"))
}
complete -o default -F _mneme mneme
)";
  return script;
}

/// 'name:sentence' as one word of zsh.
std::string zsh_word(std::string_view name, std::string_view sentence) {
  std::string word = "'";
  for (const char c : fmt::format("{}:{}", name, sentence)) {
    word += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return word + "'";
}

std::string zsh_completion(const Commands& commands) {
  std::string script = fmt::format(R"(#compdef mneme
local -a subcommands flags
local command="" word
for word in ${{words[2,CURRENT-1]}}; do
  case "$command $word" in
    ({}) command="$command $word" ;;
  esac
done
case "$command" in
)",
                                   command_patterns(commands));
  for (const CommandDescription& command : commands) {
    script += fmt::format("  ({})\n    subcommands=(", case_of(command));
    for (const auto& [name, sentence] : command.subcommands)
      script += zsh_word(name, sentence) + " ";
    script += ")\n    flags=(";
    for (const FlagDescription& flag : command.flags) {
      for (const std::string& name : flag.names) script += zsh_word(name, flag.sentence) + " ";
    }
    script += ")\n    ;;\n";
  }
  script += R"(esac
if [[ $PREFIX == -* ]]; then
  _describe flag flags
elif (( $#subcommands )); then
  _describe command subcommands
else
  _files
fi
)";
  return script;
}

/// `text` as one word of fish.
std::string fish_word(std::string_view text) {
  std::string word = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') word += '\\';
    word += c;
  }
  return word + "'";
}

std::string fish_flag(const FlagDescription& flag) {
  std::string text;
  for (const std::string& name : flag.names) {
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  return text + (flag.value.empty() ? "" : " -r");
}

std::string fish_completion(const Commands& commands) {
  std::string script =
      "# fish completion for mneme\nfunction __mneme_at\n  set -l command\n"
      "  for word in (commandline -opc)[2..-1]\n"
      "    switch (string trim \"$command $word\")\n      case";
  for (const CommandDescription& command : commands) {
    if (!command.words.empty()) script += " " + fish_word(command.words);
  }
  script +=
      "\n        set command (string trim \"$command $word\")\n    end\n  end\n"
      "  test \"$command\" = \"$argv[1]\"\nend\n";
  for (const CommandDescription& command : commands) {
    const std::string head =
        fmt::format("complete -c mneme -n {}", fish_word("__mneme_at '" + command.words + "'"));
    for (const auto& [name, sentence] : command.subcommands) {
      script += fmt::format("{} -f -a {} -d {}\n", head, name, fish_word(sentence));
    }
    for (const FlagDescription& flag : command.flags) {
      script += fmt::format("{}{} -d {}\n", head, fish_flag(flag), fish_word(flag.sentence));
    }
  }
  return script;
}

std::string completion(const std::string& shell, const Commands& commands) {
  if (shell == "bash") return bash_completion(commands);
  return shell == "zsh" ? zsh_completion(commands) : fish_completion(commands);
}

}  // namespace

void add_completion(CLI::App& program, Action& action) {
  CLI::App* command =
      program.add_subcommand("completion", "Print the completion script of a shell");
  command->footer(
      "Example:\n  mneme completion bash > ~/.local/share/bash-completion/completions/mneme");
  const auto shell = std::make_shared<std::string>();
  add_choice(*command, "SHELL", "shell", *shell, {"bash", "zsh", "fish"}, "shell")->required();
  command->callback([shell, &program, &action] {
    action = [shell, &program]() -> Result<ExitCode> {
      fmt::print("{}", completion(*shell, describe_commands(program)));
      return ExitCode::done;
    };
  });
}

}  // namespace mneme::app
