// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme cell: builds, queries, verifies and shows certified cells, and makes regions for them.
#include "mneme/benchmark.h"
#include "mneme/cell.h"
#include "mneme/cell_motion.h"
#include "mneme/instances.h"
#include "mneme/report.h"

#include "cell_build.h"
#include "cell_page.h"
#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"
#include "trajectory_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

struct CellFile {
  std::string path;
  std::string region;
};

Result<Cell> read_cell(const CellFile& file) {
  ProblemOptions options;
  options.on_approximated = show_sphere_progress();
  Cell cell = MNEME_TRY(load_cell(file.path, file.region, options));
  for (const std::string& warning : cell.region().problem.warnings) print_warning(warning);
  if (!cell.is_of_this_world()) {
    print_note(
        "the robot, the scene or allowed contacts have changed since this cell was built: "
        "its boxes are hints until 'mneme cell verify --save' proves them again");
  }
  return cell;
}

void add_cell_argument(CLI::App& command, CellFile& file) {
  command.add_option("CELL", file.path, "file of 'mneme cell build'")->required();
  command.add_option("--region", file.region,
                     "region file (default: the one that the cell was built from)");
}

struct CellQueryOptions {
  CellFile cell;
  CellTask task = {};
  std::string start;
  double timeout_s = 1;
  TrajectoryOptions trajectory;
  bool is_json = false;
};

/// Offsets in the order x, y, z, yaw; notes that missing ones are 0.
CellTask parse_offsets(const std::string& flag, const std::string& text) {
  const std::vector<double> values = parse_numbers(flag, text);
  CellTask task = {};
  if (values.size() > task.size()) {
    throw CLI::ValidationError(flag, fmt::format("'{}' has more numbers than x, y, z, yaw", text));
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isfinite(values[k])) continue;
    throw CLI::ValidationError(
        flag, fmt::format("{} is {}: expected a finite number", kTaskNames[k], values[k]));
  }
  if (values.size() < task.size()) {
    const std::span missing = std::span(kTaskNames).subspan(values.size());
    print_note(fmt::format("{} {}: taken as 0: {}", flag, text, fmt::join(missing, ", ")));
  }
  std::ranges::copy(values, task.begin());
  return task;
}

Result<std::size_t> find_start(const CellRegion& region, const std::string& name) {
  if (name.empty()) return std::size_t{0};
  std::vector<std::string> names;
  for (const CellStart& start : region.starts) names.push_back(start.name);
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  return fail(ErrorCode::invalid,
              fmt::format("--start: expected one of {}, got \"{}\"{}", fmt::join(names, ", "), name,
                          did_you_mean(name, names)));
}

/// Writes the answer's trajectory. Returns nothing if none is wanted, or without a path.
Result<std::optional<CellMotion>> time_answer(const CellQueryOptions& options, const Cell& cell,
                                              const CellAnswer& answer) {
  const TrajectoryOptions& wanted = options.trajectory;
  if (!wanted.is_wanted() || answer.tier == CellTier::none) return std::nullopt;
  const Robot& robot = cell.region().problem.robot;
  const RateLimits limits = MNEME_TRY(find_rate_limits(robot, wanted.settings, wanted.limits));
  for (const std::string& warning : limits.warnings) print_warning(warning);
  CellMotion timed = MNEME_TRY(CellMotions(cell).time(answer, limits, wanted.settings));
  MNEME_TRY(write_trajectory(wanted, robot, timed.motion));
  return timed;
}

std::string_view describe_motion(const CellAnswer& answer, const CellMotion& timed) {
  if (timed.is_of_box) return "as of all tasks of the box";
  return answer.tier == CellTier::certified
             ? "of this path; cut corners keep the margin from obstacles, not between links"
             : "of this path, free of contact without the margin";
}

