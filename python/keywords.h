// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Settings as keyword arguments, from the declarations of the command-line flags.
#pragma once

#include "mneme/pipeline.h"

#include "errors.h"

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <concepts>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mneme::python {

namespace py = pybind11;

/// Returns the keyword of a flag: "max-gap" becomes max_gap, "lambda" becomes lambda_.
[[nodiscard]] std::string keyword_of(std::string_view flag);

/// The keyword arguments of a call, which settings structs take their values from.
class Keywords {
 public:
  /// `function`: the name of the call in messages.
  Keywords(std::string function, const py::kwargs& arguments)
      : function_(std::move(function)), arguments_(arguments) {}

  /// Assigns the keywords that `settings` declares. Raises TypeError for a wrong type, and
  /// mneme.Error for a value out of range.
  template <class Settings>
  void apply(Settings& settings) {
    visit_settings(settings, [this](std::string_view flag, auto& value, auto least, auto most,
                                    std::string_view) {
      using Setting = std::remove_reference_t<decltype(value)>;
      using Value = SettingValue<Setting>;
      const std::string keyword = keyword_of(flag);
      known_.push_back(keyword);
      if (!arguments_.contains(keyword)) return;
      const py::object given = arguments_[keyword.c_str()];
      if constexpr (SettingTraits<Setting>::kIsOptional) {
        value.reset();
        if (given.is_none()) return;
        read(keyword, given, value.emplace(), static_cast<Value>(least), static_cast<Value>(most));
      } else {
        read(keyword, given, value, static_cast<Value>(least), static_cast<Value>(most));
      }
    });
  }
  /// As apply(), with the keyword kind.
  void apply_memory(MemorySettings& settings);
  /// Assigns the keyword memory: "auto", "off" or "paper".
  void apply_memory_mode(MemoryMode& mode);
  /// Raises TypeError if a keyword belongs to none of the settings.
  void finish() const;

 private:
  void read(const std::string& keyword, const py::object& given, bool& value, bool, bool) const;
  void read(const std::string& keyword, const py::object& given, double& value, double least,
            double most) const;
  template <std::integral Integer>
  void read(const std::string& keyword, const py::object& given, Integer& value, Integer least,
            Integer most) const {
    const py::object number = whole_number(keyword, given);
    if (number > py::int_(most)) {
      fail_range(keyword, given, fmt::format("{} to {}", least, most));
    }
    if (number < py::int_(least)) fail_range(keyword, given, describe(least, most));
    value = number.cast<Integer>();
  }

  template <class T>
  static std::string describe(T least, T most) {
    return most == std::numeric_limits<T>::max() ? fmt::format("{} or more", least)
                                                 : fmt::format("{} to {}", least, most);
  }
  [[nodiscard]] py::object whole_number(const std::string& keyword, const py::object& given) const;
  [[noreturn]] void fail_type(const std::string& keyword, const py::object& given,
                              std::string_view expected) const;
  [[noreturn]] void fail_range(const std::string& keyword, const py::object& given,
                               const std::string& range) const;

  std::string function_;
  py::kwargs arguments_;
  std::vector<std::string> known_;
};

/// Reads the settings of a call that has no other keywords. `function`: its name in messages.
/// Raises TypeError for an unknown keyword.
template <class Settings>
[[nodiscard]] Settings read_keywords(const std::string& function, const py::kwargs& arguments,
                                     Settings settings = {}) {
  Keywords keywords(function, arguments);
  keywords.apply(settings);
  keywords.finish();
  return settings;
}

/// As read_keywords(), for the keywords of these settings alone, which it takes out of `arguments`.
template <class Settings>
[[nodiscard]] Settings take_keywords(const std::string& function, py::kwargs& arguments) {
  py::kwargs own;
  const Settings defaults;
  visit_settings(defaults, [&](std::string_view flag, const auto&, auto, auto, std::string_view) {
    const py::str keyword(keyword_of(flag));
    if (arguments.contains(keyword)) own[keyword] = arguments.attr("pop")(keyword);
  });
  return read_keywords<Settings>(function, own);
}

/// Reads the settings of plan(). `function`: the name of the call in messages. Raises TypeError for
/// an unknown keyword.
[[nodiscard]] SolveSettings read_solve_settings(const std::string& function,
                                                const std::string& planner,
                                                const std::string& sampler, const std::string& isa,
                                                const py::kwargs& arguments);

/// Returns the docstring of settings: keyword, default, range and meaning.
template <class Settings>
[[nodiscard]] std::string describe_keywords() {
  Settings defaults;
  std::string text;
  visit_settings(defaults, [&](std::string_view flag, auto& value, auto least, auto most,
                               std::string_view sentence) {
    using Setting = std::remove_reference_t<decltype(value)>;
    using Value = SettingValue<Setting>;
    text += fmt::format("{}: {}", keyword_of(flag),
                        std::same_as<Value, bool> ? "bool"
                        : std::integral<Value>    ? "int"
                                                  : "float");
    if constexpr (SettingTraits<Setting>::kIsOptional) {
      text += " = None";
      if constexpr (!std::same_as<Value, bool>) {
        text += fmt::format(", {} to {}", static_cast<Value>(least), static_cast<Value>(most));
      }
    } else if constexpr (std::same_as<Value, bool>) {
      text += fmt::format(" = {}", value ? "True" : "False");
    } else if (static_cast<Value>(most) == std::numeric_limits<Value>::max()) {
      text += fmt::format(" = {}, {} or more", value, static_cast<Value>(least));
    } else {
      text += fmt::format(" = {}, {} to {}", value, static_cast<Value>(least),
                          static_cast<Value>(most));
    }
    text += fmt::format("\n    {}\n", sentence);
  });
  return text;
}

/// As describe_keywords(), for the settings of memory.
[[nodiscard]] std::string describe_memory_keywords();

}  // namespace mneme::python
