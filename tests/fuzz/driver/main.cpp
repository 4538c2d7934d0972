// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// Stands in for libFuzzer in builds without it: gives a target its seeds and then random changes of
// them, in a process of its own, so that whatever ends it leaves the input behind. Takes
// libFuzzer's -runs, -seed, -timeout, -rss_limit_mb, -max_len, -max_total_time, -dict and
// -artifact_prefix; other flags are ignored. It does not see what the target's code does with an
// input.

#include "fuzz/driver/material.h"
#include "fuzz/fuzz_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <type_traits>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mneme::fuzz {
namespace {

using Clock = std::chrono::steady_clock;

struct Limits {
  std::uint64_t runs = 2000;
  std::uint64_t seed = 1;
  unsigned timeout_s = 5;
  long memory_mb = 2048;
  double total_time_s = std::numeric_limits<double>::infinity();
};

struct Arguments {
  std::map<std::string, std::string> flags;
  std::vector<std::string> paths;

  [[nodiscard]] double number(const std::string& flag) const {
    return std::strtod(flags.at(flag).c_str(), nullptr);
  }
};

Arguments read_arguments(int count, char** arguments) {
  Arguments read;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    const std::size_t equals = argument.find('=');
    if (argument.front() != '-') {
      read.paths.push_back(argument);
    } else if (equals != std::string::npos) {
      read.flags[argument.substr(1, equals - 1)] = argument.substr(equals + 1);
    }
  }
  return read;
}

Limits limits_of(const Arguments& arguments) {
  Limits limits;
  if (arguments.flags.contains("max_total_time")) {
    limits.total_time_s = arguments.number("max_total_time");
    limits.runs = std::numeric_limits<std::uint64_t>::max();
  }
  const auto read = [&](const std::string& flag, auto& limit) {
    if (!arguments.flags.contains(flag)) return;
    limit = static_cast<std::remove_reference_t<decltype(limit)>>(arguments.number(flag));
  };
  read("runs", limits.runs);
  read("seed", limits.seed);
  read("timeout", limits.timeout_s);
  read("rss_limit_mb", limits.memory_mb);
  return limits;
}

/// Memory that the two processes share.
struct Board {
  std::uint64_t runs = 0;  ///< the last one may not have ended
  bool has_ended = false;
  double slowest_s = 0;
  std::size_t size = 0;
  char input[1];  ///< as many as an input may have

  static Board* make(std::size_t max_length) {
    void* memory = ::mmap(nullptr, sizeof(Board) + max_length, PROT_READ | PROT_WRITE,
                          MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED ? nullptr : new (memory) Board;
  }
};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

long peak_memory_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

bool run(const std::string& input, const Limits& limits, Board& board) {
  ++board.runs;
  board.size = input.size();
  std::memcpy(board.input, input.data(), input.size());
  // A buffer of just this size lets sanitizers see what reads beyond it.
  const auto exact = std::make_unique<std::uint8_t[]>(input.size());
  std::memcpy(exact.get(), input.data(), input.size());
  const auto begin = Clock::now();
  ::alarm(limits.timeout_s);
  LLVMFuzzerTestOneInput(exact.get(), input.size());
  ::alarm(0);
  board.slowest_s = std::max(board.slowest_s, seconds_since(begin));
  if (peak_memory_mb() <= limits.memory_mb) return true;
  fmt::print(stderr, "more than {} MiB were needed\n", limits.memory_mb);
  return false;
}

/// In the process that may die.
int run_all(const Material& material, const Limits& limits, Board& board) {
  const auto begin = Clock::now();
  Rng rng(limits.seed);
  for (const std::string& seed : material.seeds) {
    if (seed.size() <= material.max_length && !run(seed, limits, board)) return EXIT_FAILURE;
  }
  while (board.runs < limits.runs && seconds_since(begin) < limits.total_time_s) {
    if (!run(mutated(material, rng), limits, board)) return EXIT_FAILURE;
  }
  board.has_ended = true;
  return EXIT_SUCCESS;
}

std::string describe_end(int status, const Limits& limits) {
  if (!WIFSIGNALED(status)) return fmt::format("exit code {}", WEXITSTATUS(status));
  if (WTERMSIG(status) == SIGALRM) return fmt::format("more than {} s", limits.timeout_s);
  return ::strsignal(WTERMSIG(status));
}

int report(int status, const Board& board, const Limits& limits, const std::string& prefix) {
  const bool is_fine = WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS;
  fmt::print("{} runs with seed {}, the slowest took {:.0f} ms\n", board.runs, limits.seed,
             board.slowest_s * 1e3);
  if (is_fine) return EXIT_SUCCESS;
  if (board.has_ended) {
    fmt::print("FAILED after the last run: {}\n", describe_end(status, limits));
    return EXIT_FAILURE;
  }
  const std::string path = fmt::format("{}failed-{}-{}", prefix, limits.seed, board.runs);
  std::ofstream(path, std::ios::binary)
      .write(board.input, static_cast<std::streamsize>(board.size));
  fmt::print("FAILED: {}; the input is in {}\n", describe_end(status, limits), path);
  return EXIT_FAILURE;
}

Result<Material> read_material(const Arguments& arguments) {
  Material material;
  if (arguments.flags.contains("max_len")) {
    material.max_length = static_cast<std::size_t>(arguments.number("max_len"));
  }
  auto seeds = read_seeds(arguments.paths);
  if (!seeds) return tl::unexpected(seeds.error());
  material.seeds = *std::move(seeds);
  if (!arguments.flags.contains("dict")) return material;
  auto words = read_dictionary(arguments.flags.at("dict"));
  if (!words) return tl::unexpected(words.error());
  material.words = *std::move(words);
  return material;
}

int drive(const Arguments& arguments) {
  const Limits limits = limits_of(arguments);
  const auto material = read_material(arguments);
  if (!material) {
    fmt::print(stderr, "{}\n", material.error().message);
    return EXIT_FAILURE;
  }
  Board* board = Board::make(material->max_length);
  const pid_t child = board == nullptr ? -1 : ::fork();
  if (child < 0) {
    std::perror("fuzz");
    return EXIT_FAILURE;
  }
  if (child == 0) return run_all(*material, limits, *board);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  const auto prefix = arguments.flags.find("artifact_prefix");
  return report(status, *board, limits,
                prefix == arguments.flags.end() ? std::string() : prefix->second);
}

}  // namespace
}  // namespace mneme::fuzz

int main(int count, char** arguments) {
  return mneme::fuzz::drive(mneme::fuzz::read_arguments(count, arguments));
}