void print_answer(const CellAnswer& answer, const std::optional<CellMotion>& timed, bool is_json) {
  if (is_json) {
    Json json = {{"tier", to_string(answer.tier)},
                 {"box", answer.box < 0 ? Json() : Json(answer.box)},
                 {"path", answer.path},
                 {"message", answer.note.empty() ? Json() : Json(answer.note)}};
    if (timed) {
      json["motion"] = {{"duration_s", timed->motion.duration_s()},
                        {"is_of_box", timed->is_of_box}};
    }
    return print_json(json);
  }
  if (answer.tier == CellTier::none) return;
  fmt::print("{}{}\n", to_string(answer.tier),
             answer.box < 0 ? "" : fmt::format(": box {}", answer.box));
  for (const Configuration& q : answer.path) fmt::print("{:.6f}\n", fmt::join(q, ","));
  if (!timed) return;
  fmt::print("motion: {:.3f} s, {}\n", timed->motion.duration_s(), describe_motion(answer, *timed));
}

Result<ExitCode> run_cell_query(const CellQueryOptions& options) {
  const Cell cell = MNEME_TRY(read_cell(options.cell));
  std::vector<ReadFile> inputs = {{"the cell", options.cell.path},
                                  {"the file of limits", options.trajectory.limits}};
  add_files("a file of the problem", cell.region().problem.files, inputs);
  MNEME_TRY(check_files_to_write(std::array{options.trajectory.file}, inputs));
  const std::size_t start = MNEME_TRY(find_start(cell.region(), options.start));
  const CellAnswer answer = cell.ask(options.task, start, options.timeout_s);
  const auto timed = MNEME_TRY(time_answer(options, cell, answer));
  print_answer(answer, timed, options.is_json);
  if (answer.tier != CellTier::none) return ExitCode::done;
  print_error(answer.note);
  return ExitCode::no_path;
}

void add_cell_query(CLI::App& group, Action& action) {
  const auto options = std::make_shared<CellQueryOptions>();
  CLI::App& command =
      add_command(group, action, "query", "Find the path of one task",
                  "cell query shelf.cell --at 0.05,-0.02,0,0.3", options, run_cell_query);
  add_cell_argument(command, options->cell);
  add_text(
      command, "--at",
      [options](const std::string& text) { options->task = parse_offsets("--at", text); },
      "offsets x,y,z,yaw from the region's middle, metres and radians")
      ->required();
  command.add_option("--start", options->start, "name of the start (default: the first)");
  add_number(command, "--timeout", options->timeout_s, 0.0, 1e6,
             "time to plan where the cell has no path, seconds; 0: do not plan");
  add_trajectory_flags(command, options->trajectory);
  command.remove_option(command.get_option("--blend-tolerance"));  // one motion joins nothing
  add_json(command, options->is_json);
}

struct CellVerifyOptions {
  CellFile cell;
  int samples = 1000;
  int threads = 1;
  std::uint64_t seed = 1;
  bool is_saved = false;
  bool is_json = false;
};

Result<ExitCode> run_cell_verify(const CellVerifyOptions& options) {
  Cell cell = MNEME_TRY(read_cell(options.cell));
  const CellVerification result = cell.verify(options.samples, options.seed, options.threads);
  if (options.is_saved) MNEME_TRY(cell.save(options.cell.path));
  if (options.is_json) {
    print_json({{"boxes", result.checked},
                {"proven", result.proven},
                {"kept", result.kept},
                {"time_s", result.time_s},
                {"paths", result.paths},
                {"in_contact", result.in_contact}});
  } else {
    fmt::print("{} of {} proven in {:.2f} s\n", result.proven,
               counted(result.checked, "box", "boxes"), result.time_s);
    fmt::print("{} in contact of {} of proven boxes, checked by exact distances\n",
               result.in_contact, counted(result.paths, "path", "paths"));
  }
  if (result.in_contact > 0) {
    print_error("a path of a proven box is in contact: please report this");
    return ExitCode::failure;
  }
  return result.proven == result.checked ? ExitCode::done : ExitCode::no_path;
}

void add_cell_verify(CLI::App& group, Action& action) {
  const auto options = std::make_shared<CellVerifyOptions>();
  CLI::App& command = add_command(group, action, "verify", "Prove all boxes again",
                                  "cell verify shelf.cell", options, run_cell_verify);
  add_cell_argument(command, options->cell);
  add_number(command, "--samples", options->samples, 0, 10000000,
             "paths to check by exact distances, half of them at corners of boxes");
  add_number(command, "--threads", options->threads, 1, 64, "threads that prove");
  add_seed(command, options->seed, "seed of the samples");
  command.add_flag("--save", options->is_saved, "write what is proven back to the file");
  add_json(command, options->is_json);
}

