// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// mneme db: inspects a database.
#include "mneme/experience.h"
#include "mneme/pipeline.h"

#include "commands.h"
#include "console.h"
#include "inputs.h"
#include "options.h"
#include "problem_primitives.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>

namespace mneme::app {
namespace {

using Json = nlohmann::ordered_json;

struct DbOptions {
  std::string url;
  bool is_json = false;
  std::optional<std::int64_t> limit;
  std::optional<PrimitiveKey> key;
  std::string problem;
  std::string robot;
  RobotOptions robot_options;
  SolveSettings settings;
};

/// The kind whose keys are pairs of circles.
const MemoryKind& circles() { return *memory_kinds().front(); }

// info

Json to_json(const DatabaseInfo& info) {
  Json kinds = Json::array();
  for (const KindInfo& kind : info.kinds) {
    kinds.push_back({{"kind", kind.kind},
                     {"key_size", kind.key_size},
                     {"samplers", kind.samplers},
                     {"components", kind.components}});
  }
  const Json space = {{"robot_name", info.signature.robot_name},
                      {"robot_hash", info.signature.model_hash},
                      {"kinematics_hash", info.signature.kinematics_hash},
                      {"joint_count", info.signature.joint_count},
                      {"kinds", kinds}};
  return {{"url", info.url},
          {"samplers", info.samplers},
          {"components", info.components},
          {"spaces", Json::array({space})},
          {"robot_hash", info.signature.model_hash},
          {"kinematics_hash", info.signature.kinematics_hash},
          {"kinds", kinds},
          {"bytes", info.bytes},
          {"schema_version", info.schema_version},
          {"generation", info.generation},
          {"tombstones", info.tombstones}};
}

void print_info(const DatabaseInfo& info) {
  const auto line = [](std::string_view what, const auto& value) {
    fmt::print("{:<12}  {}\n", what, value);
  };
  line("database", info.url);
  if (info.schema_version == 0) {
    line("robot", "none: the database is empty; learning sets its robot");
    return;
  }
  line("robot", printable(info.signature.robot_name));
  line("kinematics", info.signature.kinematics_hash.empty()
                         ? "not noted: an older mneme made the database"
                         : info.signature.kinematics_hash);
  line("robot hash", info.signature.model_hash);
  line("joints", info.signature.joint_count);
  for (const KindInfo& kind : info.kinds) {
    line("kind", fmt::format("{}, keys of {} numbers, {}", printable(kind.kind), kind.key_size,
                             counted(kind.samplers, "row", "rows")));
  }
  line("samplers", info.samplers);
  line("components", info.components);
  line("set aside", counted(info.tombstones, "row", "rows"));
  line("size", fmt::format("{} bytes", info.bytes));
  line("schema", fmt::format("version {}, generation {}", info.schema_version, info.generation));
}

struct Comparison {
  RobotDifference difference;
  std::string_view word;
  std::string_view sentence;
};
constexpr std::array kComparisons = {
    Comparison{RobotDifference::none, "none", "the robot that the experience was learned with"},
    Comparison{
        RobotDifference::shapes, "shapes",
        "the same joints, frames and limits; another collision model (spheres, fingers, tools "
        "or checked pairs), which does not matter: the experience applies"},
    Comparison{RobotDifference::limits, "limits",
               "the same joints and frames; other limits: `mneme db adopt` makes the experience "
               "apply"},
    Comparison{RobotDifference::frames, "frames",
               "another arm: other joints, another order of them, or other frames"},
};

Result<ExitCode> run_info(const DbOptions& options) {
  const Database database = MNEME_TRY(Database::inspect(options.url));
  note_record_flaw(database);
  const Comparison* comparison = nullptr;
  if (!options.robot.empty()) {
    const Robot robot = MNEME_TRY(load_named_robot(options.robot, options.robot_options));
    const RobotDifference difference = compare_robots(database.signature(), make_signature(robot));
    comparison = &*std::ranges::find(kComparisons, difference, &Comparison::difference);
  }
  if (options.is_json) {
    Json json = to_json(database.info());
    if (comparison != nullptr) json["difference"] = comparison->word;
    print_json(json);
    return ExitCode::done;
  }
  print_info(database.info());
  if (comparison != nullptr) fmt::print("{:<12}  {}\n", options.robot, comparison->sentence);
  return ExitCode::done;
}

// list

Json to_json(const Experience& row) {
  return {{"id", row.id},
          {"kind", row.kind},
          {"key", row.key},
          {"components", row.component_count()},
          {"seed", row.provenance.seed},
          {"time", row.provenance.time},
          {"tool", row.provenance.tool},
          {"settings", row.provenance.settings}};
}

void print_row(const Experience& row) {
  fmt::print("{:>8}  {:<12}  {:>8.4f}  {:>10}  {:>20}  {}\n", row.id, printable(row.kind),
             fmt::join(row.key, " "), row.component_count(), row.provenance.seed,
             row.provenance.time);
}

Result<void> visit_first(const Database& database, std::int64_t count,
                         const std::function<void(const Experience&)>& visit) {
  for (std::int64_t i = 0; i < count; ++i) {
    const Experience row = MNEME_TRY(database.get(i));
    visit(row);
  }
  return {};
}

Result<ExitCode> run_list(const DbOptions& options) {
  const Database database = MNEME_TRY(Database::inspect(options.url));
  const std::int64_t count = std::min(options.limit.value_or(database.size()), database.size());
  if (options.is_json) {
    Json rows = Json::array();
    const auto listed =
        visit_first(database, count, [&](const Experience& row) { rows.push_back(to_json(row)); });
    if (!listed) return tl::unexpected(listed.error());
    print_json({{"samplers", database.size()}, {"rows", rows}});
    return ExitCode::done;
  }
  const std::vector<KindInfo> kinds = database.kinds();
  const bool has_circles = kinds.size() == 1 && kinds.front().kind == circles().version;
  fmt::print("{:>8}  {:<12}  {:<53}  {:>10}  {:>20}  {}\n", "id", "kind",
             has_circles ? "key (x y r x y r)" : "key", "components", "seed", "time");
  MNEME_TRY(visit_first(database, count, print_row));
  if (count < database.size()) fmt::print("and {} more\n", database.size() - count);
  return ExitCode::done;
}

// query

/// Primitives to look up among the rows of one kind.
struct Lookup {
  const MemoryKind* kind = nullptr;
  std::vector<LocalPrimitive> primitives;
};

bool has_kind(const std::vector<KindInfo>& kinds, std::string_view wanted) {
  return std::ranges::any_of(kinds, [&](const KindInfo& kind) { return kind.kind == wanted; });
}

Result<std::vector<Lookup>> look_up_key(const DbOptions& options, const Database& database) {
  const std::vector<KindInfo> kinds = database.kinds();
  if (kinds.empty() || has_kind(kinds, circles().version)) {
    return std::vector<Lookup>{{&circles(), {make_primitive(*options.key)}}};
  }
  return fail(ErrorCode::invalid,
              fmt::format("'{}' has keys of kind {}, --key is two circles; expected --problem",
                          database.info().url, printable(kinds.front().kind)));
}

Result<std::vector<Lookup>> queried_primitives(const DbOptions& options, const Database& database) {
  if (options.key) return look_up_key(options, database);
  const auto given = MNEME_TRY(problem_options(options.robot, options.robot_options));
  const Problem problem = MNEME_TRY(read_problem(options.problem, given));
  if (compare_robots(database.signature(), make_signature(problem.robot)) >
      RobotDifference::shapes) {
    return fail(ErrorCode::wrong_robot,
                fmt::format("'{}' holds experience of the robot '{}' (kinematics {}), the problem "
                            "is for '{}' (kinematics {})",
                            database.info().url, database.signature().robot_name,
                            database.signature().kinematics_hash, problem.robot.name(),
                            problem.robot.kinematics_hash()));
  }
  std::vector<Lookup> lookups;
  for (const KindInfo& info : database.kinds()) {
    const MemoryKind* kind = memory_kind_of(info.kind);
    if (kind == nullptr) continue;
    const double max_gap = options.settings.memory.max_gap.value_or(kind->defaults.max_gap);
    auto primitives = MNEME_TRY(kind->decompose(memory_query(problem), max_gap));
    lookups.push_back({kind, std::move(primitives)});
  }
  return lookups;
}

Json to_json(const Match& match) {
  return {{"id", match.experience->id},
          {"similarity_error", match.similarity_error},
          {"components", match.experience->component_count()},
          {"key", match.experience->key},
          {"rotation", match.to_scene.rotation},
          {"is_mirrored", match.to_scene.is_mirrored}};
}

void print_matches(const LocalPrimitive& primitive, const std::vector<Match>& matches) {
  fmt::print("{} {:.4f}", primitive.is_whole_query ? "query" : "primitive",
             fmt::join(primitive.key, " "));
  if (!primitive.is_whole_query) fmt::print(", gap {:.4f} m", primitive.gap);
  fmt::print(": {}\n", counted(matches.size(), "match", "matches"));
  for (const Match& match : matches) {
    fmt::print("  id {}, similarity error {:.4f} {}, {} components", match.experience->id,
               match.similarity_error, unit_of_error(primitive),
               match.experience->component_count());
    if (!primitive.is_whole_query) fmt::print(", turned by {:.4f} rad", match.to_scene.rotation);
    fmt::print("{}\n", match.to_scene.is_mirrored ? ", mirrored" : "");
  }
}

/// Prints what is like the primitives, or adds it to `found`.
Result<void> print_lookup(const DbOptions& options, const Database& database, const Lookup& lookup,
                          Json& found) {
  const SolveSettings& settings = options.settings;
  const MemoryDefaults& defaults = lookup.kind->defaults;
  const MatchLimits limits{settings.similarity.value_or(defaults.similarity),
                           settings.max_matches.value_or(defaults.max_matches),
                           settings.mirror.value_or(true)};
  for (const LocalPrimitive& primitive : lookup.primitives) {
    const auto matches = MNEME_TRY(find_matches(database, *lookup.kind, primitive, limits));
    if (!options.is_json) print_matches(primitive, matches);
    Json rows = Json::array();
    for (const Match& match : matches) rows.push_back(to_json(match));
    found.push_back({{"kind", lookup.kind->version},
                     {"key", primitive.key},
                     {"gap", primitive.gap},
                     {"matches", rows}});
  }
  return {};
}

Result<ExitCode> run_query(const DbOptions& options) {
  const Database database = MNEME_TRY(Database::inspect(options.url));
  const auto lookups = MNEME_TRY(queried_primitives(options, database));
  Json found = Json::array();
  for (const Lookup& lookup : lookups) {
    MNEME_TRY(print_lookup(options, database, lookup, found));
  }
  if (options.is_json) print_json({{"primitives", found}});
  return ExitCode::done;
}

void read_key(const std::string& text, DbOptions& options) {
  options.key = parse_numbers("--key", text);
  if (options.key->size() != 6) {
    throw CLI::ValidationError(
        "--key", fmt::format("has {} numbers; expected x,y,r of two circles, which the kind pairs "
                             "stores; --problem is for all kinds",
                             options.key->size()));
  }
  for (std::size_t i = 0; i < options.key->size(); ++i) {
    const double number = (*options.key)[i];
    const bool is_radius = i % 3 == 2;
    if (std::isfinite(number) && (!is_radius || number > 0)) continue;
    throw CLI::ValidationError(
        "--key", fmt::format("{} is no {} in metres", number, is_radius ? "radius" : "length"));
  }
}

void check_query_flags(const CLI::App&, DbOptions& options) {
  if (options.key.has_value() == options.problem.empty()) return;
  throw CLI::RequiredError("either --key or --problem");
}

}  // namespace

void add_db(CLI::App& program, Action& action) {
  CLI::App& group =
      add_group(program, "db", "Inspect and maintain a database", "db info planar.db");
  const auto options = std::make_shared<DbOptions>();
  CLI::App& info = add_command(group, action, "info", "Show robot, kinds, number of rows and size",
                               "db info planar.db --json", options, run_info);
  CLI::App& list = add_command(group, action, "list", "List the rows",
                               "db list planar.db --limit 10", options, run_list);
  CLI::App& query = add_command(group, action, "query", "Find stored primitives similar to others",
                                "db query planar.db --key 3,1,1.2,3,-1.5,1 --similarity 3", options,
                                run_query, check_query_flags);
  for (CLI::App* command : {&info, &list, &query}) {
    command->add_option("URL", options->url, "SQLite file, or postgresql://...")->required();
    add_json(*command, options->is_json);
  }
  info.add_option("--robot", options->robot, "show how this robot differs: URDF file or name");
  add_robot_flags(info, options->robot_options);
  add_number(list, "--limit", options->limit, 0, std::numeric_limits<std::int64_t>::max(),
             "rows to print (default: all)");
  add_text(
      query, "--key", [options](const std::string& text) { read_key(text, *options); },
      "two circles, metres; for a database of the kind pairs")
      ->type_name("X,Y,R,X,Y,R");
  query.add_option("--problem", options->problem,
                   "problem whose primitives are looked up: YAML file, or FILE.json#NAME");
  add_other_robot(query, options->robot, options->robot_options);
  add_settings(query, options->settings, {"similarity", "max-matches", "mirror"});
  add_settings(query, options->settings.memory);
  add_db_upkeep(group, action);
}

}  // namespace mneme::app
