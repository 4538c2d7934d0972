// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/exported.h"
#include "support/kinds.h"
#include "support/posts.h"

#include <atomic>

namespace mneme::test {
namespace {

std::vector<Problem> post_problems(const Posts& posts) {
  ProblemOptions options;
  options.robot_path = posts.robot();
  std::vector<Problem> problems;
  for (int i = 0; i < 4; ++i) {
    auto problem = require(load_problem(posts.problems() + "#" + std::to_string(i), options));
    problems.push_back(std::move(problem));
  }
  return problems;
}

Database open_paths(const std::string& path, const Robot& robot) {
  return require(Database::open(path, make_signature(robot), OpenMode::create));
}

ProblemLesson two_paths(std::uint64_t seed = 1, int jobs = 1) {
  ProblemLesson lesson;
  lesson.paths = 2;
  lesson.seed = seed;
  lesson.jobs = jobs;
  return lesson;
}

LearnSummary learn_well(std::span<const Problem> problems, Database& database,
                        const ProblemLesson& lesson) {
  return require(learn_from_problems(problems, of_kind("paths"), database, lesson));
}

}  // namespace

TEST_SUITE("law") {
  TEST_CASE("what problems teach does not depend on the number of threads") {
    const Posts posts;
    const std::vector<Problem> problems = post_problems(posts);
    std::vector<PrimitiveKey> keys;
    for (const int jobs : {1, 3}) {
      const std::string path = posts.directory / (std::to_string(jobs) + ".db");
      Database database = open_paths(path, problems.front().robot);
      const LearnSummary summary = learn_well(problems, database, two_paths(1, jobs));
      CHECK(summary.learned == 4);
      CHECK(summary.rows == 8);
      CHECK(summary.components == database.info().components);
      std::vector<PrimitiveKey> now;
      for (std::int64_t i = 0; i < database.size(); ++i) now.push_back(database.get(i)->key);
      if (keys.empty()) keys = now;
      CHECK(now == keys);
    }
    CHECK(exported(posts.directory / "1.db") == exported(posts.directory / "3.db"));
  }

  TEST_CASE("no lesson goes into the database of another robot, or leads to a pose") {
    const Posts posts;
    std::vector<Problem> problems = post_problems(posts);
    problems.erase(problems.begin() + 1, problems.end());
    Database database = open_paths(posts.directory / "one.db", problems[0].robot);
    CHECK(learn_well(problems, database, two_paths()).learned == 1);
    std::vector<Problem> others = problems;
    others[0].robot = planar8();
    CHECK(require_error(learn_from_problems(others, {}, database, two_paths())).code ==
          ErrorCode::wrong_robot);
    problems[0].goals.clear();
    problems[0].pose_goals.push_back({});
    const LearnSummary summary = learn_well(problems, database, two_paths());
    REQUIRE(summary.unsolved.size() == 1);
    CHECK(contains(summary.unsolved[0], "lessons need joint values as a goal"));
  }

  TEST_CASE("paths that are alike teach once, and count once") {
    const Posts posts;
    std::vector<Problem> problems = post_problems(posts);
    problems.erase(problems.begin() + 1, problems.end());
    problems[0].scene.obstacles.clear();
    Database database = open_paths(posts.directory / "straight.db", problems[0].robot);
    const LearnSummary summary = learn_well(problems, database, two_paths());
    CHECK(summary.rows == 1);
    CHECK(database.size() == 1);
    CHECK(summary.components == database.info().components);
  }

  TEST_CASE("a problem that is named twice teaches once, and counts once") {
    const Posts posts;
    std::vector<Problem> problems = post_problems(posts);
    problems.erase(problems.begin() + 1, problems.end());
    problems.push_back(problems[0]);
    Database database = open_paths(posts.directory / "twice.db", problems[0].robot);
    const LearnSummary summary = learn_well(problems, database, two_paths());
    CHECK(summary.learned == 2);
    CHECK(summary.empty == 0);
    CHECK(summary.rows == database.size());
    CHECK(summary.components == database.info().components);
  }

  TEST_CASE("the paths are those of solve() with uniform samples and the same seeds") {
    const Posts posts;
    const Problem problem = post_problems(posts).front();
    const auto plan = require(solve_repeatedly(problem, two_paths(7)));
    REQUIRE(plan.paths.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
      SolveSettings settings;
      settings.sampler = "uniform";
      settings.plan.seed = derive_seed(7, i);
      CHECK(solve(problem, nullptr, settings)->plan.path == plan.paths[i]);
    }
  }
}

TEST_SUITE("flow") {
  TEST_CASE("half of the problems teach what the other half is planned from") {
    const Posts posts;
    const std::vector<Problem> problems = post_problems(posts);
    Database database = open_paths(posts.directory / "a.db", problems.front().robot);
    const LearnSummary summary = learn_well(std::span(problems).first(2), database, two_paths());
    CHECK(summary.learned == 2);
    CHECK(summary.rows == 4);
    CHECK(database.get(0)->provenance.settings == "2 paths of problem " + problems[0].name);
    SolveSettings settings;
    settings.memory.kind = "paths";
    settings.retrieve_after = 0;
    for (const Problem& problem : std::span(problems).last(2)) {
      const SolveResult solved = require_solved(problem, &database, settings);
      CHECK(solved.gl.mixture->component_count() > 0);
    }
  }
}

TEST_SUITE("unit") {
  TEST_CASE("a problem whose rows another problem has taught is not learned again") {
    const Posts posts;
    std::vector<Problem> problems = post_problems(posts);
    problems.erase(problems.begin() + 1, problems.end());
    problems[0].scene.obstacles.clear();
    problems.push_back(problems[0]);
    problems[1].name = "of another name";  // the same straight path
    Database database = open_paths(posts.directory / "same.db", problems[0].robot);
    const LearnSummary first = learn_well(problems, database, two_paths());
    CHECK(first.learned == 2);
    CHECK(database.size() == 1);
    const LearnSummary second = learn_well(problems, database, two_paths());
    CHECK(second.learned == 0);
    CHECK(second.skipped == 2);
  }

  TEST_CASE("problems that taught before are skipped, another seed adds to them") {
    const Posts posts;
    const std::vector<Problem> problems = post_problems(posts);
    Database database = open_paths(posts.directory / "a.db", problems.front().robot);
    CHECK(learn_well(std::span(problems).first(2), database, two_paths()).learned == 2);
    const LearnSummary more = learn_well(problems, database, two_paths());
    CHECK(more.skipped == 2);
    CHECK(more.learned == 2);
    CHECK(database.size() == 8);
    CHECK(learn_well(problems, database, two_paths(2)).learned == 4);
    CHECK(database.size() == 16);
  }

  TEST_CASE("what was learned of another kind or of another problem is no reason to skip") {
    const Posts posts;
    std::vector<Problem> problems = post_problems(posts);
    problems.resize(1, problems[0]);
    Database database = open_paths(posts.directory / "a.db", problems[0].robot);
    const auto learned_of = [&](const MemorySettings& memory) {
      return require(learn_from_problems(problems, memory, database, two_paths())).learned;
    };
    for (const MemorySettings& memory : {of_kind("paths"), of_kind("body_pairs")}) {
      CHECK(learned_of(memory) == 1);
      CHECK(learned_of(memory) == 0);
    }
    const Problem first = problems[0];
    problems[0].start[0] += 0.01;
    CHECK(learned_of(of_kind("paths")) == 1);
    problems[0] = first;
    problems[0].goals[0][0] += 0.01;
    CHECK(learned_of(of_kind("paths")) == 1);
    problems[0] = first;
    problems[0].scene.obstacles.pop_back();
    CHECK(learned_of(of_kind("paths")) == 1);
    problems[0] = first;
    CHECK(learned_of(of_kind("paths")) == 0);
  }

  TEST_CASE("problems without a path are named, and tried again the next time") {
    const Posts posts;
    const std::vector<Problem> problems = post_problems(posts);
    Database database = open_paths(posts.directory / "a.db", problems.front().robot);
    ProblemLesson lesson = two_paths();
    lesson.timeout_s = 0;
    const LearnSummary summary = learn_well(problems, database, lesson);
    CHECK(summary.learned == 0);
    CHECK(summary.skipped == 0);
    REQUIRE(summary.unsolved.size() == 4);
    CHECK(summary.unsolved[1] == problems[1].name + ": not solved: no path within the time limit");
    CHECK(learn_well(problems, database, two_paths()).learned == 4);
  }

  TEST_CASE("a lesson that is cancelled teaches nothing more, and goes on later") {
    const Posts posts;
    const std::vector<Problem> problems = post_problems(posts);
    Database database = open_paths(posts.directory / "a.db", problems.front().robot);
    std::atomic<bool> is_cancelled = true;
    ProblemLesson lesson = two_paths();
    lesson.cancel = &is_cancelled;
    std::vector<LearnProgress> progress;
    lesson.on_progress = [&](const LearnProgress& latest) { progress.push_back(latest); };
    CHECK(learn_well(problems, database, lesson).is_cancelled);
    CHECK(database.size() == 0);
    is_cancelled = false;
    CHECK(learn_well(problems, database, lesson).learned == 4);
    REQUIRE(progress.size() >= 2);
    CHECK(progress.front().done == 0);
    CHECK(progress.back().done == 4);
    CHECK(progress.back().total == 4);
  }

  TEST_CASE("a time limit that makes no sense is an error, and so is an unknown kind") {
    const Posts posts;
    const std::vector<Problem> problems = post_problems(posts);
    Database database = open_paths(posts.directory / "a.db", problems.front().robot);
    ProblemLesson lesson = two_paths();
    lesson.timeout_s = -1;
    const Error refused =
        require_error(learn_from_problems(problems, of_kind("paths"), database, lesson));
    CHECK(refused.code == ErrorCode::invalid);
    CHECK(!learn_from_problems(problems, of_kind("none"), database, two_paths()).has_value());
    CHECK(database.size() == 0);
  }
}

}  // namespace mneme::test