struct CellShowOptions {
  CellFile cell;
  int count = 10;
  int jumps = 0;
  std::string view;
  std::string start;
  bool is_json = false;
};

/// The offsets that vary, with `half_extents` if they are given.
std::string describe_task(const CellRegion& region, const CellTask& task,
                          const CellTask* half_extents = nullptr) {
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < kTaskSize; ++k) {
    if (region.half_extents[k] == 0) continue;
    texts.push_back(fmt::format("{} {:.3f}", kTaskNames[k], task[k]));
    if (half_extents) texts.back() += fmt::format("+-{:.3f}", (*half_extents)[k]);
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

void print_unproven(const CellRegion& region, const std::vector<UnprovenBox>& boxes, int count) {
  if (boxes.empty()) return;
  const auto shown = std::min(boxes.size(), static_cast<std::size_t>(count));
  fmt::print("largest of {} not proven throughout:\n",
             counted(boxes.size(), "box that is", "boxes that are"));
  for (std::size_t i = 0; i < shown; ++i) {
    const UnprovenBox& box = boxes[i];
    const std::string contact = box.first.empty()
                                    ? ""
                                    : fmt::format(": {} and {} at {:.0f} % of the way", box.first,
                                                  box.other, 100 * box.along);
    fmt::print("{:>8.3f} %  {}{}\n            {}\n", 100 * box.share, to_string(box.gap),
               printable(contact), describe_task(region, box.center, &box.half_extents));
  }
}

void print_jumps(const CellRegion& region, const CellContinuity& found, int count) {
  fmt::print("paths change by 0.5 rad or more across {} of {} between boxes\n", found.jumps.size(),
             counted(found.faces, "face", "faces"));
  const auto shown = std::min(found.jumps.size(), static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < shown; ++i) {
    const CellJump& jump = found.jumps[i];
    fmt::print("{:>8.2f} rad  boxes {} and {}, at {}\n", jump.change, jump.box, jump.next,
               describe_task(region, jump.task));
  }
}

Result<ExitCode> run_cell_show(const CellShowOptions& options) {
  const Cell cell = MNEME_TRY(read_cell(options.cell));
  if (!options.view.empty()) {
    std::vector<ReadFile> inputs = {{"the cell", options.cell.path}};
    add_files("a file of the problem", cell.region().problem.files, inputs);
    MNEME_TRY(check_outputs(std::array{options.view}, inputs));
    const auto start = MNEME_TRY(find_start(cell.region(), options.start));
    const PlanTrace trace = MNEME_TRY(trace_cell(cell, start));
    const std::string page = MNEME_TRY(to_page(to_json(trace), options.view));
    MNEME_TRY(write_file(options.view, page));
  }
  if (options.is_json) {
    print_json(describe_cell(cell));
    return ExitCode::done;
  }
  print_built(cell, options.cell.path);
  const std::vector<CellStart>& starts = cell.region().starts;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (starts.size() > 1) fmt::print("start '{}':\n", printable(starts[i].name));
    print_unproven(cell.region(), cell.unproven(i), options.count);
    print_jumps(cell.region(), cell.continuity(i), options.jumps);
  }
  return ExitCode::done;
}

void add_cell_show(CLI::App& group, Action& action) {
  const auto options = std::make_shared<CellShowOptions>();
  CLI::App& command = add_command(group, action, "show",
                                  "Print what of a region is proven, and what is not and why",
                                  "cell show shelf.cell", options, run_cell_show);
  add_cell_argument(command, options->cell);
  add_number(command, "--unproven", options->count, 0, 1000000,
             "boxes that are not proven to list");
  add_number(command, "--jumps", options->jumps, 0, 1000000,
             "faces between boxes across which paths change to list");
  command.add_option("--view", options->view,
                     "write a page that shows the region, coloured by what is proven, and a path");
  command.add_option("--start", options->start,
                     "name of the start for --view (default: the first)");
  add_json(command, options->is_json);
}

