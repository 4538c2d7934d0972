// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme serve: plans for many clients over HTTP.
#include "commands.h"

#ifdef MNEME_WITH_SERVICE
#include "mneme/service.h"

#include "console.h"
#include "mneme/report.h"
#include "inputs.h"
#include "options.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <pthread.h>

namespace mneme::app {
namespace {

constexpr std::size_t kMostTokenBytes = 4096;
constexpr int kMebibyte = 20;  // as a power of two
constexpr std::chrono::milliseconds kMostStop{
    700};  // the end itself takes up to 0.3 s on a busy machine
/// Below the period of refreshing, so that GET /healthz says within 2 s that a server hangs.
constexpr double kServerTimeout_s = 0.8;

struct ServeOptions {
  std::string robot;
  RobotOptions robot_options;
  std::string db;
  DatabaseSettings kept;
  std::string problem;
  std::vector<std::string> cells;
  std::string token_file;
  int body_mib = 16;
  ServiceSettings service;
};

/// The file's first line. An empty one is an error: it would admit everybody. So is one that no
/// client could send: with control characters, or a space at its end, which headers lose.
Result<std::string> read_token(const std::string& path) {
  if (path.empty()) return "";
  const auto text = MNEME_TRY(read_file(path, kMostTokenBytes));
  std::string token = text.substr(0, text.find('\n'));
  if (token.ends_with('\r')) token.pop_back();
  if (token.empty()) {
    return fail(ErrorCode::invalid, fmt::format("'{}': expected a token in its first line", path));
  }
  const auto bad = std::ranges::find_if(token, [&](const char& c) {
    return std::iscntrl(static_cast<unsigned char>(c)) != 0 || (c == ' ' && &c == &token.back());
  });
  if (bad != token.end()) {
    return fail(ErrorCode::invalid,
                fmt::format("'{}': expected a token that a header can hold in its first line, got "
                            "the byte {:#04x} at position {}",
                            path, static_cast<unsigned char>(*bad), bad - token.begin()));
  }
  return token;
}

Result<std::shared_ptr<Database>> open_database(const ServeOptions& options, const Robot& robot) {
  if (options.db.empty()) return std::shared_ptr<Database>();
  SolveSettings settings;
  settings.remember_after = options.service.remember_after;
  DatabaseSettings kept = options.kept;
  kept.answer_timeout_s = kServerTimeout_s;
  return open_memory(options.db, robot, settings, kept).map([](Database database) {
    return std::make_shared<Database>(std::move(database));
  });
}

/// The report of rows that are lost when the process ends, made once. Thread-safe.
class LastReport {
 public:
  explicit LastReport(const std::shared_ptr<const Database>& database) : database_(database) {}
  /// Reports rows that are not stored, unless that was done. Returns the process's exit code.
  ExitCode make() {
    const std::lock_guard lock(mutex_);
    if (code_) return *code_;
    const auto database = database_.lock();
    const std::string lost = database == nullptr ? "" : describe_lost_rows(database->queued_rows());
    if (!lost.empty()) print_note(lost);
    code_ = lost.empty() ? ExitCode::done : ExitCode::failure;
    return *code_;
  }

 private:
  std::weak_ptr<const Database> database_;
  std::mutex mutex_;
  std::optional<ExitCode> code_;
};

/// Waits for SIGTERM or Control-C in a thread of its own, from construction on. After a signal the
/// process ends within kMostStop, whatever still runs, and reports the rows that it loses. A second
/// signal ends it at once.
class StopSignal {
 public:
  explicit StopSignal(std::shared_ptr<LastReport> report) {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGINT);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::thread([signals, arrived = arrived_, last_report = std::move(report)] {
      int number = 0;
      sigwait(&signals, &number);
      pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
      arrived->test_and_set();
      arrived->notify_all();
      std::this_thread::sleep_for(kMostStop);
      std::_Exit(static_cast<int>(last_report->make()));
    }).detach();
  }
  void wait() { arrived_->wait(false); }

