// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"
#include "mneme/baselines.h"

#include "base/files.h"
#include "pipeline/settings_input.h"
#include "input/input.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace mneme {
namespace {

using internal::Input;
using internal::SettingsReader;
using internal::visit_all_settings;
namespace fs = std::filesystem;

/// A list of texts, or a single one.
std::vector<std::string> read_texts(const Input& input) {
  if (!input.is_list()) return {input.text()};
  std::vector<std::string> texts;
  for (const Input& item : input.items()) texts.push_back(item.text());
  if (texts.empty()) input.fail_expecting("at least one name");
  return texts;
}

/// Names that `find` knows, or that this build lacks: a suite skips those.
template <class Find>
std::vector<std::string> read_names(const Input& input, const Find& find) {
  std::vector<std::string> names = read_texts(input);
  for (const std::string& name : names) {
    const auto entry = find(name);
    if (entry || entry.error().code == ErrorCode::unsupported) continue;
    input.fail(ErrorCode::parse, entry.error().message);
  }
  return names;
}

Result<void> find_planner_or_rival(std::string_view name) {
  if (find_rival(name) != nullptr) return {};
  const auto planner = find_planner(name);
  return planner ? Result<void>() : tl::unexpected(planner.error());
}

/// True for names of files without a directory.
bool is_file_name(std::string_view name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string_view::npos;
}

template <class T>
void read_number(const Input& map, std::string_view key, T& value, double least, double most) {
  const SettingsReader reader(map);
  reader(key, value, static_cast<T>(least), static_cast<T>(most), "");
}

class SuiteReader {
 public:
  explicit SuiteReader(fs::path path) : path_(std::move(path)) {}

  Suite read(const Input& root) {
    root.allow_keys({"problems", "planners", "samplers", "seeds", "first-seed", "timeout",
                     "memories", "settings"});
    Suite suite;
    suite.name = path_.stem().string();
    suite.problems = read_problems(root.at("problems"));
    read_number(root, "seeds", suite.seed_count, 1, 1e6);
    read_number(root, "first-seed", suite.first_seed, 0, 1e15);
    if (const auto memories = root.find("memories")) {
      for (const auto& [name, memory] : memories->entries()) {
        suite.memories.push_back(read_memory(name, memory));
      }
    }
    read_settings(root, suite);
    return suite;
  }

 private:
  /// The text with each `${NAME}` replaced by the environment variable.
  [[nodiscard]] static std::string expand(const Input& input) {
    std::string text = input.text();
    for (std::size_t begin = text.find("${"); begin != std::string::npos;) {
      const std::size_t end = text.find('}', begin);
      if (end == std::string::npos) break;
      const std::string name = text.substr(begin + 2, end - begin - 2);
      const char* value = std::getenv(name.c_str());
      if (value == nullptr) {
        input.fail(ErrorCode::io, "the environment variable {} is not set", name);
      }
      const std::string_view found = value;
      text.replace(begin, end - begin + 1, found);
      begin = text.find("${", begin + found.size());
    }
    return text;
  }

  /// A path relative to the suite.
  [[nodiscard]] std::string resolve(const Input& input) const {
    return (path_.parent_path() / expand(input)).lexically_normal().string();
  }

  SuiteProblems read_entry(const Input& input) const {
    if (!input.is_map()) return {resolve(input), "", ""};
    input.allow_keys({"file", "set", "part", "robot", "srdf"});
    SuiteProblems problems{resolve(input.at("file")), "", ""};
    if (const auto set = input.find("set")) problems.set = set->text();
    if (const auto part = input.find("part")) problems.part = expand(*part);
    if (const auto robot = input.find("robot")) problems.robot = resolve(*robot);
    if (const auto srdf = input.find("srdf")) problems.srdf = resolve(*srdf);
    return problems;
  }

  [[nodiscard]] std::vector<SuiteProblems> read_problems(const Input& input) const {
    std::vector<SuiteProblems> problems;
    for (const Input& item : input.items()) problems.push_back(read_entry(item));
    if (problems.empty()) input.fail_expecting("at least one file");
    return problems;
  }

