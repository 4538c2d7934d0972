// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/benchmark.h"

#include <fmt/chrono.h>
#include <sys/utsname.h>

#include <chrono>
#include <fstream>
#include <thread>

namespace mneme {
namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t value = line.find(": ");
    if (line.starts_with("model name") && value != std::string::npos) return line.substr(value + 2);
  }
  return "unknown processor";
}

std::string compiler() {
#ifdef __clang__
  return fmt::format("clang++ {}.{}", __clang_major__, __clang_minor__);
#else
  return fmt::format("g++ {}.{}", __GNUC__, __GNUC_MINOR__);
#endif
}

}  // namespace

std::string describe_machine() {
  utsname system{};
  uname(&system);
  return fmt::format("{}, {} hardware threads, {} {}", processor(),
                     std::thread::hardware_concurrency(), system.sysname, system.release);
}

std::string describe_build() { return fmt::format("mneme {}, {}", version(), compiler()); }

std::string current_time() {
  const auto now = std::chrono::system_clock::now();
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
}

}  // namespace mneme
