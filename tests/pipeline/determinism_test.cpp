// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

// The scalar kernels compute the same on every machine, and those of four lanes are meant to: a
// path is a matter of problem, planner, sampler and seed alone. A hash that changes says that
// planners now find other paths: intended, then the new one is put here; or not.
#include "support/planar_memory.h"

#include <bit>
#include <map>

namespace mneme::test {
namespace {

/// FNV-1a (Fowler, Noll and Vo) over the bits of all values.
std::uint64_t hash_of(const Path& path, std::uint64_t hash = 0xcbf29ce484222325) {
  for (const Configuration& q : path) {
    for (const double value : q) {
      const auto bits = std::bit_cast<std::uint64_t>(value);
      for (int byte = 0; byte < 8; ++byte) {
        hash = (hash ^ (bits >> (8 * byte) & 0xff)) * 0x100000001b3;
      }
    }
  }
  return hash;
}

SolveSettings scalar_settings() {
  SolveSettings settings;
  settings.isa = Isa::scalar;
  settings.sampler = "uniform";
  settings.retrieve_after = 0;
  // The paper's way to use memory.
  settings.retarget = false;
  settings.lambda = settings.least_lambda = 0.5;
  settings.similarity = 0.5;
  settings.sigma = 0.05;
  settings.plan.timeout_s = 600;
  settings.plan.max_iterations = 200000;
  return settings;
}

Path solve_or_fail(const Problem& problem, Database* database, const SolveSettings& settings) {
  const SolveResult result = require_solved(problem, database, settings);
  // Without whole turns, which depend on the start alone.
  Path path = result.plan.path;
  for (Configuration& q : path) q = problem.robot.normalized(q);
  return path;
}

/// Remembers one path of the problem.
Database memory_of(const Problem& problem, const std::string& path) {
  Database database = make_database(path, problem.robot);
  const Path solved = solve_or_fail(problem, nullptr, scalar_settings());
  auto rows = require(learn_from_paths(memory_query(problem), std::vector<Path>{solved}, {}, 0.3));
  REQUIRE(!rows.empty());
  require(database.insert(std::move(rows)));
  return database;
}

using Hashes = std::vector<std::uint64_t>;

/// Hashes of the paths of each sampler with the seeds 1 and 2.
Hashes hashes_of(const Problem& problem, Database* database, const std::string& planner,
                 const std::vector<std::string>& samplers) {
  Hashes hashes;
  SolveSettings settings = scalar_settings();
  settings.planner = planner;
  for (const std::string& sampler : samplers) {
    settings.sampler = sampler;
    for (settings.plan.seed = 1; settings.plan.seed <= 2; ++settings.plan.seed) {
      hashes.push_back(hash_of(solve_or_fail(problem, database, settings)));
    }
  }
  return hashes;
}

void check_hashes(const std::string& planner, const Hashes& hashes, const Hashes& expected) {
  std::string text = planner + ":";
  for (const std::uint64_t hash : hashes) text += " " + std::to_string(hash) + "u,";
  CHECK_MESSAGE(hashes == expected, text);
}

/// Two posts in the way of a stretched arm that turns.
Problem posts_problem() {
  const Robot robot = planar8();
  Configuration goal(8, 0.0);
  goal[0] = 2.2;
  const Scene scene = make_circle_scene("posts", {{5, 3, 1.2}, {0, 5, 1}});
  return {"posts", robot, "", scene, Configuration(8, 0.0), {goal}, {}};
}

Problem shelf_problem() {
  ProblemOptions options;
  options.robot_path = source_file("robots/fetch.urdf");
  return require(load_problem(source_file("scenes/shelf/pair_1.yaml"), options));
}

/// Continues a hash with the paths for each problem of a compact file with 29 seeds. A goal may be
/// in collision.
std::uint64_t hash_of_file(const std::string& file, SolveSettings settings, std::uint64_t hash) {
  ProblemOptions options;
  options.cache = make_problem_cache();
  const auto names = require(list_problems(file));
  for (const std::string& name : names) {
    const auto problem = require(load_problem(file + "#" + name, options));
    for (settings.plan.seed = 1; settings.plan.seed <= 29; ++settings.plan.seed) {
      hash = hash_of(require(solve(problem, nullptr, settings)).plan.path, hash);
    }
  }
  return hash;
}

/// The settings of a user who wants the same path on all machines.
SolveSettings portable_settings() {
  SolveSettings settings = scalar_settings();
  settings.isa = require(parse_isa("portable"));
  return settings;
}

TEST_SUITE("law") {
  TEST_CASE("the scalar build finds these paths, on every machine and for ever") {
    // By planner: with the samplers gl, uniform and halton, with the seeds 1 and 2.
    const std::map<std::string, Hashes> pinned = {
        {"rrt_connect",
         {17929143196130008764u, 3846255900381727089u, 16144877084738226534u, 8905985735743367088u,
          5967511877110690791u, 10151032021123483498u}},
        {"rrt",
         {4566973410270784599u, 14876599470801492753u, 4128432729969683693u, 15338293600795778573u,
          8213027827691685086u, 14140159299064543842u}},
    };
    const Problem problem = planar_problem("scenario1");
    const TemporaryDirectory directory;
    Database database = memory_of(problem, directory / "a.db");
    for (const auto& [planner, expected] : pinned) {
      check_hashes(planner, hashes_of(problem, &database, planner, {"gl", "uniform", "halton"}),
                   expected);
    }
  }

  TEST_CASE("the scalar build finds these roadmaps, and these paths into a shelf") {
    const std::vector<std::string> samplers = {"uniform", "halton"};
    check_hashes(
        "prm among posts", hashes_of(posts_problem(), nullptr, "prm", samplers),
        {11775617237093501588u, 1023727384166591074u, 1704543064777175747u, 10790311700856421707u});
    const Problem shelf = shelf_problem();
    check_hashes(
        "rrt_connect into the shelf", hashes_of(shelf, nullptr, "rrt_connect", samplers),
        {6788620448324343057u, 9958062941868992155u, 8638878264258135849u, 17896275528611945827u});
    check_hashes("prm into the shelf", hashes_of(shelf, nullptr, "prm", samplers),
                 {15353257639813416777u, 15709377787276092377u, 16447457403971500263u,
                  4822427047001798638u});
  }

  TEST_CASE("four lanes find these paths") {
    Hashes hashes;
    for (const Problem& problem : {planar_problem("scenario1"), shelf_problem()}) {
      hashes.push_back(hash_of(solve_or_fail(problem, nullptr, portable_settings())));
    }
    check_hashes("portable", hashes, {9900697082179753274u, 16922945929629456024u});
  }

  TEST_CASE("four lanes find these 10150 paths for Panda") {
    std::uint64_t hash = hash_of({});
    for (const char* set : {"bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage",
                            "table_pick", "table_under_pick"}) {
      const auto file = data_file(std::string("mbm/panda/") + set + ".json");
      if (!file) return;
      hash = hash_of_file(*file, portable_settings(), hash);
    }
    check_hashes("portable for Panda", {hash}, {11658538742398638337u});
  }

  TEST_CASE("what one, two and eight threads learn leads to the same path") {
    const Problem problem = planar_problem("threaded_b2");
    const auto primitives = require(decompose(memory_query(problem)));
    const std::vector<PrimitiveKey> keys = keys_near(primitives[0].key, 12, 0.1, 4);
    const TemporaryDirectory directory;
    std::vector<std::uint64_t> hashes;
    for (const int jobs : {1, 2, 8}) {
      Database database = make_database(directory / (std::to_string(jobs) + ".db"), problem.robot);
      LearnJob job;
      job.settings = cheap_settings();
      job.jobs = jobs;
      require(learn_primitives(problem.robot, keys, database, job));
      SolveSettings settings = scalar_settings();
      settings.sampler = "gl";
      settings.plan.max_iterations = 1000000;
      hashes.push_back(hash_of(solve_or_fail(problem, &database, settings)));
    }
    CHECK(hashes[0] == hashes[1]);
    CHECK(hashes[0] == hashes[2]);
  }
}

}  // namespace
}  // namespace mneme::test
