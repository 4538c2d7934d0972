// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/upkeep.h"
#include "mneme/experience.h"
#include "mneme/report.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <memory>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

struct UpkeepOptions {
  std::string url;
  std::vector<std::string> sources;
  std::string file;
  std::string robot;
  RobotOptions robot_options;
  bool is_forced = false;
  bool is_json = false;
  bool is_report = false;
};

// verify

ExitCode report(const UpkeepOptions& options, const std::vector<Damage>& damages) {
  Json rows = Json::array();
  for (const Damage& damage : damages) {
    if (!options.is_json) {
      fmt::print("{}: {}{}\n", damage.id == 0 ? "database" : fmt::format("row {}", damage.id),
                 printable(damage.what), damage.is_quarantined ? " (set aside)" : "");
    }
    rows.push_back(
        {{"id", damage.id}, {"what", damage.what}, {"is_quarantined", damage.is_quarantined}});
  }
  if (options.is_json) {
    print_json({{"is_clean", damages.empty()}, {"damages", rows}});
  } else if (damages.empty()) {
    const auto opened = Database::inspect(options.url);
    const bool is_empty = opened && opened->info().schema_version == 0;
    fmt::print("the database is {}\n", is_empty ? "empty" : "sound");
  } else if (damages.front().is_quarantined) {
    fmt::print("the remaining rows are sound\n");
  }
  return damages.empty() ? ExitCode::done : ExitCode::bad_database;
}

Result<ExitCode> run_verify(const UpkeepOptions& options) {
  if (const auto unknown = describe_record_flaw(options.url)) print_note(*unknown);
  return verify_database(options.url,
                         options.is_report ? VerifyMode::report : VerifyMode::quarantine)
      .map([&](const std::vector<Damage>& damages) { return report(options, damages); });
}

// merge, export, import

Json to_json(const MergeSummary& summary) {
  return {{"read", summary.read}, {"added", summary.added}, {"replaced", summary.replaced}};
}

void print_summary(const UpkeepOptions& options, const MergeSummary& summary) {
  if (options.is_json) return print_json(to_json(summary));
  fmt::print("{} read, {} added, {} replaced by earlier ones\n",
             counted(summary.read, "row", "rows"), summary.added, summary.replaced);
}

Result<ExitCode> run_merge(const UpkeepOptions& options) {
  MergeSummary total;
  for (const std::string& source : options.sources) {
    const MergeSummary summary = MNEME_TRY(merge_databases(options.url, source));
    total.read += summary.read;
    total.added += summary.added;
    total.replaced += summary.replaced;
  }
  print_summary(options, total);
  return ExitCode::done;
}

Result<ExitCode> run_export(const UpkeepOptions& options) {
  const std::array<ReadFile, 1> inputs = {{{"the memory", options.url}}};
  MNEME_TRY(check_outputs(std::array{options.file}, inputs));
  return export_database(options.url, options.file).map([&](std::int64_t rows) {
    const std::string what =
        fmt::format("{} written to {}", counted(rows, "row", "rows"), options.file);
    if (options.file == "/dev/stdout") {
      print_note(what);
    } else if (options.is_json) {
      print_json({{"rows", rows}, {"file", options.file}});
    } else {
      fmt::print("{}\n", what);
    }
    return ExitCode::done;
  });
}

Result<ExitCode> run_import(const UpkeepOptions& options) {
  return import_database(options.url, options.file).map([&](const MergeSummary& summary) {
    print_summary(options, summary);
    return ExitCode::done;
  });
}

// adopt

Result<ExitCode> run_adopt(const UpkeepOptions& options) {
  const Robot robot = MNEME_TRY(load_named_robot(options.robot, options.robot_options));
  const RobotSignature signature = make_signature(robot);
  return adopt_database(options.url, signature, options.is_forced)
      .map([&](const RobotSignature& before) {
        if (options.is_json) {
          print_json({{"robot_name", signature.robot_name},
                      {"kinematics_hash", signature.kinematics_hash},
                      {"kinematics_hash_before", before.kinematics_hash}});
        } else {
          fmt::print("the experience of robot '{}' now belongs to robot '{}' (kinematics {})\n",
                     printable(before.robot_name), printable(signature.robot_name),
                     signature.kinematics_hash);
        }
        return ExitCode::done;
      });
}

// compact

Result<ExitCode> run_compact(const UpkeepOptions& options) {
  return compact_database(options.url).map([&](const CompactSummary& summary) {
    if (options.is_json) {
      print_json({{"removed", summary.removed},
                  {"bytes_before", summary.bytes_before},
                  {"bytes_after", summary.bytes_after}});
    } else {
      fmt::print("{} removed, {} bytes before, {} bytes after\n",
                 counted(summary.removed, "row", "rows"), summary.bytes_before,
                 summary.bytes_after);
    }
    return ExitCode::done;
  });
}

}  // namespace

void add_db_upkeep(CLI::App& group, Action& action) {
  const auto options = std::make_shared<UpkeepOptions>();
  const auto add = [&](const std::string& name, const std::string& sentence,
                       const std::string& example,
                       Result<ExitCode> (*run)(const UpkeepOptions&)) -> CLI::App& {
    CLI::App& command =
        add_command(group, action, name, sentence, "db " + name + " " + example, options, run);
    command.add_option("URL", options->url, "SQLite file, or postgresql://...")->required();
    add_json(command, options->is_json);
    return command;
  };
  add("verify", "Check structure and checksums; searches then skip damaged rows", "planar.db",
      run_verify)
      .add_flag("--report", options->is_report, "only report, change nothing");
  add("merge", "Add the rows of other databases", "all.db part1.db part2.db", run_merge)
      .add_option("FROM", options->sources, "databases to add to URL")
      ->required();
  CLI::App& to_file =
      add("export", "Write all rows to a file", "planar.db planar.jsonl", run_export);
  CLI::App& from_file =
      add("import", "Add the rows of a file", "planar.db planar.jsonl", run_import);
  for (CLI::App* command : {&to_file, &from_file}) {
    command->add_option("FILE", options->file, "JSON lines (.jsonl)")->required();
  }
  CLI::App& adopt = add("adopt", "Use the rows for a robot with other joint limits",
                        "arm.db --robot arm.urdf", run_adopt);
  adopt.add_option("--robot", options->robot, "URDF file or name of the robot")->required();
  add_robot_flags(adopt, options->robot_options);
  adopt.add_flag("--force", options->is_forced,
                 "also adopt a database of an older mneme, which stores no joint frames");
  add("compact", "Delete damaged and superseded rows, and free their space", "planar.db",
      run_compact);
}

}  // namespace mneme::app
