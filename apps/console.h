// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Progress and interrupts, which are Control-C and SIGTERM. Progress is written to standard error;
/// results go to standard output. The first interrupt lets a command end in order; a second one of
/// the same kind ends the program at once.
#pragma once

#include "mneme/base.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace mneme::app {

void print_error(std::string_view message);
void print_note(std::string_view message);
/// A note "warning: ...", unless it was printed before: many problems share a robot or a scene.
void print_warning(const std::string& message);
/// Prints to standard output what making the collision checker took, unless it is less than 1 ms.
void print_preparation(double time_s);
/// True if standard error is a terminal that understands control sequences.
[[nodiscard]] bool has_terminal();
/// `text` with control characters as \x1b: names come from files that others wrote, and a terminal
/// obeys.
[[nodiscard]] std::string printable(std::string_view text);
/// Prints to standard output; text that is not UTF-8, such as a file's name, has its bad bytes
/// replaced.
void print_json(const nlohmann::ordered_json& json);

/// "1 match", "2 matches".
template <std::integral Count>
[[nodiscard]] std::string counted(Count count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// Progress of a long task: a bar on a terminal, otherwise a line about every five seconds. Not
/// thread-safe.
class Progress {
 public:
  explicit Progress(std::string label);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Removes the bar.
  ~Progress();

  /// Shows that `done` of `total` units are done; `detail` is free text. Cheap to call often.
  void update(std::int64_t done, std::int64_t total, std::string_view detail = "");

 private:
  std::string label_;
  bool is_terminal_;
  bool has_bar_ = false;
  Stopwatch since_start_, since_shown_;
  std::int64_t done_at_start_ = -1;
};

/// Becomes true at the first interrupt that comes after the first call; until then an interrupt
/// ends the program.
[[nodiscard]] const std::atomic<bool>* interrupt_flag();
/// If there was an interrupt, notes that `what`, such as "the path", is the best found until then.
void note_interrupted(std::string_view what);

}  // namespace mneme::app
