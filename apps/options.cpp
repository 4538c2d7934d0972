// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "options.h"

#include "mneme/base.h"
#include "mneme/benchmark.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <thread>

namespace mneme::app {
namespace {

constexpr std::size_t kFlagColumn = 30;
constexpr std::size_t kHelpWidth = 100;

/// Ends the names of the groups of flags that --help leaves out.
constexpr std::string_view kMore = ", more";

/// The defaults of settings that depend on the kind of memory.
std::string describe_kinds() {
  constexpr const char* kRow = "  {:<16}{:>8}{:>8}{:>12}{:>13}{:>18}{:>9}\n";
  std::string text = "Defaults by kind of memory:\n";
  text += fmt::format(kRow, "kind", "lambda", "sigma", "similarity", "max-matches",
                      "first-components", "max-gap");
  for (const MemoryKind* kind : memory_kinds()) {
    const MemoryDefaults& defaults = kind->defaults;
    text +=
        fmt::format(kRow, kind->name, defaults.share.lambda, defaults.sigma, defaults.similarity,
                    defaults.max_matches, defaults.first_components, defaults.max_gap);
  }
  return text + "\n";
}

class WrappingFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    is_whole_ = mode != CLI::AppFormatMode::Normal;
    std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
    // CLI11 puts empty lines between groups, also where one was left out.
    while (text.find("\n\n\n") != std::string::npos) {
      text = CLI::detail::find_and_replace(text, "\n\n\n", "\n\n");
    }
    return text;
  }

  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    if (!is_whole_ && group.ends_with(kMore)) return "";
    return CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
  }

  std::string make_footer(const CLI::App* app) const override {
    const std::vector<std::string> groups = app->get_groups();
    const bool is_whole = is_whole_ || std::ranges::none_of(groups, [](const std::string& group) {
                            return group.ends_with(kMore);
                          });
    std::string text = is_whole ? "" : "More flags: --help-all\n\n";
    if (is_whole_ && app->get_option_no_throw("--kind") != nullptr) text += describe_kinds();
    return text + CLI::Formatter::make_footer(app);
  }

  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    // CLI11 shows the value that a negated flag stands for.
    return CLI::detail::find_and_replace(CLI::Formatter::make_option_name(option, is_positional),
                                         "{false}", "");
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    std::string wrapped;
    std::size_t column = 0;
    std::istringstream words(option->get_description());
    for (std::string word; words >> word;) {
      const bool fits = column + word.size() < kHelpWidth - kFlagColumn;
      if (!wrapped.empty()) wrapped += fits ? ' ' : '\n';
      column = (fits ? column + 1 : 0) + word.size();
      wrapped += word;
    }
    return wrapped;
  }

 private:
  mutable bool is_whole_ = true;  ///< the help that is being made leaves nothing out
};

}  // namespace

CLI::App& add_group(CLI::App& program, const std::string& name, const std::string& sentence,
                    const std::string& example) {
  CLI::App* group = program.add_subcommand(name, sentence);
  group->require_subcommand(1);
  group->footer("Example:\n  mneme " + example);
  return *group;
}

template <class T>
std::optional<T> parse_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  T number{};
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return number;
}
template std::optional<double> parse_number(std::string_view);
template std::optional<int> parse_number(std::string_view);
template std::optional<std::int64_t> parse_number(std::string_view);
template std::optional<std::uint64_t> parse_number(std::string_view);

std::vector<double> parse_numbers(const std::string& flag, std::string_view text, char separator) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t end = std::min(text.find(separator), text.size());
    const std::string_view item = text.substr(0, end);
    const std::optional<double> number = parse_number<double>(item);
    if (!number) {
      throw CLI::ValidationError(
          flag, fmt::format("item {} is '{}', which is not a number", numbers.size() + 1, item));
    }
    numbers.push_back(*number);
    if (end == text.size()) return numbers;
    text.remove_prefix(end + 1);
  }
}

CLI::Option* add_text(CLI::App& app, const std::string& flag,
                      std::function<void(const std::string&)> read, const std::string& help) {
  const auto callback = [read = std::move(read)](const CLI::results_t& results) {
    read(results.at(0));
    return true;
  };
  return app.add_option(flag, callback, help)->type_name("TEXT");
}