struct CellBenchOptions {
  CellFile cell;
  int tasks = 1000;
  int look_ups = 1000000;
  double timeout_s = 0.2;
  std::uint64_t seed = 1;
  bool is_json = false;
};

CellTask random_cell_task(const CellRegion& region, Rng& rng) {
  CellTask task;
  for (std::size_t k = 0; k < kTaskSize; ++k) {
    task[k] = region.half_extents[k] * rng.uniform(-1, 1);
  }
  return task;
}

/// Microseconds at a quantile.
double quantile_us(std::vector<float>& seconds, double share) {
  if (seconds.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(seconds.size() - 1));
  std::nth_element(seconds.begin(), seconds.begin() + rank, seconds.end());
  return 1e6 * double{seconds[static_cast<std::size_t>(rank)]};
}

/// Outcomes of random tasks.
struct CellTally {
  std::array<std::vector<float>, 4> seconds;  ///< by tier

  void add(CellTier tier, double time_s) {
    seconds.at(static_cast<std::size_t>(tier)).push_back(static_cast<float>(time_s));
  }
  [[nodiscard]] std::size_t count(CellTier tier) const {
    return seconds.at(static_cast<std::size_t>(tier)).size();
  }
};

Json to_json(CellTally& tally) {
  Json tiers = Json::object();
  for (std::size_t i = 0; i < tally.seconds.size(); ++i) {
    std::vector<float>& times = tally.seconds[i];
    tiers[std::string(to_string(static_cast<CellTier>(i)))] = {
        {"tasks", times.size()},
        {"p50_us", quantile_us(times, 0.5)},
        {"p99_us", quantile_us(times, 0.99)}};
  }
  return tiers;
}

void print_tally(CellTally& tally) {
  for (std::size_t i = 0; i < tally.seconds.size(); ++i) {
    std::vector<float>& times = tally.seconds[i];
    if (times.empty()) continue;
    fmt::print("{:<10} {:>9} {:>10.1f} us p50 {:>10.1f} us p99\n",
               to_string(static_cast<CellTier>(i)), times.size(), quantile_us(times, 0.5),
               quantile_us(times, 0.99));
  }
}

Result<ExitCode> run_cell_bench(const CellBenchOptions& options) {
  const Stopwatch loading;
  const Cell cell = MNEME_TRY(read_cell(options.cell));
  const double load_s = loading.elapsed_s();
  Rng rng(options.seed);
  CellTally look_ups, tasks;
  CellAnswer answer;
  for (int i = 0; i < options.look_ups; ++i) {
    const CellTask task = random_cell_task(cell.region(), rng);
    const Stopwatch stopwatch;
    cell.look_up(task, answer);
    look_ups.add(answer.tier, stopwatch.elapsed_s());
  }
  for (int i = 0; i < options.tasks; ++i) {
    const CellTask task = random_cell_task(cell.region(), rng);
    const Stopwatch stopwatch;
    const CellTier tier = cell.ask(task, 0, options.timeout_s).tier;
    tasks.add(tier, stopwatch.elapsed_s());
  }
  if (options.is_json) {
    print_json({{"load_s", load_s}, {"look_ups", to_json(look_ups)}, {"tasks", to_json(tasks)}});
    return ExitCode::done;
  }
  fmt::print("loaded in {:.1f} ms\nlook-ups of random tasks\n", 1e3 * load_s);
  print_tally(look_ups);
  fmt::print("answers to random tasks\n");
  print_tally(tasks);
  return ExitCode::done;
}

void add_cell_bench(CLI::App& group, Action& action) {
  const auto options = std::make_shared<CellBenchOptions>();
  CLI::App& command =
      add_command(group, action, "bench", "Measure answers to random tasks of a cell",
                  "cell bench shelf.cell", options, run_cell_bench);
  add_cell_argument(command, options->cell);
  add_number(command, "--look-ups", options->look_ups, 0, 1000000000,
             "tasks that are looked up only");
  add_number(command, "--tasks", options->tasks, 0, 1000000000,
             "tasks that all tiers answer; those with an answer can be reached");
  add_number(command, "--timeout", options->timeout_s, 0.0, 1e6, "time to plan, seconds");
  add_seed(command, options->seed, "seed of the tasks");
  add_json(command, options->is_json);
}

