// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/query.h"
#include "support/kinds.h"
#include "support/lifting_arm.h"

#include <limits>

namespace mneme::test {
namespace {

using internal::KindSettings;
using internal::Query;

Database open_of(const std::string& path, const Robot& robot) {
  return require(Database::open(path, make_signature(robot), OpenMode::create));
}

/// Settings and kinds for the robot; its problem is gone.
struct Completed {
  SolveSettings settings;
  std::vector<KindSettings> kinds;
};
Result<Completed> request(const Robot& robot, Database* database,
                          const SolveSettings& settings = {}) {
  const Problem problem{.robot = robot};
  return internal::make_query(problem, database, settings).map([](const Query& query) {
    return Completed{query.settings, query.kinds};
  });
}

/// Settings of the first kind of memory that a query of an empty database uses.
KindSettings completed(const Robot& robot, const SolveSettings& settings = {}) {
  const TemporaryDirectory directory;
  Database database = open_of(directory / "m.db", robot);
  const auto made = require(request(robot, &database, settings));
  REQUIRE(!made.kinds.empty());
  return made.kinds.front();
}

Problem one_post() {
  Scene scene;
  scene.obstacles.push_back({"post", {Sphere{{0, 9, 0}, 0.5}}});
  return {"one", planar8(), {}, scene, Configuration(8, 0.0), {Configuration(8, 0.1)}, {}};
}

/// Why the query is refused.
Error refusal(const SolveSettings& settings) {
  const Problem problem = one_post();
  return require_error(internal::make_query(problem, nullptr, settings));
}

}  // namespace

TEST_SUITE("unit") {
  TEST_CASE("what is left out gets the defaults of planar arms or of arms in space") {
    const KindSettings planar = completed(planar8());
    CHECK(planar.kind->name == "pairs");
    CHECK(planar.sigma == 0.03);
    CHECK(planar.matches.similarity == 2);
    CHECK(planar.retrieve_after == 1000);
    CHECK(planar.widening.first == 1e9);
    CHECK(planar.lambda == 0.5);
    CHECK(planar.least_lambda == 0.02);
    CHECK(planar.retarget);
    CHECK(planar.matches.max_matches == 8);
    CHECK(planar.matches.mirror);
    CHECK(planar.drop_invalid_means);
    const KindSettings spatial = completed(lifting_arm());
    CHECK(spatial.kind->name == "body_pairs");
    CHECK(spatial.sigma == 0.3);
    CHECK(spatial.matches.similarity == 0.05);
    CHECK(spatial.retrieve_after == 1500);
    CHECK(spatial.widening.first == 20);
    CHECK_FALSE(spatial.drop_invalid_means);
    CHECK_FALSE(spatial.retarget);
  }

  TEST_CASE("the kind that was asked for decides, otherwise those that the database holds") {
    const Robot robot = lifting_arm();
    SolveSettings settings;
    settings.memory.kind = "paths";
    CHECK(completed(robot, settings).matches.max_matches == 50);
    CHECK(completed(robot, settings).lambda == 0.7);
    SolveSettings remembering;
    remembering.remember_after = 0;
    const TemporaryDirectory directory;
    Database database = open_of(directory / "m.db", robot);
    const auto remembered = require(request(robot, &database, remembering));
    REQUIRE(remembered.kinds.size() == 2);
    CHECK(remembered.kinds[0].kind->name == "paths");
    CHECK(remembered.kinds[1].kind->name == "motions");
    const Configuration q(static_cast<std::size_t>(robot.joint_count()));
    REQUIRE(database.insert(learn_whole_paths(robot, std::vector<Path>{{q, q}})));
    const auto found = require(request(robot, &database));
    REQUIRE(found.kinds.size() == 1);
    CHECK(found.kinds[0].kind->name == "paths");
    CHECK(found.kinds[0].sigma == 0.4);
    settings.memory.kind = "body_pairs";
    CHECK(request(robot, &database, settings)->kinds[0].sigma == 0.3);
  }

  TEST_CASE("what is set stays, also drop-invalid-means where it does not help") {
    SolveSettings settings;
    settings.sigma = 0.01;
    settings.similarity = 1e-300;
    settings.retrieve_after = 0;
    settings.first_components = 1;
    settings.lambda = 0.25;
    settings.max_matches = 3;
    settings.mirror = false;
    settings.drop_invalid_means = true;
    settings.retarget = false;
    for (const Robot& robot : {planar8(), lifting_arm()}) {
      const KindSettings complete = completed(robot, settings);
      CHECK(complete.sigma == 0.01);
      CHECK(complete.matches.similarity == 1e-300);
      CHECK(complete.retrieve_after == 0);
      CHECK(complete.widening.first == 1);
      CHECK(complete.widening.growth == settings.component_growth / 0.25);
      CHECK(complete.lambda == 0.25);
      CHECK(complete.matches.max_matches == 3);
      CHECK_FALSE(complete.matches.mirror);
      CHECK(complete.drop_invalid_means);
      CHECK(!complete.retarget);
    }
  }

  TEST_CASE("what a budget is to learn is asked for at once") {
    SolveSettings settings;
    settings.learn_budget_s = 1;
    CHECK(completed(planar8(), settings).retrieve_after == 0);
    settings.retrieve_after = 7;
    CHECK(completed(planar8(), settings).retrieve_after == 7);
  }

  TEST_CASE("lambda falls for pairs, to a floor that may be set, and stays for others") {
    SolveSettings settings;
    settings.planner = "prm";
    CHECK(completed(planar8(), settings).least_lambda < completed(planar8(), settings).lambda);
    CHECK(completed(lifting_arm(), settings).least_lambda ==
          completed(lifting_arm(), settings).lambda);
    settings.least_lambda = 0.11;
    CHECK(completed(planar8(), settings).least_lambda == 0.11);
    CHECK(completed(lifting_arm(), settings).least_lambda == 0.11);
  }

  TEST_CASE("beside escape walks pairs are asked later and drawn from less, unless it is set") {
    SolveSettings settings;
    CHECK(completed(planar8(), settings).lambda == 0.5);
    settings.plan.walk = 0.3;
    CHECK(completed(planar8(), settings).lambda == 0.5);
    settings.plan.walk = 0;
    CHECK(completed(planar8(), settings).lambda == 0.8);
    settings = {};
    settings.planner = "rrt";
    CHECK(completed(planar8(), settings).lambda == 0.8);
    settings.planner = "rrt_connect";
    settings.lambda = 0.9;
    CHECK(completed(planar8(), settings).lambda == 0.9);
  }

  TEST_CASE("a similarity of zero still finds the key itself") {
    SolveSettings settings;
    settings.similarity = 0;
    CHECK(completed(planar8(), settings).matches.similarity > 0);
  }

  TEST_CASE("the settings that say that their default depends on the kind are those of the table") {
    std::vector<std::string> declared, listed;
    const auto note = [&](const std::string& name, const auto&, auto, auto,
                          const std::string& text) {
      if (contains(text, "Default: by kind (see table)")) declared.push_back(name);
    };
    const SolveSettings settings;
    visit_settings(settings, note);
    visit_settings(settings.memory, note);
    for (const KindDefault& row : kind_defaults()) listed.emplace_back(row.setting);
    std::ranges::sort(declared);
    std::ranges::sort(listed);
    CHECK(declared == listed);
  }

  TEST_CASE("the paper's mode fills in what nobody set; any mode is found by its name") {
    for (const MemoryMode mode : {MemoryMode::automatic, MemoryMode::off, MemoryMode::paper}) {
      CHECK(parse_memory_mode(to_string(mode)).value() == mode);
    }
    CHECK(!parse_memory_mode("on").has_value());
    SolveSettings settings;
    CHECK(!with_memory_mode(settings).sigma.has_value());
    settings.memory_mode = MemoryMode::paper;
    settings.lambda = 0.7;
    const SolveSettings paper = with_memory_mode(settings);
    CHECK(paper.lambda == 0.7);
    CHECK(paper.least_lambda == 0.7);
    CHECK(paper.similarity == 3);
    CHECK(paper.mirror == false);
    CHECK(paper.learn.walks == false);
    CHECK(paper.retarget == false);
    CHECK(paper.plan.walk == 0);
    CHECK(paper.plan.anchor == 0.0);
    settings.plan.anchor = 0.8;
    CHECK(with_memory_mode(settings).plan.anchor == 0.8);
  }

  TEST_CASE("memory that is off is not queried") {
    const TemporaryDirectory directory;
    const Problem problem = one_post();
    Database database = open_of(directory / "m.db", problem.robot);
    SolveSettings settings;
    settings.remember_after = 0;
    CHECK(internal::make_query(problem, &database, settings)->database == &database);
    settings.memory_mode = MemoryMode::off;
    CHECK(internal::make_query(problem, &database, settings)->database == nullptr);
    CHECK(check_query(problem, settings).has_value());
  }

  TEST_CASE("a number out of range is named, in whatever part of the settings it is") {
    const Robot robot = planar8();
    CHECK(request(robot, nullptr).has_value());
    SolveSettings settings;
    settings.lambda = 1.5;
    CHECK(request(robot, nullptr, settings).error().message ==
          "setting 'lambda' is 1.5: expected 0 to 1");
    settings = {};
    settings.plan.timeout_s = std::numeric_limits<double>::quiet_NaN();
    CHECK(contains(request(robot, nullptr, settings).error().message, "'timeout'"));
    settings = {};
    settings.learn.starts_per_link = 0;
    CHECK(request(robot, nullptr, settings).error().code == ErrorCode::invalid);
    settings = {};
    settings.memory.max_gap = -1;
    CHECK(contains(request(robot, nullptr, settings).error().message, "'max-gap'"));
  }

  TEST_CASE("a budget for learning goes with kinds that learn on a miss, or is refused with why") {
    const TemporaryDirectory directory;
    const Robot robot = planar8();
    Database database = open_of(directory / "m.db", robot);
    SolveSettings settings;
    settings.learn_budget_s = 1;
    CHECK(request(robot, &database, settings).has_value());
    settings.memory.kind = "pairs";
    CHECK(request(robot, &database, settings).has_value());
    for (const char* name : {"paths", "body_pairs"}) {
      settings.memory.kind = name;
      const Error refused = require_error(request(robot, &database, settings));
      CHECK(refused.code == ErrorCode::unsupported);
      CHECK(contains(refused.message, "'learn-budget'"));
      CHECK(contains(refused.message, name));
    }
  }

  TEST_CASE("a budget for learning needs a sampler that queries memory") {
    const TemporaryDirectory directory;
    const Problem problem = one_post();
    Database database = open_of(directory / "m.db", problem.robot);
    SolveSettings settings;
    settings.learn_budget_s = 1;
    CHECK(internal::make_query(problem, &database, settings).has_value());
    settings.sampler = "uniform";
    const Error refused = require_error(internal::make_query(problem, &database, settings));
    CHECK(refused.code == ErrorCode::invalid);
    CHECK(
        refused.message ==
        "setting 'learn-budget': sampler 'uniform' does not query memory, expected one that does, "
        "such as gl");
    CHECK(internal::make_query(problem, nullptr, settings).has_value());
  }

  TEST_CASE("a query is refused before a memory is made for it as with one that is empty") {
    const Problem problem = one_post();
    SolveSettings settings;
    settings.learn_budget_s = 1;
    CHECK(check_query(problem, settings).has_value());
    const auto refuses = [&](const std::string& words) {
      const TemporaryDirectory directory;
      Database database = open_of(directory / "m.db", problem.robot);
      const auto early = check_query(problem, settings);
      const auto late = internal::make_query(problem, &database, settings);
      REQUIRE((!early.has_value() && !late.has_value()));
      CHECK(early.error().message == late.error().message);
      CHECK_MESSAGE(contains(early.error().message, words), early.error().message);
    };
    settings.memory.kind = "paths";
    refuses("cannot learn while planning");
    settings.sampler = "uniform";
    refuses("does not query memory");
    settings.sampler = "nobody";
    refuses("unknown sampler");
    settings = {};
    settings.sampler = "uniform";
    settings.memory.kind = "pairs";
    settings.replay = 1;
    refuses("holds no whole paths");
    settings.replay = 0;
    CHECK(check_query(problem, settings).has_value());
  }

  TEST_CASE("a kind of memory that does not handle the robot is refused before a memory is made") {
    const Robot robot = lifting_arm();
    const Configuration start = robot.normalized(Configuration(4, 0));
    Problem problem{.name = "lift", .robot = robot, .start = start, .goals = {start}};
    SolveSettings settings;
    settings.sampler = "gl";
    CHECK(check_query(problem, settings).has_value());
    settings.memory.kind = "pairs";
    CHECK(contains(require_error(check_query(problem, settings)).message, "does not handle robot"));
    // That start is the planner's to refuse.
    problem.start = {0};
    CHECK(check_query(problem, settings).has_value());
  }

  TEST_CASE("unknown planners, samplers and kinds are errors that list the known ones") {
    SolveSettings settings;
    settings.sampler = "halto";
    CHECK(refusal(settings).message.find("unknown sampler 'halto': expected one of gl, uniform") ==
          0);
    settings = {};
    settings.planner = "rrt_star";
    CHECK(contains(refusal(settings).message, "expected one of rrt_connect"));
    const TemporaryDirectory directory;
    Database database = open_of(directory / "a.db", planar8());
    settings = {};
    settings.memory.kind = "triples";
    const Error refused = require_error(request(planar8(), &database, settings));
    CHECK(refused.code == ErrorCode::invalid);
    CHECK(contains(refused.message, "'triples'"));
  }

  TEST_CASE("samplers of valid states are refused with planners that draw none") {
    const SamplerEntry near_walls = {
        .name = "near_walls", .summary = "valid states only", .samples_valid_states = true};
    add_samplers({&near_walls, 1});
    SolveSettings settings;
    settings.sampler = "near_walls";
    const Error error = refusal(settings);
    CHECK(error.code == ErrorCode::invalid);
    CHECK(contains(error.message, "'near_walls'"));
  }

  TEST_CASE("a database of the robot will do, one of another robot is refused with both") {
    const TemporaryDirectory directory;
    const Robot planar = planar8(), spatial = lifting_arm();
    Database own = open_of(directory / "own.db", planar);
    CHECK(request(planar, &own).has_value());
    Database foreign = open_of(directory / "a.db", spatial);
    const Error refused = require_error(request(planar, &foreign));
    CHECK(refused.code == ErrorCode::wrong_robot);
    for (const std::string& word : {directory / "a.db", planar.name(), spatial.name(),
                                    planar.kinematics_hash(), spatial.kinematics_hash()}) {
      CHECK_MESSAGE(contains(refused.message, word), refused.message);
    }
  }

  TEST_CASE("an empty file that is only looked at is of every robot") {
    const TemporaryDirectory directory;
    write_file(directory / "a.db", "");
    auto database = require(Database::inspect(directory / "a.db"));
    CHECK(request(planar8(), &database).has_value());
    CHECK(request(lifting_arm(), &database).has_value());
  }

  TEST_CASE("the checker has the resolution, margin and instruction set of the settings") {
    const Problem problem = one_post();
    SolveSettings settings;
    settings.resolution = 0.125;
    settings.isa = Isa::scalar;
    const auto query = require(internal::make_query(problem, nullptr, settings));
    const auto checker = internal::resolve_goals(query)->checker;
    CHECK(checker.resolution() == 0.125);
    CHECK(checker.isa() == Isa::scalar);
    CHECK(checker.is_valid(problem.start));
    settings.margin = 10;
    const auto wary = require(internal::make_query(problem, nullptr, settings));
    const auto refused = internal::resolve_goals(wary);
    REQUIRE((refused.has_value() && refused->refusal));
    CHECK(refused->refusal->status == PlanStatus::invalid_start);
    settings.margin = -1;
    CHECK(contains(refusal(settings).message, "'margin'"));
  }

  TEST_CASE("only samplers of memory use the database") {
    const TemporaryDirectory directory;
    const Problem problem = one_post();
    Database foreign = open_of(directory / "a.db", lifting_arm());
    SolveSettings settings;
    settings.sampler = "uniform";
    CHECK(internal::make_query(problem, &foreign, settings).has_value());
    settings.sampler = "gl";
    CHECK(!internal::make_query(problem, &foreign, settings).has_value());
  }
}

}  // namespace mneme::test
