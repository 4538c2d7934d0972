// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cell_build.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

Json coverage_json(const CellCoverage& coverage) {
  Json gaps = Json::object();
  for (int i = 0; i < kCellGaps; ++i) {
    gaps[std::string(to_string(static_cast<CellGap>(i)))] =
        coverage.gaps[static_cast<std::size_t>(i)];
  }
  return {{"proven", coverage.proven}, {"unproven", gaps}, {"samples", coverage.samples}};
}

void print_coverage(const CellCoverage& coverage) {
  fmt::print("{:>8.2f} %  proven for the modelled scene\n", 100 * coverage.proven);
  for (int i = 0; i < kCellGaps; ++i) {
    const double share = coverage.gaps[static_cast<std::size_t>(i)];
    if (share == 0) continue;
    fmt::print("{:>8.2f} %  not proven: {}\n", 100 * share, to_string(static_cast<CellGap>(i)));
  }
}

}  // namespace

void print_built(const Cell& cell, const std::string& path) {
  fmt::print("{}: {}, {} planned for them\n", path, counted(cell.box_count(), "box", "boxes"),
             counted(cell.path_count(), "path", "paths"));
  for (std::size_t i = 0; i < cell.region().starts.size(); ++i) {
    const CellCoverage coverage = cell.coverage(i);
    fmt::print("from {}, by {} samples of the region:\n", cell.region().starts[i].name,
               coverage.samples);
    print_coverage(coverage);
  }
}

Json describe_cell(const Cell& cell) {
  Json starts = Json::array();
  for (std::size_t i = 0; i < cell.region().starts.size(); ++i) {
    Json start = coverage_json(cell.coverage(i));
    start["start"] = cell.region().starts[i].name;
    starts.push_back(std::move(start));
  }
  Json steps = Json::array();  // none of a world that is gone
  for (const CellProgress& step : cell.progress()) {
    if (!cell.is_of_this_world()) break;
    steps.push_back({{"time_s", step.time_s}, {"boxes", step.boxes}, {"proven", step.proven}});
  }
  return {{"boxes", cell.box_count()},  {"proven_boxes", cell.proven_count()},
          {"paths", cell.path_count()}, {"margin", cell.margin()},
          {"starts", starts},           {"is_of_this_world", cell.is_of_this_world()},
          {"progress", steps}};
}

namespace {

struct CellBuildOptions {
  std::string region;
  std::string output;
  CellSettings settings;
  bool is_resumed = false;
  bool is_json = false;
};

/// Builds a cell, or continues the one in the output file.
Result<Cell> build_or_resume(const CellRegion& region, const CellBuildOptions& options,
                             const std::function<void(const CellProgress&)>& on_progress) {
  CellSettings settings = options.settings;
  settings.cancel = interrupt_flag();
  if (!options.is_resumed || !std::filesystem::exists(options.output)) {
    return build_cell(region, settings, on_progress);
  }
  Cell cell = MNEME_TRY(load_cell(options.output, options.region));
  MNEME_TRY(cell.extend(settings, on_progress));
  return cell;
}

/// Says why nothing is proven, in any start.
void print_nothing_proven(const Cell& cell) {
  const auto is_out_of_reach = [&](std::size_t start) {
    constexpr int kSamples = 1000;
    return cell.coverage(start, kSamples).gaps[static_cast<std::size_t>(CellGap::unreachable)] == 1;
  };
  bool is_far = true;
  for (std::size_t i = 0; i < cell.region().starts.size(); ++i) is_far &= is_out_of_reach(i);
  print_error(is_far ? fmt::format("nothing is proven: inverse kinematics finds no free "
                                   "configuration of link {} in the region; it is out of reach, "
                                   "or in contact",
                                   cell.region().middle().link)
                     : "nothing is proven, and 'cell show' says why; build longer, or move the "
                       "region, the start or obstacles");
}

Result<ExitCode> run_cell_build(const CellBuildOptions& options) {
  ProblemOptions reading;
  reading.on_approximated = show_sphere_progress();
  const CellRegion region = MNEME_TRY(load_region(options.region, reading));
  std::vector<ReadFile> inputs = {{"the region", options.region}};
  add_files("a file of the problem", region.problem.files, inputs);
  MNEME_TRY(check_outputs(std::array{options.output}, inputs));
  MNEME_TRY(check_cell_output(options.output));
  for (const std::string& warning : region.problem.warnings) print_warning(warning);
  if (!options.is_resumed) {
    if (const auto fault = MNEME_TRY(find_invalid_start(region, options.settings.margin))) {
      print_error(*fault);
      return ExitCode::invalid_ends;
    }
  }
  Progress bar("proving");
  const Cell cell = MNEME_TRY(build_or_resume(region, options, [&](const CellProgress& progress) {
    bar.update(static_cast<std::int64_t>(1000 * progress.decided), 1000,
               fmt::format("{} boxes", progress.boxes));
  }));
  MNEME_TRY(cell.save(options.output));
  if (options.is_json) {
    print_json(describe_cell(cell));
  } else {
    print_built(cell, options.output);
  }
  if (interrupt_flag()->load()) {
    print_note(
        fmt::format("interrupted: {} has what was proven; --resume continues it", options.output));
    return ExitCode::interrupted;
  }
  if (cell.proven_count() > 0) return ExitCode::done;
  print_nothing_proven(cell);
  return ExitCode::no_path;
}

}  // namespace

void add_cell_build(CLI::App& group, Action& action) {
  const auto options = std::make_shared<CellBuildOptions>();
  CLI::App& command = add_command(
      group, action, "build", "Prove the motions of a region beforehand",
      "cell build region.yaml -o shelf.cell --seconds 60 --threads 2", options, run_cell_build);
  command.add_option("REGION", options->region, "problem file with the key 'region'")->required();
  command.add_option("-o,--output", options->output, "file to write")->required();
  add_settings(command, options->settings);
  command.add_flag("--resume", options->is_resumed,
                   "continue the cell in the output file, if there is one, with its margin");
  add_isa(command);
  add_json(command, options->is_json);
}

}  // namespace mneme::app
