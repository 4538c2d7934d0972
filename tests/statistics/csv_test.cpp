// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/statistics.h"

#include "statistics/bench_support.h"
#include "statistics/csv.h"

#include <doctest/doctest.h>

namespace mneme::internal {
namespace {

using test::require;

TEST_SUITE("unit") {
  TEST_CASE("Fields end at commas, lines at line feeds, unless they are quoted") {
    const std::string text = "a,\"b,\"\"c\"\"\nd\",\ne,f\n";
    const auto first = require(read_csv_record(text, 0));
    CHECK(first.fields == std::vector<std::string>{"a", "b,\"c\"\nd", ""});
    const auto second = require(read_csv_record(text, first.end));
    CHECK(second.fields == std::vector<std::string>{"e", "f"});
    CHECK(second.end == text.size());
    CHECK_FALSE(read_csv_record(text, second.end).has_value());
  }

  TEST_CASE("A line without an end is none") {
    CHECK_FALSE(read_csv_record("a,b", 0).has_value());
    CHECK_FALSE(read_csv_record("a,\"b\n", 0).has_value());
  }

  TEST_CASE("A number is all of its field") {
    double number = 0;
    CHECK(read_csv_number("1.5e3", number));
    CHECK(number == 1500);
    CHECK_FALSE(read_csv_number("1.5x", number));
    CHECK_FALSE(read_csv_number("", number));
    for (const char* text : {"nan", "inf", "-inf", "-1", "1e400"}) {
      CHECK_FALSE(read_csv_number(text, number));
    }
    int whole = 0;
    CHECK_FALSE(read_csv_number("-1", whole));
    CHECK_FALSE(read_csv_number("1.5", whole));
  }
}

}  // namespace

}  // namespace mneme::internal