CLI::Option* add_configuration(CLI::App& app, const std::string& flag,
                               std::optional<GivenConfiguration>& given, const std::string& help) {
  const auto read = [flag, &given](const std::string& text) {
    const bool begins_as_name =
        !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) != 0 || text[0] == '_');
    const bool is_name =
        begins_as_name && text.find(',') == std::string::npos && !parse_number<double>(text);
    given = is_name ? GivenConfiguration(text) : parse_numbers(flag, text);
  };
  return add_text(app, flag, read, help)->type_name("X,X,.. or STATE");
}

void add_range(CLI::App& app, const std::string& flag, std::array<double, 2>& range,
               const std::string& help) {
  const auto read = [flag, &range](const std::string& text) {
    const std::vector<double> numbers = parse_numbers(flag, text, ':');
    if (numbers.size() > 2) {
      throw CLI::ValidationError(flag, fmt::format("'{}' is not a range LEAST:MOST", text));
    }
    range = {numbers.front(), numbers.back()};
  };
  add_text(app, flag, read, fmt::format("{} (default {}:{})", help, range[0], range[1]))
      ->type_name("X:X");
}

namespace {

PoseGoal parse_pose(const std::string& flag, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) {
    throw CLI::ValidationError(
        flag, fmt::format("'{}' names no link: expected LINK:X,Y,Z,QX,QY,QZ,QW", text));
  }
  const std::vector<double> v = parse_numbers(flag, std::string_view(text).substr(colon + 1));
  const bool is_finite = std::ranges::all_of(v, [](double x) { return std::isfinite(x); });
  if ((v.size() != 3 && v.size() != 7) || !is_finite) {
    throw CLI::ValidationError(
        flag, fmt::format("'{}' is not 3 finite numbers of a position, or 7 of position and "
                          "quaternion x, y, z, w",
                          text.substr(colon + 1)));
  }
  PoseGoal goal;
  goal.link = text.substr(0, colon);
  goal.pose.translation = Vec3(v[0], v[1], v[2]);
  if (v.size() == 3) {
    goal.cone = goal.turn = std::numbers::pi;
    return goal;
  }
  const auto rotation = rotation_from_unit_quaternion(std::span(v).subspan<3, 4>());
  if (!rotation) {
    throw CLI::ValidationError(flag, fmt::format("'{}': {}", text, rotation.error().message));
  }
  goal.pose.rotation = *rotation;
  return goal;
}

}  // namespace

CLI::Option* add_poses(CLI::App& app, const std::string& flag, std::vector<PoseGoal>& poses,
                       const std::string& help) {
  const auto read = [flag, &poses](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) poses.push_back(parse_pose(flag, text));
  };
  return app.add_option_function<std::vector<std::string>>(flag, read, help)
      ->allow_extra_args(false)
      ->type_name("LINK:X,Y,Z,QX,QY,QZ,QW");
}

CLI::Option* add_part(CLI::App& app, std::string& part) {
  const auto read = [&part](const std::string& text) {
    const std::optional<Part> parsed = parse_part(text);
    if (!parsed || parsed->index == 0) {
      throw CLI::ValidationError(
          "--part",
          fmt::format("'{}' is no part; expected I/N with 1 <= I <= N, such as 1/2", text));
    }
    part = text;
  };
  return add_text(app, "--part", read, "every N-th problem, starting with the I-th, such as 1/2")
      ->type_name("I/N");
}

