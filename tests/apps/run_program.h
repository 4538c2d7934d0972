// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Runs the program as a user would, and keeps what it printed.
#pragma once

#include "support/support.h"

#include <doctest/doctest.h>

#include <cstdio>
#include <string>
#include <vector>
#include <fcntl.h>
#include <linux/capability.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mneme::test {

struct ProgramRun {
  int exit_code = -1;  ///< 128 + signal if it was killed
  std::string out;
  std::string err;
};

/// How the program's process differs from the test's.
struct ProcessChanges {
  std::vector<std::string> environment;  ///< NAME=VALUE
  bool is_powerless = false;             ///< permissions of files bind it, also as root
  std::size_t memory_bytes = 0;          ///< most of its address space; 0: no limit
};

/// Permissions of files bind root, too, in the program that this process becomes. Another user
/// instead might not be allowed to enter the directory that the tree lies in.
inline bool give_up_power_over_files() {
  if (geteuid() != 0) return true;
  return prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE) == 0 &&
         prctl(PR_CAPBSET_DROP, CAP_DAC_READ_SEARCH) == 0;
}

/// A program that runs beside the test.
class RunningProgram {
 public:
  explicit RunningProgram(const std::vector<std::string>& arguments,
                          const ProcessChanges& changes = {}) {
    REQUIRE(pipe2(err_, O_CLOEXEC) == 0);
    process_ = fork();
    REQUIRE(process_ >= 0);
    if (process_ == 0) become_program(arguments, changes);
    close(err_[1]);
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  ~RunningProgram() {
    if (process_ > 0) wait();
    close(err_[0]);
  }

  /// Blocks until a piece of its standard error has come.
  std::string read_err() {
    char buffer[4096];
    const ssize_t size = read(err_[0], buffer, sizeof buffer);
    return {buffer, static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
  }
  void send(int signal_number) const { kill(process_, signal_number); }

  ProgramRun wait() {
    ProgramRun run;
    for (std::string piece = read_err(); !piece.empty(); piece = read_err()) run.err += piece;
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    run.out = read_file(out_path());
    return run;
  }

 private:
  [[nodiscard]] std::string out_path() const { return files_ / "out"; }

  [[noreturn]] void become_program(const std::vector<std::string>& arguments,
                                   const ProcessChanges& changes) {
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(open(out_path().c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    dup2(err_[1], STDERR_FILENO);
    for (const std::string& entry : changes.environment) {
      const std::size_t end = entry.find('=');
      setenv(entry.substr(0, end).c_str(), entry.substr(end + 1).c_str(), 1);
    }
    if (changes.is_powerless && !give_up_power_over_files()) _exit(126);
    const rlimit memory{changes.memory_bytes, changes.memory_bytes};
    if (changes.memory_bytes > 0 && setrlimit(RLIMIT_AS, &memory) != 0) _exit(126);
    std::vector<char*> list{const_cast<char*>(MNEME_PROGRAM)};
    for (const std::string& argument : arguments) {
      list.push_back(const_cast<char*>(argument.c_str()));
    }
    list.push_back(nullptr);
    execv(MNEME_PROGRAM, list.data());
    _exit(127);
  }

  TemporaryDirectory files_;
  int err_[2] = {-1, -1};
  pid_t process_ = -1;
};

inline ProgramRun run_program(const std::vector<std::string>& arguments,
                              const ProcessChanges& changes = {}) {
  return RunningProgram(arguments, changes).wait();
}

/// Runs the program. Unless it succeeds, the test ends with what was printed. `file` and `line`:
/// the caller's.
inline ProgramRun require_run(const std::vector<std::string>& arguments,
                              const ProcessChanges& changes = {},
                              const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  ProgramRun run = run_program(arguments, changes);
  if (run.exit_code != 0) ADD_FAIL_AT(file, line, (run.out + run.err));
  return run;
}

/// A wrong command line, and what the user is told.
struct BadInput {
  std::vector<std::string> arguments;
  int exit_code = 0;
  std::vector<std::string> fragments;  ///< of the message
};

inline void check_bad_inputs(const std::vector<BadInput>& inputs) {
  for (const BadInput& input : inputs) {
    std::string line = "mneme";
    for (const std::string& argument : input.arguments) line += " " + argument;
    const ProgramRun run = run_program(input.arguments);
    INFO(line << "\nstandard error: " << run.err);
    CHECK(run.exit_code == input.exit_code);
    CHECK(contains(run.err, "mneme: error: "));
    for (const std::string& fragment : input.fragments) {
      CHECK_MESSAGE(contains(run.err, fragment), "expected the words: " << fragment);
    }
  }
}

}  // namespace mneme::test
