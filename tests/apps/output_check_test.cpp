// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "apps/planar_files.h"
#include "statistics/bench_support.h"

namespace mneme::test {
namespace {

std::string write_some_runs(const PlanarFiles& files) {
  write_file(files / "runs.csv", to_csv(suite_rows()));
  return files / "runs.csv";
}

TEST_SUITE("unit") {
  TEST_CASE("no output is written over a memory") {
    const PlanarFiles files;
    const std::string memory = files.database(), problem = files.problem(),
                      csv = write_some_runs(files);
    const std::string before = read_file(memory);
    std::filesystem::create_symlink(memory, files / "link");
    const std::string read = "is also an input (the memory); choose another output";
    const std::string kept = "is a database of experience; choose another output";
    check_bad_inputs({
        {{"bench", "run", problem, "--db", memory, "--csv", memory}, 1, {memory, read}},
        {{"bench", "run", problem, "--csv", memory}, 1, {memory, kept}},
        {{"bench", "report", csv, "-o", memory}, 1, {memory, kept}},
        {{"plan", problem, "--db", memory, "--trace", memory}, 1, {memory, read}},
        {{"plan", problem, "--db", memory, "--view", files / "link"}, 1, {files / "link", read}},
        {{"plan", problem, "--db", files / "link", "--svg", memory}, 1, {memory, read}},
        {{"plan", problem, "--db", files / "new.db", "--learn-budget", "1", "--svg",
          files / "new.db"},
         1,
         {"new.db", read}},
        {{"plan", problem, "--svg", memory}, 1, {memory, kept}},
        {{"db", "export", memory, memory}, 1, {memory, read}},
        {{"scene", "convert", problem, "-o", memory}, 1, {memory, kept}},
        {{"scene", "threaded", "-n", "1", "-o", memory}, 1, {memory, kept}},
        {{"robot", "planar", "--links", "1,1", "-o", memory}, 1, {memory, kept}},
    });
    CHECK(read_file(memory) == before);
    CHECK_FALSE(std::filesystem::exists(files / "new.db"));
  }

  TEST_CASE("no output is written over what is read, or over another one") {
    const PlanarFiles files;
    const std::string problem = files.problem(), csv = write_some_runs(files);
    std::filesystem::create_hard_link(problem, files / "hard.yaml");
    write_file(files / "trace.json", "{}");
    write_file(files / "two.json", "{\"problems\": []}");
    const std::string before = read_file(problem);
    const std::string robot = std::filesystem::canonical(source_file("robots/planar8.urdf"));
    check_bad_inputs({
        {{"plan", problem, "--trace", problem},
         1,
         {problem, "is also an input (a file of the problem)"}},
        {{"plan", problem, "--svg", files / "hard.yaml"},
         1,
         {"hard.yaml", "is also an input (a file of the problem)"}},
        {{"plan", problem, "--trace", files / "arm.stl"}, 1, {"arm.stl", "mneme reads .stl files"}},
        {{"plan", problem, "--trace", files / "ARM.STL"}, 1, {"ARM.STL", "mneme reads .STL files"}},
        {{"plan", problem, "--view", robot}, 1, {"planar8.urdf", "is also an input (the robot)"}},
        {{"plan", problem, "--svg", files / "a", "--trace", files / "./a"},
         1,
         {"two outputs are named"}},
        {{"bench", "run", problem, "--csv", problem},
         1,
         {problem, "is also an input (a file of a problem)"}},
        {{"bench", "report", csv, "-o", csv}, 1, {csv, "is also an input (a file of runs)"}},
        {{"scene", "convert", problem, "-o", problem},
         1,
         {problem, "is also an input (a file of the scene)"}},
        {{"view", files / "trace.json", "-o", files / "trace.json"},
         1,
         {"is also an input (the trace)"}},
    });
    CHECK(read_file(problem) == before);
    CHECK_FALSE(std::filesystem::exists(files / "a"));
    require_run({"plan", problem, "--trace", "/dev/null", "--svg", "/dev/null"});
  }

  TEST_CASE("what a problem or a robot is read from is not written over, whatever it is called") {
    const PlanarFiles files;
    const std::string named = files / "named.yaml", scene = files / "scene.json",
                      srdf = files / "groups.json", compact = files / "many.json",
                      arm = files / "arm.urdf";
    const Problem problem = load_problem(files.problem()).value();
    write_file(scene, "{circles: {a: [-5.75, -1.15, 1.73], b: [-2.1, -2.85, 1.88]}}");
    write_file(srdf, "<robot name='planar8'/>");
    write_file(named, fmt::format("robot: planar8\nsrdf: groups.json\nscene: scene.json\n"
                                  "start: [{}]\ngoal: [{}]\n",
                                  fmt::join(kStart, ", "), fmt::join(kGoal, ", ")));
    write_file(compact, to_compact_json(problem, "planar8"));
    write_file(arm, read_file(source_file("robots/planar8.urdf")));
    const std::string before =
        read_file(scene) + read_file(srdf) + read_file(compact) + read_file(arm);
    const std::string kept = "is also an input (a file of the problem); choose another output";
    check_bad_inputs({
        {{"plan", named, "--trace", scene}, 1, {scene, kept}},
        {{"plan", named, "--trajectory", scene}, 1, {scene, kept}},
        {{"plan", named, "--svg", srdf}, 1, {srdf, kept}},
        {{"plan", compact + "#two", "--view", compact}, 1, {compact, kept}},
        {{"bench", "run", named, compact, "--csv", scene}, 1, {scene, "a file of a problem"}},
        {{"bench", "run", named, compact, "--csv", compact}, 1, {compact, "a file of a problem"}},
        {{"scene", "convert", named, "-o", scene},
         1,
         {scene, "is also an input (a file of the scene)"}},
        {{"scene", "repeat", compact, "--tasks", "1", "-n", "1", "-o", compact},
         1,
         {compact, "is also an input (a file of a problem)"}},
        {{"scene", "threaded", "--robot", arm, "-n", "1", "-o", arm},
         1,
         {arm, "is also an input (the robot)"}},
        {{"scene", "enclosed", "--robot", arm, "-n", "1", "-o", arm},
         1,
         {arm, "is also an input (the robot)"}},
    });
    CHECK(read_file(scene) + read_file(srdf) + read_file(compact) + read_file(arm) == before);
  }

  TEST_CASE("a suite does not write over a memory that it names") {
    const PlanarFiles files;
    std::filesystem::create_directory(files / "out");
    std::filesystem::copy_file(files.database(), files / "out/report.html");
    write_file(files / "s.yaml",
               "problems: [problem.yaml]\nmemories: {m: {file: out/report.html}}\n"
               "settings: {a: {memory: m}}\n");
    check_bad_inputs({{{"bench", "run", files / "s.yaml", "--out", files / "out"},
                       1,
                       {"report.html", "is also an input (a memory)"}}});
    require_run({"db", "info", files / "out/report.html"});
  }
}

}  // namespace
}  // namespace mneme::test