CLI::Option* add_upright(CLI::App& app, std::vector<OrientationConstraint>& constraints) {
  const auto read = [&constraints](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const std::size_t colon = text.rfind(':');
      const auto angle = colon == std::string::npos
                             ? std::nullopt
                             : parse_number<double>(std::string_view(text).substr(colon + 1));
      if (!angle || colon == 0) {
        throw CLI::ValidationError("--upright",
                                   fmt::format("'{}': expected LINK:ANGLE, in radians", text));
      }
      if (!(*angle >= kLeastTilt && std::isfinite(*angle))) {
        throw CLI::ValidationError(
            "--upright",
            fmt::format("'{}': expected an angle of at least {} radians", text, kLeastTilt));
      }
      constraints.emplace_back().link = text.substr(0, colon);
      constraints.back().angle = *angle;
    }
  };
  return app
      .add_option_function<std::vector<std::string>>(
          "--upright", read,
          "keep the link upright: largest angle between its z axis and that of the scene, radians, "
          "on "
          "the whole path; in addition to the problem's constraints; repeatable")
      ->allow_extra_args(false)
      ->type_name("LINK:ANGLE");
}

CLI::Option* add_choice(CLI::App& app, const std::string& flag, const std::string& what,
                        std::string& value, std::vector<std::string> names,
                        const std::string& help) {
  const std::string list = fmt::format("{}", fmt::join(names, ", "));
  const auto read = [=, &value](const std::string& text) {
    if (std::find(names.begin(), names.end(), text) == names.end()) {
      throw CLI::ValidationError(flag, fmt::format("unknown {} '{}': expected one of {}{}", what,
                                                   text, list, did_you_mean(text, names)));
    }
    value = text;
  };
  return add_text(app, flag, read, fmt::format("{}: {}", help, list))->type_name("NAME");
}

bool SettingsFlags::is_wanted(std::string_view name) const {
  return only_.empty() || std::find(only_.begin(), only_.end(), name) != only_.end();
}

void SettingsFlags::add_switch(std::string_view name, bool& value, std::string_view sentence) {
  app_.add_flag(fmt::format("--{0},!--no-{0}", name), value,
                fmt::format("{} (default {})", sentence, value ? "on" : "off"));
}

void SettingsFlags::add_switch(std::string_view name, std::optional<bool>& value,
                               std::string_view sentence) {
  const auto read = [&value](std::int64_t count) { value = count > 0; };
  app_.add_flag_function(fmt::format("--{0},!--no-{0}", name), read, std::string(sentence))
      ->take_last();
}

void add_memory_settings(CLI::App& app, MemorySettings& settings) {
  std::vector<std::string> names;
  for (const MemoryKind* kind : memory_kinds()) names.emplace_back(kind->name);
  const auto read = [&settings](const std::string& name) {
    const auto kind = find_memory_kind(name);
    if (!kind) throw CLI::ValidationError("--kind", kind.error().message);
    settings.kind = name;
  };
  add_text(app, "--kind", read,
           fmt::format("kind of memory: {} (default: kinds of the database, or by robot)",
                       fmt::join(names, ", ")))
      ->type_name("NAME");
  add_settings(app, settings);
}

void add_isa(CLI::App& app) {
  const auto read = [](const std::string& name) {
    const Result<Isa> isa = parse_isa(name);
    if (!isa) throw CLI::ValidationError("--isa", isa.error().message);
    // The one switch that all kernels follow.
    setenv("MNEME_ISA", name.c_str(), 1);
  };
  add_text(app, "--isa", read,
           "instruction set: scalar, sse, avx2 or avx512; portable finds the same path in browsers")
      ->type_name("NAME");
}