 private:
  std::shared_ptr<std::atomic_flag> arrived_ = std::make_shared<std::atomic_flag>();
};

/// The first problem of the page; null for the robot at rest.
Result<std::shared_ptr<const Problem>> load_shown(const ServeOptions& options) {
  if (options.problem.empty()) return std::shared_ptr<const Problem>();
  const auto overrides = MNEME_TRY(problem_options(options.robot, options.robot_options));
  Problem problem = MNEME_TRY(read_problem(options.problem, overrides));
  const auto joints = static_cast<std::size_t>(problem.robot.joint_count());
  if (problem.start.size() != joints) {
    return fail(ErrorCode::invalid,
                fmt::format("--problem {}: expected a start of {} values, one for each joint of "
                            "'{}', got {}; is it a problem of another robot?",
                            options.problem, joints, problem.robot.name(), problem.start.size()));
  }
  if (!problem.constraints.empty()) {
    print_note(
        fmt::format("--problem {}: its constraints hold for plans of the page only; other "
                    "requests name their own",
                    options.problem));
  }
  return std::make_shared<const Problem>(std::move(problem));
}

Result<std::vector<std::shared_ptr<const Cell>>> load_cells(const ServeOptions& options) {
  const auto overrides = MNEME_TRY(problem_options(options.robot, options.robot_options));
  std::vector<std::shared_ptr<const Cell>> cells;
  for (const std::string& path : options.cells) {
    const Cell cell = MNEME_TRY(load_cell(path, "", overrides));
    for (const std::string& warning : cell.region().problem.warnings) print_warning(warning);
    if (!cell.is_of_this_world()) {
      print_note(path +
                 ": robot, scene or allowed contacts have changed since it was built: its "
                 "answers are verified, none certified");
    }
    cells.push_back(std::make_shared<const Cell>(cell));
  }
  return cells;
}

Result<ExitCode> run_serve(const ServeOptions& options) {
  const auto shown = MNEME_TRY(load_shown(options));
  // Plans of the page must be those of its problem: with its group and its fixed joints.
  const Robot robot = MNEME_TRY(shown ? Result<Robot>(shown->robot)
                                      : load_named_robot(options.robot, options.robot_options));
  ServiceSettings settings = options.service;
  settings.body_bytes = static_cast<std::size_t>(options.body_mib) << kMebibyte;
  settings.token = MNEME_TRY(read_token(options.token_file));
  const auto database = MNEME_TRY(open_database(options, robot));
  settings.shown = shown;
  settings.cells = MNEME_TRY(load_cells(options));
  settings.robot_path = robot_file(options.robot).value_or("");
  settings.package_paths = options.robot_options.package_paths;

  const auto report = std::make_shared<LastReport>(database);
  StopSignal stop_signal(report);
  auto service = MNEME_TRY(Service::start(robot, database, settings));
  fmt::print("serving {} at {}\n", robot.name(), service.address());
  std::fflush(stdout);
  stop_signal.wait();
  service.stop();
  return report->make();
}

}  // namespace

void add_serve(CLI::App& program, Action& action) {
  const auto options = std::make_shared<ServeOptions>();
  CLI::App& command =
      add_command(program, action, "serve", "Plan for many clients over HTTP",
                  "serve --robot fetch --db fetch.db --remember-after 3000", options, run_serve);
  command.add_option("--robot", options->robot, "URDF file or name of a robot")->required();
  add_robot_flags(command, options->robot_options);
  add_database(command, options->db, options->kept, "database: an SQLite file or postgresql://...");
  const auto listen = [&where = options->service.listen](const std::string& text) {
    const auto checked = check_listen(text);
    if (!checked) throw CLI::ValidationError("--listen", checked.error().message);
    where = text;
  };
  add_text(command, "--listen", listen,
           "HOST:PORT, port 0 for any free one, or unix:PATH (default 127.0.0.1:7890); addresses "
           "that other machines reach need --token-file");
  command.add_option("--problem", options->problem,
                     "problem that gives the group, the fixed joints, the first view of the page, "
                     "and the scene of requests without obstacles: YAML file, or FILE.json#NAME");
  command.add_option("--cell", options->cells,
                     "file of 'mneme cell build' that answers its tasks before anything is "
                     "planned; several if it is given several times");
  command.add_option("--token-file", options->token_file,
                     "file whose first line clients must send as Authorization: Bearer TOKEN");
  add_settings(command, options->service);
  command.get_option("--remember-after")->needs("--db");
  add_number(command, "--longest-body", options->body_mib, 1, 1024,
             "largest body of a request, MiB");
  add_isa(command);
}

}  // namespace mneme::app
#else

namespace mneme::app {
void add_serve(CLI::App&, Action&) {}
}  // namespace mneme::app
#endif