namespace mneme {
namespace {

using test::contains;
using test::require;
using test::run;

BenchmarkRow strange_row() {
  BenchmarkRow row = run(0.25);
  row.problem = "a,\"b\"\nc";
  row.set = "s";
  row.seed = 3;
  row.is_path_valid = false;
  row.total_time_s = 0.5;
  row.retrieval_time_s = 0.125;
  row.simplification_time_s = 1e-5;
  row.verification_time_s = 0.0625;
  row.iterations = 10;
  row.states_checked = 20;
  row.motions_checked = 30;
  row.nodes = 40;
  row.path_length = 1.5;
  row.components = 4;
  row.timeout_s = 2;
  row.setting = "as, is";
  row.settings = "range=3.55 memory=grid";
  row.learning_time_s = 0.75;
  row.isa = "avx2";
  row.machine = "a machine";
  row.version = "mneme 1";
  row.started = "2026-01-31T12:00:00Z";
  row.improvements = {{0, 2.5}, {0.0012, 1.5}};
  row.replayed = 12;
  row.duration_s = 1.25;
  row.is_warm = true;
  return row;
}

std::string parse_failure(const std::string& text) {
  const auto runs = parse_csv(text, "f.csv");
  return runs ? "" : runs.error().message;
}

TEST_SUITE("unit") {
  TEST_CASE("There is a header and one line per run, with fields quoted where they must be") {
    CHECK(to_csv(std::vector{strange_row()}) ==
          "problem,set,planner,sampler,seed,status,is_valid,planning_time_s,total_time_s,"
          "retrieval_time_s,simplification_time_s,verification_time_s,iterations,states_checked,"
          "motions_checked,nodes,path_length,components,timeout_s,setting,settings,"
          "learning_time_s,isa,machine,version,started,improvements,replayed,duration_s,is_warm\n"
          "\"a,\"\"b\"\"\nc\",s,rrt_connect,gl,3,solved,0,0.25,0.5,0.125,1e-05,0.0625,10,20,30,40,"
          "1.5,4,2,\"as, is\",range=3.55 memory=grid,0.75,avx2,a machine,mneme 1,"
          "2026-01-31T12:00:00Z,0:2.5 0.0012:1.5,12,1.25,1\n");
    CHECK(to_csv(std::vector<BenchmarkRow>{}) == csv_header());
  }

  TEST_CASE("What was written reads back, and a broken last line is left aside") {
    BenchmarkRow failed = run(10, false);
    failed.status = PlanStatus::invalid_goal;
    const std::string text = to_csv(std::vector{strange_row(), failed});
    const CsvRuns whole = parse_csv(text, "f.csv").value();
    CHECK(whole.complete_bytes == text.size());
    REQUIRE(whole.rows.size() == 2);
    CHECK(to_csv(whole.rows) == text);
    CHECK(whole.rows[0].is_solved);
    CHECK_FALSE(whole.rows[1].is_solved);
    const std::size_t second = text.size() - to_csv_line(failed).size();
    for (std::size_t size = second; size < text.size(); ++size) {
      const CsvRuns cut = parse_csv(text.substr(0, size), "f.csv").value();
      CHECK(cut.rows.size() == 1);
      CHECK(cut.complete_bytes == second);
    }
    CHECK(parse_csv("problem,se", "f.csv").value().complete_bytes == 0);
  }

  TEST_CASE("Files of other columns and fields that are no numbers are refused") {
    CHECK(parse_failure("a,b\n").find("f.csv:1: expected the columns problem,set,planner,") == 0);
    std::string text = to_csv(std::vector{run(1)});
    CHECK(parse_failure(text + "a,b\n") == "f.csv: line 3: expected 30 fields, got 2");
    const std::size_t status = text.rfind("solved");
    CHECK(parse_failure(text.replace(status, 6, "dreamt")) ==
          "f.csv: line 2: column status: expected a status, got \"dreamt\"");
    text.replace(text.rfind(",,0,,"), 5, ",,x,,");
    CHECK(
        parse_failure(text.replace(status, 6, "solved")) ==
        "f.csv: line 2: column learning_time_s: expected a finite number of 0 or more, got \"x\"");
  }

  TEST_CASE("Numbers that no run can have are refused") {
    const auto refusal = [](auto&& change) {
      BenchmarkRow row = run(1);
      change(row);
      return parse_failure(to_csv(std::vector{row}));
    };
    const std::string finite = "expected a finite number of 0 or more, got ";
    CHECK(refusal([](BenchmarkRow& row) { row.planning_time_s = -5; }) ==
          "f.csv: line 2: column planning_time_s: " + finite + "\"-5\"");
    CHECK(refusal([](BenchmarkRow& row) { row.path_length = INFINITY; }) ==
          "f.csv: line 2: column path_length: " + finite + "\"inf\"");
    CHECK(refusal([](BenchmarkRow& row) { row.total_time_s = NAN; }) ==
          "f.csv: line 2: column total_time_s: " + finite + "\"nan\"");
    CHECK(refusal([](BenchmarkRow& row) { row.components = -1; }) ==
          "f.csv: line 2: column components: expected a whole number of 0 or more, got \"-1\"");
    std::string text = to_csv(std::vector{run(1)});
    text.replace(text.rfind("solved,") + 7, 1, "2");
    CHECK(parse_failure(text) == "f.csv: line 2: column is_valid: expected 0 or 1, got \"2\"");
    for (const char* wrong : {"1", "0:1  0:1", "a:1", "0:-1", "0:1,"}) {
      BenchmarkRow row = strange_row();
      row.improvements.clear();
      std::string line = to_csv(std::vector{row});
      std::size_t end = line.size();  // of the column, which three others follow
      for (int i = 0; i < 3; ++i) end = line.rfind(',', end - 1);
      line.insert(end, std::string("\"") + wrong + "\"");
      CHECK(parse_failure(line) ==
            "f.csv: line 2: column improvements: expected SECONDS:LENGTH pairs of numbers of 0 or "
            "more, got \"" +
                std::string(wrong) + "\"");
    }
  }

  TEST_CASE("Files that end with the column timeout_s, as older versions wrote them, read too") {
    const std::string old =
        "problem,set,planner,sampler,seed,status,is_valid,planning_time_s,total_time_s,"
        "retrieval_time_s,simplification_time_s,verification_time_s,iterations,states_checked,"
        "motions_checked,nodes,path_length,components,timeout_s\n"
        "a,s,rrt,gl,3,solved,1,0.25,0.5,0.125,1e-05,0.0625,10,20,30,40,1.5,4,2\n";
    const auto runs = require(parse_csv(old, "f.csv"));
    REQUIRE(runs.rows.size() == 1);
    CHECK(runs.rows[0].timeout_s == 2);
    CHECK(runs.rows[0].setting.empty());
    CHECK(runs.complete_bytes == old.size());
  }

  TEST_CASE("So do those that end before the column improvements") {
    std::string old = to_csv(std::vector{run(1)});
    const std::string columns = ",improvements,replayed,duration_s,is_warm";
    old.erase(old.find(columns), columns.size()).erase(old.rfind(",,0,0,0"), 7);
    const auto runs = require(parse_csv(old, "f.csv"));
    REQUIRE(runs.rows.size() == 1);
    CHECK(runs.rows[0].planning_time_s == 1);
    CHECK(runs.rows[0].improvements.empty());
  }

  TEST_CASE("So do those that end before the column replayed") {
    std::string old = to_csv(std::vector{run(1)});
    const std::string columns = ",replayed,duration_s,is_warm";
    old.erase(old.find(columns), columns.size()).erase(old.rfind(",0,0,0"), 6);
    CHECK(require(parse_csv(old, "f.csv")).rows.at(0).replayed == 0);
  }

  TEST_CASE("So do those that end before the column duration_s") {
    std::string old = to_csv(std::vector{run(1)});
    const std::string columns = ",duration_s,is_warm";
    old.erase(old.find(columns), columns.size()).erase(old.rfind(",0,0"), 4);
    CHECK(require(parse_csv(old, "f.csv")).rows.at(0).duration_s == 0);
  }

  TEST_CASE("So do those that end before the column is_warm, whose runs were cold") {
    std::string old = to_csv(std::vector{run(1)});
    const std::string column = ",is_warm";
    old.erase(old.find(column), column.size()).erase(old.rfind(",0"), 2);
    CHECK(describe_timing(require(parse_csv(old, "f.csv")).rows) == "cold");
  }
}

TEST_SUITE("unit") {
  TEST_CASE("What was written of memories reads back") {
    const std::vector<MemoryRow> rows = {{"a, \"b\"", 800, 105838, 5200000, 13.25},
                                         {"c", 0, 0, 1, 0}};
    const std::string text = to_csv(rows);
    const auto read = require(parse_memory_csv(text, "m.csv"));
    CHECK(to_csv(read) == text);
    CHECK(read[0].components == 105838);
    CHECK(read[0].learning_time_s == 13.25);
  }

  TEST_CASE("Files of other columns and broken lines are refused") {
    CHECK(parse_memory_csv("x\n", "m.csv").error().message.find("m.csv:1: expected the columns") ==
          0);
    const std::string text = to_csv(std::vector<MemoryRow>{{"a", 1, 2, 3, 4}});
    CHECK(parse_memory_csv(text + "b,1,x,3,4\n", "m.csv").error().message ==
          "m.csv: line 3: column components: expected a whole number of 0 or more, got \"x\"");
    for (const char* time : {"nan", "inf", "-1"}) {
      CHECK_FALSE(parse_memory_csv(text + "b,1,2,3," + time + "\n", "m.csv").has_value());
    }
    CHECK(contains(parse_memory_csv(text + "b,1\n", "m.csv").error().message, "line 3"));
  }
}

}  // namespace

}  // namespace mneme
