// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Command line flags: numbers read strictly, and the settings that the public headers declare.
#pragma once

#include "mneme/pipeline.h"
#include "mneme/robot.h"

#include "commands.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::app {

/// Adds the subcommand `name` with an example, the words after "mneme ". Once its flags have filled
/// `options`, `check` may complete them or throw a usage error; then the action is `run`.
template <class Options>
CLI::App& add_command(CLI::App& group, Action& action, const std::string& name,
                      const std::string& sentence, const std::string& example,
                      const std::shared_ptr<Options>& options,
                      Result<ExitCode> (*run)(const Options&),
                      void (*check)(const CLI::App&, Options&) = nullptr) {
  CLI::App* command = group.add_subcommand(name, sentence);
  command->footer("Example:\n  mneme " + example);
  command->callback([=, &action] {
    if (check != nullptr) check(*command, *options);
    action = [=] { return run(*options); };
  });
  return *command;
}

/// A group of subcommands with an example.
CLI::App& add_group(CLI::App& program, const std::string& name, const std::string& sentence,
                    const std::string& example);

/// The number that is all of `text`, or nothing; "nan" and "inf" are numbers of type double.
template <class T>
[[nodiscard]] std::optional<T> parse_number(std::string_view text);

/// Items of `text` between `separator`s; a usage error that names `flag` and the first item that is
/// no number.
[[nodiscard]] std::vector<double> parse_numbers(const std::string& flag, std::string_view text,
                                                char separator = ',');

/// A flag whose value is handed to `read`, which throws CLI::ValidationError if it is wrong.
CLI::Option* add_text(CLI::App& app, const std::string& flag,
                      std::function<void(const std::string&)> read, const std::string& help);

/// A flag of the form LEAST:MOST; a single number is both.
void add_range(CLI::App& app, const std::string& flag, std::array<double, 2>& range,
               const std::string& help);

/// A flag for values of joints, separated by commas, or the name of a state.
CLI::Option* add_configuration(CLI::App& app, const std::string& flag,
                               std::optional<GivenConfiguration>& given, const std::string& help);

/// A flag, which may be given several times, for poses of links: LINK:X,Y,Z,QX,QY,QZ,QW, or
/// LINK:X,Y,Z for any rotation.
CLI::Option* add_poses(CLI::App& app, const std::string& flag, std::vector<PoseGoal>& poses,
                       const std::string& help);
/// Links that are to stay upright, several if it is given several times.
CLI::Option* add_upright(CLI::App& app, std::vector<OrientationConstraint>& constraints);

/// A flag for a part of many problems: I/N, counted from 1.
CLI::Option* add_part(CLI::App& app, std::string& part);

template <class T>
[[nodiscard]] std::string describe_range(T least, T most) {
  return most == std::numeric_limits<T>::max() ? fmt::format("{} or more", least)
                                               : fmt::format("{} to {}", least, most);
}

/// The number from `least` to `most` that `text` is; otherwise a usage error that names `flag`.
template <class T>
[[nodiscard]] T parse_in_range(const std::string& flag, const std::string& text, T least, T most) {
  const std::optional<T> number = parse_number<T>(text);
  // Written so that a NaN is out of range.
  if (number && *number >= least && *number <= most) return *number;
  // "0 or more" does not say why a number that is too large for T is refused.
  const bool is_large =
      std::integral<T> && text.find_first_not_of("0123456789") == std::string::npos;
  throw CLI::ValidationError(
      flag,
      fmt::format("'{}' is not {} of {}", text, std::integral<T> ? "a whole number" : "a number",
                  is_large ? fmt::format("{} to {}", least, most) : describe_range(least, most)));
}

/// A flag for a number from `least` to `most`. Its default is the value it has, if there is one.
template <class T>
CLI::Option* add_number(CLI::App& app, const std::string& flag, T& value, SettingValue<T> least,
                        SettingValue<T> most, const std::string& help) {
  using Value = SettingValue<T>;
  const auto read = [=, &value](const std::string& text) {
    value = parse_in_range<Value>(flag, text, least, most);
  };
  std::string range = describe_range<Value>(least, most);
  if constexpr (!SettingTraits<T>::kIsOptional) range = fmt::format("default {}; {}", value, range);
  return add_text(app, flag, read, fmt::format("{} ({})", help, range))
      ->type_name(std::integral<Value> ? "N" : "X");
}

