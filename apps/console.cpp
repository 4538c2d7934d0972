// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "console.h"

#include <fmt/format.h>

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <set>

namespace mneme::app {
namespace {

constexpr double kBarInterval = 0.1;
constexpr double kLineInterval = 5;
constexpr int kBarWidth = 24;

bool has_colour() {
  const char* no_colour = std::getenv("NO_COLOR");
  return has_terminal() && (no_colour == nullptr || *no_colour == '\0');
}

std::string coloured(std::string_view text, std::string_view code) {
  return has_colour() ? fmt::format("\033[{}m{}\033[0m", code, text) : std::string(text);
}

std::string format_duration(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

std::string bar(double fraction) {
  const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kBarWidth);
  std::string cells(static_cast<std::size_t>(filled), '#');
  cells = coloured(cells, "32");
  return "[" + cells + std::string(static_cast<std::size_t>(kBarWidth - filled), '.') + "]";
}

std::atomic<bool> is_interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers need a lock-free flag");

extern "C" void remember_interrupt(int) { is_interrupted = true; }

}  // namespace

bool has_terminal() {
  const char* type = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && type != nullptr && std::string_view(type) != "dumb";
}

std::string printable(std::string_view text) {
  std::string shown;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    // U+0080 to U+009F are control characters too, in UTF-8 two bytes.
    const bool is_pair = byte == 0xc2 && next >= 0x80 && next < 0xa0;
    if (is_pair) shown += fmt::format("\\x{:02x}", text[i++] & 0xff);
    if (is_pair || byte < 0x20 || byte == 0x7f) {
      shown += fmt::format("\\x{:02x}", text[i] & 0xff);
    } else {
      shown += text[i];
    }
  }
  return shown;
}

void print_error(std::string_view message) {
  fmt::print(stderr, "mneme: {} {}\n", coloured("error:", "1;31"), printable(message));
}

void print_note(std::string_view message) { fmt::print(stderr, "mneme: {}\n", printable(message)); }

void print_warning(const std::string& message) {
  static std::set<std::string> printed;
  if (printed.insert(message).second) print_note("warning: " + message);
}

void print_preparation(double time_s) {
  constexpr double kNotable_s = 1e-3;
  if (time_s > kNotable_s) fmt::print("preparation {:.3f} ms for the scene\n", 1e3 * time_s);
}

void print_json(const nlohmann::ordered_json& json) {
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

Progress::Progress(std::string label) : label_(std::move(label)), is_terminal_(has_terminal()) {}

Progress::~Progress() {
  if (has_bar_) fmt::print(stderr, "\r\033[K");
}

void Progress::update(std::int64_t done, std::int64_t total, std::string_view detail) {
  if (done_at_start_ < 0) done_at_start_ = done;
  if (since_shown_.elapsed_s() < (is_terminal_ ? kBarInterval : kLineInterval)) return;
  since_shown_ = {};

  const double elapsed = since_start_.elapsed_s();
  const double rate = static_cast<double>(done - done_at_start_) / std::max(elapsed, 1e-9);
  const std::string left =
      rate > 0 ? format_duration(static_cast<double>(total - done) / rate) + " left" : "";
  std::string line = fmt::format("{} of {}, {:.3g}/s", done, total, rate);
  for (const std::string_view part : {std::string_view(left), detail}) {
    if (!part.empty()) line.append(", ").append(part);
  }
  if (is_terminal_) {
    const double fraction = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 0;
    fmt::print(stderr, "\r\033[K{} {} {}", label_, bar(fraction), line);
    std::fflush(stderr);
    has_bar_ = true;
  } else {
    print_note(fmt::format("{}: {}", label_, line));
  }
}

const std::atomic<bool>* interrupt_flag() {
  static std::once_flag is_caught;
  std::call_once(is_caught, [] {
    struct sigaction handler = {};
    handler.sa_handler = remember_interrupt;
    handler.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
    sigaction(SIGINT, &handler, nullptr);
    sigaction(SIGTERM, &handler, nullptr);
  });
  return &is_interrupted;
}

void note_interrupted(std::string_view what) {
  if (!is_interrupted) return;
  print_note(
      fmt::format("interrupted: {} is the best found so far, proven free like any other", what));
}

}  // namespace mneme::app