  [[nodiscard]] SuiteMemory read_memory(const std::string& name, const Input& input) const {
    std::vector<std::string_view> keys;
    SuiteMemory memory;
    visit_settings(memory.learn, [&](std::string_view key, auto&, auto, auto, std::string_view) {
      keys.push_back(key);
    });
    keys.insert(keys.end(), {"file", "robot", "primitives", "count", "problems", "kind", "paths",
                             "path-timeout", "seed"});
    input.allow_keys(keys);
    if (!is_file_name(name)) {
      input.fail(ErrorCode::parse, "expected a name that a file can have, got \"{}\"", name);
    }
    memory.name = name;
    const int sources = (input.find("file") ? 1 : 0) + (input.find("primitives") ? 1 : 0) +
                        (input.find("problems") ? 1 : 0);
    if (sources != 1) input.fail_expecting("one of the keys file, primitives and problems");
    if (const auto file = input.find("file")) memory.file = resolve(*file);
    if (const auto grid = input.find("primitives")) {
      memory.primitives = resolve(*grid);
      memory.robot = input.at("robot").text();
    }
    if (const auto problems = input.find("problems")) memory.problems = read_problems(*problems);
    if (const auto kind = input.find("kind")) {
      memory.kind = kind->text();
      if (const auto known = find_memory_kind(*memory.kind); !known) {
        kind->fail(ErrorCode::parse, known.error().message);
      }
    }
    if (input.find("count")) read_number(input, "count", memory.count.emplace(), 0, 1e8);
    read_number(input, "paths", memory.paths, 1, 1000);
    read_number(input, "path-timeout", memory.path_timeout_s, 0, 1e6);
    read_number(input, "seed", memory.seed, 0, 1e15);
    visit_settings(memory.learn, SettingsReader(input));
    return memory;
  }

  void read_settings(const Input& root, Suite& suite) const {
    SuiteSetting common;
    common.planners = {"rrt_connect"};
    common.samplers = {"gl", "uniform"};
    read_common(root, common);
    const auto settings = root.find("settings");
    if (!settings) {
      check_memory(root, suite, common);
      suite.settings.push_back(std::move(common));
      return;
    }
    for (const auto& [name, input] : settings->entries()) {
      suite.settings.push_back(read_setting(name, input, common));
      check_memory(input, suite, suite.settings.back());
    }
    if (suite.settings.empty()) settings->fail_expecting("at least one setting");
  }

  void read_common(const Input& map, SuiteSetting& setting) const {
    if (const auto planners = map.find("planners")) {
      setting.planners = read_names(*planners, find_planner_or_rival);
    }
    if (const auto samplers = map.find("samplers")) {
      // Samplers of planners that this build lacks are unknown, too.
      const bool is_known = std::ranges::any_of(setting.planners, [](const std::string& planner) {
        return find_planner_or_rival(planner).has_value();
      });
      setting.samplers = is_known ? read_names(*samplers, find_sampler) : read_texts(*samplers);
    }
    read_number(map, "timeout", setting.solve.plan.timeout_s, 0, 1e6);
  }

  [[nodiscard]] SuiteSetting read_setting(const std::string& name, const Input& input,
                                          SuiteSetting setting) const {
    setting.name = name;
    if (input.is_nothing()) return setting;
    std::vector<std::string_view> keys;
    visit_all_settings(setting.solve,
                       [&](std::string_view key, auto&, auto, auto, std::string_view) {
                         if (key != "seed") keys.push_back(key);
                       });
    keys.insert(keys.end(), {"memory", "planners", "samplers", "sets"});
    input.allow_keys(keys);
    read_common(input, setting);
    visit_all_settings(setting.solve, SettingsReader(input));
    if (const auto memory = input.find("memory")) setting.memory = memory->text();
    // A suite says what it measures: settings without replay sample from memory, unless they
    // remember, too.
    if (!setting.memory.empty() && !setting.solve.replay && !setting.solve.remember_after) {
      setting.solve.replay = 0;
    }
    if (const auto sets = input.find("sets")) setting.sets = read_texts(*sets);
    return setting;
  }

  static void check_memory(const Input& input, const Suite& suite, const SuiteSetting& setting) {
    const auto drawing = std::ranges::find_if(setting.samplers, needs_memory);
    if (setting.memory.empty() && drawing == setting.samplers.end()) return;
    if (setting.memory.empty()) {
      input.fail(ErrorCode::parse, "the sampler {} needs the key memory in its setting", *drawing);
    }
    if (std::ranges::find(suite.memories, setting.memory, &SuiteMemory::name) ==
        suite.memories.end()) {
      input.fail(ErrorCode::parse, "key memory: there is no memory \"{}\"", setting.memory);
    }
  }

  fs::path path_;
};

}  // namespace

bool needs_memory(std::string_view sampler) {
  const auto entry = find_sampler(sampler);
  return entry && (*entry)->uses_memory;
}

Result<Suite> load_suite(const std::string& path) {
  return internal::without_throwing([&] {
    const std::string text = internal::value_or_throw(internal::read_text_file(path));
    const internal::InputValue value = internal::parse_yaml(text, path);
    return SuiteReader(path).read(Input(value, path));
  });
}

}  // namespace mneme