struct CellRegionsOptions {
  std::vector<std::string> problems;
  std::string part;
  std::string robot;
  RobotOptions robot_options;
  std::string output = ".";
  RegionSettings settings;
};

/// `written` are the regions of this run.
Result<std::string> write_region(const CellRegionsOptions& options, const SuiteProblems& each,
                                 ProblemOptions reading, std::set<std::string>& written) {
  if (!each.robot.empty()) reading.robot_path = each.robot;
  const Problem problem = MNEME_TRY(read_problem(each.where, reading));
  const CellRegion region = MNEME_TRY(make_region(problem, options.settings));
  const std::filesystem::path named = each.where;
  std::string name = named.filename().string();
  std::ranges::replace_if(
      name, [](char c) { return c == '#' || c == '.' || c == ','; }, '_');
  const std::string path = (std::filesystem::path(options.output) / (name + ".yaml")).string();
  if (!written.insert(path).second) {
    return fail(ErrorCode::invalid,
                fmt::format("{}: {} has the region of another problem of this name; use another "
                            "directory (-o)",
                            each.where, path));
  }
  const std::string robot = std::filesystem::absolute(problem.robot_path).string();
  std::vector<ReadFile> inputs;
  add_files("a file of the problem", problem.files, inputs);
  MNEME_TRY(check_outputs(std::array{path}, inputs));
  MNEME_TRY(write_file(path, to_yaml(region, robot)));
  return path;
}

Result<ExitCode> run_cell_regions(const CellRegionsOptions& options) {
  const auto reading = MNEME_TRY(problem_options(options.robot, options.robot_options));
  const auto problems = MNEME_TRY(find_bench_problems(options.problems, options.part));
  MNEME_TRY(make_directory(options.output));
  std::set<std::string> written;
  for (const SuiteProblems& each : problems) {
    if (interrupt_flag()->load()) return ExitCode::interrupted;
    const std::string path = MNEME_TRY(write_region(options, each, reading, written));
    fmt::print("{}\n", path);
  }
  return ExitCode::done;
}

void add_cell_regions(CLI::App& group, Action& action) {
  const auto options = std::make_shared<CellRegionsOptions>();
  CLI::App& command =
      add_command(group, action, "regions", "Make regions around the goals of problems",
                  "cell regions shelf.json --link panda_hand --pivot 0,0,0.1034 -o regions",
                  options, run_cell_regions);
  add_problem_list(command, options->problems, options->part);
  add_other_robot(command, options->robot, options->robot_options);
  command.add_option("--link", options->settings.link, "link that is placed")->required();
  add_text(
      command, "--pivot",
      [options](const std::string& text) {
        const std::vector<double> values = parse_numbers("--pivot", text);
        if (values.size() != 3) {
          throw CLI::ValidationError("--pivot", fmt::format("'{}' is not x,y,z in metres", text));
        }
        options->settings.pivot = Vec3(values[0], values[1], values[2]);
      },
      "point of the link that yaw keeps in place, x,y,z (default: its origin)");
  add_text(
      command, "--extents",
      [options](const std::string& text) {
        options->settings.half_extents = parse_offsets("--extents", text);
      },
      "half extents x,y,z,yaw, metres and radians (default 0.15,0.1,0.025,0.785)");
  add_number(command, "--tries", options->settings.tries, 1, 10000,
             "middles to try around each goal; 1: the goal itself");
  add_seed(command, options->settings.seed, "seed of the middles");
  command.add_option("-o,--output", options->output, "directory to write (default: .)");
}

}  // namespace

void add_cell(CLI::App& program, Action& action) {
  CLI::App& group = add_group(program, "cell", "Prove the motions of a region of tasks beforehand",
                              "cell build region.yaml -o shelf.cell");
  add_cell_build(group, action);
  add_cell_query(group, action);
  add_cell_verify(group, action);
  add_cell_show(group, action);
  add_cell_bench(group, action);
  add_cell_regions(group, action);
}

}  // namespace mneme::app
