// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme doctor: what is built in and installed, and whether it works.
#include "mneme/base.h"
#include "mneme/upkeep.h"
#include "mneme/benchmark.h"
#include "mneme/pipeline.h"
#include "mneme/report.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kProblem = "planar/scenario1.yaml";
/// Emulated processors are slow.
constexpr double kTimeout = 100;

/// Something that a build may have or lack.
struct Part {
  std::string_view name;
  bool is_built;
  std::string_view advice;  ///< how to get it
};
constexpr Part kParts[] = {
    {"OMPL adapter", MNEME_HAS_OMPL, "script/setup --all installs OMPL; then build again"},
    {"PostgreSQL", MNEME_HAS_POSTGRESQL, "script/setup --all installs libpq; then build again"},
    {"train_cvae (torch)", MNEME_HAS_TORCH, "needs libtorch; configure with -DMNEME_WITH_TORCH=ON"},
    {"Python module", MNEME_HAS_PYTHON, "script/setup --all installs pybind11; then build again"},
};

struct Finding {
  std::string what;
  bool is_good = false;
  std::string detail;
};

Finding finding(std::string what, const Result<std::string>& outcome) {
  return {std::move(what), outcome.has_value(), outcome ? *outcome : outcome.error().message};
}

/// Plans with one instruction set, and checks the path by code that shares nothing with it.
Result<std::string> try_planning(const Problem& problem, Isa isa) {
  SolveSettings settings;
  settings.sampler = "uniform";
  settings.isa = isa;
  settings.plan.timeout_s = kTimeout;
  const SolveResult result = MNEME_TRY(solve(problem, nullptr, settings));
  if (!result.plan.is_solved()) return fail(ErrorCode::invalid, result.plan.message);
  return CollisionChecker::make(problem.robot, problem.scene)
      .and_then([&](const CollisionChecker& checker) -> Result<std::string> {
        const double resolution = checker.resolution() / kVerificationRefinement;
        if (!is_path_free(checker.robot(), checker.scene(), result.plan.path, resolution)) {
          return fail(ErrorCode::invalid, "a path failed the independent check");
        }
        return fmt::format("{} in {:.1f} ms", problem.name, 1e3 * result.planning_time_s);
      });
}

/// A temporary database file, removed at the end.
class ScratchFile {
 public:
  ScratchFile() {
    std::error_code ignored;
    path_ =
        std::filesystem::temp_directory_path(ignored) / fmt::format("mneme-doctor-{}.db", getpid());
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() { remove_database(path()); }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// Learns one primitive into a new database, and plans from it.
Result<std::string> try_memory(const Problem& problem) {
  const ScratchFile file;
  Database database =
      MNEME_TRY(Database::open(file.path(), make_signature(problem.robot), OpenMode::create));
  SolveSettings settings;
  settings.plan.timeout_s = kTimeout;
  settings.learn_budget_s = kTimeout;
  settings.learn.starts_per_link = 1;
  settings.learn.paths_per_start = 1;
  settings.learn.max_iterations = 1000;
  const SolveResult result = MNEME_TRY(solve(problem, &database, settings));
  const std::vector<Damage> damage = MNEME_TRY(verify_database(file.path()));
  if (!damage.empty() || database.size() == 0 || !result.plan.is_solved()) {
    return fail(ErrorCode::corrupt, fmt::format("'{}' did not keep what was learned", file.path()));
  }
  return fmt::format("learned {} in {:.0f} ms", counted(database.size(), "primitive", "primitives"),
                     1e3 * result.gl.learning_time_s);
}

std::vector<Finding> examine() {
  const auto directory_of = [](const std::string& path) {
    return std::filesystem::path(path).parent_path().string();
  };
  const Result<std::string> scene = find_scene(kProblem);
  std::vector<Finding> findings;
  findings.push_back(finding("robots", find_robot("planar8").map(directory_of)));
  findings.push_back(finding("scenes", scene.map(directory_of)));
  const Result<Problem> problem =
      scene.and_then([](const std::string& path) { return load_problem(path); });
  if (!problem) {
    findings.push_back(finding("problem", tl::unexpected(problem.error())));
    return findings;
  }
  for (const Isa isa : available_isas()) {
    findings.push_back(
        finding(fmt::format("planning, {}", to_string(isa)), try_planning(*problem, isa)));
  }
  findings.push_back(finding("database", try_memory(*problem)));
  return findings;
}

std::vector<std::string_view> isa_names() {
  std::vector<std::string_view> names;
  for (const Isa isa : available_isas()) names.push_back(to_string(isa));
  return names;
}

void print_text(const std::vector<Finding>& findings) {
  const bool is_forced = std::getenv("MNEME_ISA") != nullptr;
  fmt::print("{:<20} {}\n", "mneme", version());
  fmt::print("{:<20} {}; used: {}{}\n", "instruction sets", fmt::join(isa_names(), ", "),
             to_string(default_isa()), is_forced ? ", as MNEME_ISA says" : "");
  fmt::print("{:<20} {}\n", "threads", std::thread::hardware_concurrency());
  for (const Part& part : kParts) {
    fmt::print("{:<20} {}\n", part.name,
               part.is_built ? "built" : fmt::format("not built: {}", part.advice));
  }
  for (const Finding& finding : findings) {
    fmt::print("{:<20} {}: {}\n", finding.what, finding.is_good ? "ok" : "FAILED", finding.detail);
  }
}

void print_json(const std::vector<Finding>& findings, bool is_good) {
  Json parts = Json::object();
  for (const Part& part : kParts) parts[std::string(part.name)] = part.is_built;
  Json rows = Json::array();
  for (const Finding& finding : findings) {
    rows.push_back({{"what", finding.what}, {"ok", finding.is_good}, {"detail", finding.detail}});
  }
  app::print_json({{"version", version()},
                   {"isas", isa_names()},
                   {"isa", to_string(default_isa())},
                   {"threads", std::thread::hardware_concurrency()},
                   {"parts", parts},
                   {"checks", rows},
                   {"ok", is_good}});
}

Result<ExitCode> run_doctor(const bool& is_json) {
  const std::vector<Finding> findings = examine();
  bool is_good = true;
  for (const Finding& finding : findings) is_good = is_good && finding.is_good;
  if (is_json) {
    print_json(findings, is_good);
  } else {
    print_text(findings);
  }
  return is_good ? ExitCode::done : ExitCode::failure;
}

}  // namespace

void add_doctor(CLI::App& program, Action& action) {
  const auto is_json = std::make_shared<bool>(false);
  CLI::App& command =
      add_command(program, action, "doctor", "Show what is built in and installed, and test it",
                  "doctor", is_json, run_doctor);
  add_isa(command);
  add_json(command, *is_json);
}

}  // namespace mneme::app