/// A flag that takes one of `names`.
CLI::Option* add_choice(CLI::App& app, const std::string& flag, const std::string& what,
                        std::string& value, std::vector<std::string> names,
                        const std::string& help);

/// Turns the declarations of visit_settings into flags; with `only`, just the ones named.
class SettingsFlags {
 public:
  SettingsFlags(CLI::App& app, std::initializer_list<std::string_view> only)
      : app_(app), only_(only) {}

  template <class T>
  void operator()(std::string_view name, T& value, SettingValue<T> least, SettingValue<T> most,
                  std::string_view sentence) {
    if (!is_wanted(name)) return;
    if constexpr (std::same_as<SettingValue<T>, bool>) {
      add_switch(name, value, sentence);
    } else {
      add_number(app_, fmt::format("--{}", name), value, least, most, std::string(sentence));
    }
  }

 private:
  [[nodiscard]] bool is_wanted(std::string_view name) const;
  void add_switch(std::string_view name, bool& value, std::string_view sentence);
  void add_switch(std::string_view name, std::optional<bool>& value, std::string_view sentence);
  CLI::App& app_;
  std::vector<std::string_view> only_;
};

template <class Settings>
std::vector<CLI::Option*> add_settings(CLI::App& app, Settings& settings,
                                       std::initializer_list<std::string_view> only = {}) {
  const auto before = std::ssize(app.get_options());
  visit_settings(settings, SettingsFlags(app, only));
  const std::vector<CLI::Option*> all = app.get_options();
  return {all.begin() + before, all.end()};
}

/// The flag --kind and those of the settings.
void add_memory_settings(CLI::App& app, MemorySettings& settings);
/// The flag --isa, which forces the instruction set of all kernels.
void add_isa(CLI::App& app);
/// Adds --srdf, --group, --fix, --package-path, --strict and --hard-limits.
void add_robot_flags(CLI::App& app, RobotOptions& options);
/// Adds the flags that control how URDF and SRDF are read.
void add_reading_flags(CLI::App& app, RobotOptions& options);
/// The required argument ROBOT and the same flags.
void add_robot_argument(CLI::App& app, std::string& robot, RobotOptions& options);
/// The flag --robot for a robot instead of the problem's, and the same flags.
void add_other_robot(CLI::App& app, std::string& robot, RobotOptions& options);
/// The required argument PROBLEMS and the flag --part; `suites` says what else the argument may be.
void add_problem_list(CLI::App& app, std::vector<std::string>& problems, std::string& part,
                      const std::string& suites = "");
/// The required argument SCENE, a scene or a problem.
void add_scene_argument(CLI::App& app, std::string& scene);
/// The flag --seed.
void add_seed(CLI::App& app, std::uint64_t& seed, const std::string& help);
/// The flags --db, whose help is `help`, and --db-memory.
CLI::Option* add_database(CLI::App& app, std::string& url, DatabaseSettings& settings,
                          const std::string& help);
/// The flag --json.
void add_json(CLI::App& app, bool& is_json);
/// The flag --jobs: threads; the default is one per hardware thread.
void add_jobs(CLI::App& app, int& jobs);

/// A heading of the help and the names, without dashes, of the flags that stand under it.
struct FlagGroup {
  std::string heading;
  std::vector<std::string> flags;
};
/// Puts the flags that are added to `command` from now on under `heading`, where --help leaves them
/// out and --help-all shows them.
void begin_rare_flags(CLI::App& command, const std::string& heading);
/// Puts flags under the headings that --help shows.
void show_flags(CLI::App& command, const std::vector<FlagGroup>& groups);

/// Help whose descriptions are wrapped to the width of a terminal. --help leaves out
/// rare flags.
[[nodiscard]] std::shared_ptr<CLI::Formatter> make_help_formatter();

}  // namespace mneme::app