namespace {

/// Reads JOINT=VALUE,..
void read_fixed(std::string_view text, std::map<std::string, double>& values) {
  while (true) {
    const std::size_t end = std::min(text.find(','), text.size());
    const std::string_view item = text.substr(0, end);
    const std::size_t equals = std::min(item.rfind('='), item.size());
    const auto value = parse_number<double>(item.substr(std::min(equals + 1, item.size())));
    if (equals == 0 || !value) {
      throw CLI::ValidationError(
          "--fix", fmt::format("expected JOINT=VALUE such as lift=0.2, got '{}'", item));
    }
    const std::string joint(item.substr(0, equals));
    if (!values.emplace(joint, *value).second) {
      throw CLI::ValidationError("--fix", fmt::format("'{}' has two values", joint));
    }
    if (end == text.size()) return;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

void add_robot_flags(CLI::App& app, RobotOptions& options) {
  app.add_option("--srdf", options.srdf_path,
                 "SRDF file with groups and allowed collisions (default: next to the URDF)");
  app.add_option("--group", options.group,
                 "joints to plan for: a group of the SRDF, or the chain BASE_LINK:TIP_LINK");
  add_text(
      app, "--fix", [&options](const std::string& text) { read_fixed(text, options.fixed_values); },
      "values of joints outside the group, which stay there: lift=0.2,base/x=1,base/theta=0.5 "
      "(planar and floating joints have several values)")
      ->type_name("JOINT=VALUE,..");
  add_reading_flags(app, options);
}

void add_reading_flags(CLI::App& app, RobotOptions& options) {
  app.add_option("--package-path", options.package_paths,
                 "directory of the packages of package:// URLs; repeatable")
      ->allow_extra_args(false)
      ->type_name("DIR");
  app.add_flag("--strict", options.strict,
               "refuse unknown elements and attributes, missing limits and shapes without size in "
               "URDF and SRDF (default: one warning names them)");
  app.add_flag("--hard-limits", options.hard_limits,
               "use the limits of <limit>, not the narrower soft limits of <safety_controller>");
}

CLI::Option* add_database(CLI::App& app, std::string& url, DatabaseSettings& settings,
                          const std::string& help) {
  const auto take = [&url](const std::string& text) {
    // An unset shell variable is no request for a plan without memory.
    if (text.empty()) {
      throw CLI::ValidationError("--db", "expected a file or postgresql://..., got an empty text");
    }
    url = text;
  };
  CLI::Option* const database = add_text(app, "--db", take, help);
  constexpr int kMebibyte = 20;  // as a power of two
  const auto read = [&settings](const std::string& text) {
    settings.memory_bytes = parse_in_range<std::int64_t>("--db-memory", text, 0, 1'000'000)
                            << kMebibyte;
  };
  add_text(
      app, "--db-memory", read,
      fmt::format("MiB of rows to keep in memory; a larger database reads rows when they match "
                  "(default {}; 0 to 1000000)",
                  settings.memory_bytes >> kMebibyte))
      ->type_name("N")
      ->needs(database);
  return database;
}

void add_robot_argument(CLI::App& app, std::string& robot, RobotOptions& options) {
  app.add_option("ROBOT", robot, "URDF file or name of a robot")->required();
  add_robot_flags(app, options);
}

void add_other_robot(CLI::App& app, std::string& robot, RobotOptions& options) {
  app.add_option("--robot", robot, "robot instead of the problem's: URDF file or name");
  add_robot_flags(app, options);
}

void add_problem_list(CLI::App& app, std::vector<std::string>& problems, std::string& part,
                      const std::string& suites) {
  app.add_option("PROBLEMS", problems,
                 "compact files, problems (YAML, FILE.json#NAME) or directories of them" + suites)
      ->required();
  add_part(app, part);
}

void add_scene_argument(CLI::App& app, std::string& scene) {
  app.add_option("SCENE", scene, "scene or problem: YAML file, or FILE.json#NAME")->required();
}

void add_seed(CLI::App& app, std::uint64_t& seed, const std::string& help) {
  add_number(app, "--seed", seed, 0, ~std::uint64_t{0}, help);
}

void add_json(CLI::App& app, bool& is_json) {
  app.add_flag("--json", is_json, "print the result as JSON");
}

void add_jobs(CLI::App& app, int& jobs) {
  jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  add_number(app, "--jobs", jobs, 1, 4096, "threads");
}

void begin_rare_flags(CLI::App& command, const std::string& heading) {
  command.option_defaults()->group(fmt::format("{}{}", heading, kMore));
}

void show_flags(CLI::App& command, const std::vector<FlagGroup>& groups) {
  for (const auto& [heading, flags] : groups) {
    for (const std::string& flag : flags) command.get_option("--" + flag)->group(heading);
  }
}

std::shared_ptr<CLI::Formatter> make_help_formatter() {
  auto formatter = std::make_shared<WrappingFormatter>();
  formatter->column_width(kFlagColumn);
  return formatter;
}

}  // namespace mneme::app
