# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/result_tables.py with a program that answers as `mneme bench report --json` does."""
import json
import lzma
import stat
import subprocess
import sys

import pytest
from tools_of_source import TOOLS

TIMES = {f"{time}_{name}_s": value for time, factor in (("planning", 1), ("total", 2))
         for name, value in (("p50", 0.0001234 * factor), ("mean", 0.02 * factor), ("p95", 0.2 * factor),
                             ("p99", 4.0), ("max", 4.0))}


def summary(name, setting):
    return {"set": name, "planner": "rrt_connect", "sampler": "gl", "setting": setting, "solved": 98, "valid": 100,
            "total": 120, "invalid_paths": 1, "iterations_p50": 12, "states_p50": 345, "simplification_p50_s": 0.001,
            "path_length_mean": 6.789, **TIMES}


def ratio(value, **marks):
    return {"value": value, "low": 1, "high": 20.06, "is_at_least": False, "is_at_most": False, **marks}


ANSWER = {"sets": [summary("cage", "a b"), summary("box", "c"), summary("all", "c")],
          "ratios": [{"set": "cage", "this": "rrt_connect, gl", "against": "rrt_connect, uniform", "pairs": 100,
                      "p50": ratio(3.14159), "p95": ratio(2, is_at_least=True),
                      "p99": ratio(2, is_at_least=True, is_at_most=True), "mean": ratio(5), "geometric": ratio(5)}]}


@pytest.fixture(name="source")
def make_source(tmp_path):
    """A source tree with one file of rows, and a program beside it that counts how often it is asked."""
    folder = tmp_path / "bench" / "results"
    folder.mkdir(parents=True)
    (tmp_path / "docs").mkdir()
    (tmp_path / "README.md").write_text("nothing measured\n", encoding="utf-8")
    with lzma.open(folder / "mbm.csv.xz", "wt") as rows:
        rows.write("problem,machine\n1,\"a, b\"\n")
    (folder / "mbm.json").write_text(json.dumps({"command": "`mneme bench run x`", "commit": "abc", "machine": "m"}),
                                     encoding="utf-8")
    program = tmp_path / "mneme"
    program.write_text(f"#!/bin/sh\ngrep -q 'a, b' \"$3\" || exit 9\ncat <<'END'\n{json.dumps(ANSWER)}\nEND\n", encoding="utf-8")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return tmp_path


def run(source, *flags):
    return subprocess.run([sys.executable, "-B", TOOLS / "result_tables.py", source, source / "mneme", *flags],
                          capture_output=True, text=True, check=False)


def written(source, marker):
    """The lines of docs/a.md between the markers, once they are written."""
    page = source / "docs" / "a.md"
    page.write_text(f"before\n<!-- {marker} -->\nold\n<!-- /rows -->\nafter\n", encoding="utf-8")
    done = run(source)
    assert done.returncode == 0, done.stderr
    lines = page.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "before" and lines[-1] == "after"
    return [line for line in lines[2:-2] if line]


def test_rows_become_a_line_each_with_failures_marked(source):
    lines = written(source, "rows mbm by=set,setting show=solved,bad,p50,mean,p95,p99,length,states")
    assert lines[0] == "| set | setting | solved | bad paths | p50 ms | mean ms | p95 ms | p99 ms | mean length | states p50 |"
    assert lines[2] == "| cage | a b | 98 of 100 | 1 | 0.12 | >20.0 | 200 | >4000 | 6.79 | 345 |"
    assert len(lines) == 7
    assert lines[-2:] == ["From:", "- `mneme bench run x`, commit abc, m"]


def test_a_marker_may_end_on_a_line_of_its_own(source):
    assert "| a b | 0.12 |" in written(source, "rows mbm by=setting show=p50\nwhere=setting:a_b\n")


def test_a_table_that_is_not_closed_is_refused(source):
    (source / "docs" / "a.md").write_text("<!-- rows mbm by=setting show=p50 -->\n<!-- /row -->\n", encoding="utf-8")
    done = run(source, "--check")
    assert done.returncode == 1 and "docs/a.md: a table is not closed" in done.stderr


def test_gains_have_intervals_over_tasks_and_count_slower_pairs(source):
    rows = ["set,problem,setting,planning_time_s,is_valid"]
    for task, (base, this) in enumerate([(0.002, 0.001), (0.004, 0.001), (0.003, 0.006)]):
        rows += [f"a,t{task}_1,planned,{base},1", f"a,t{task}_1,asked,{this},1"]
    with lzma.open(source / "bench" / "results" / "mbm.csv.xz", "wt") as packed:
        packed.write("\n".join(rows) + "\n")
    line = written(source, "difficulty mbm show=tasks,p50_gain,mean_gain,slower baseline=planned")[3]
    assert line == "| 1 to 10 ms | asked | 3 | 3 (0.5 to 4) | 1.12 (0.5 to 4) | 1 of 3 |"


def test_gains_that_contain_failures_are_bounds(source):
    rows = ["set,problem,setting,planning_time_s,timeout_s,is_valid"]
    for task in range(5):
        rows += [f"a,t{task}_1,planned,0.004,0.004,{int(task != 0)}", f"a,t{task}_1,asked,0.002,0.004,1",
                 f"a,t{task}_1,replayed,0.002,0.002,{int(task < 2)}"]
    with lzma.open(source / "bench" / "results" / "mbm.csv.xz", "wt") as packed:
        packed.write("\n".join(rows) + "\n")
    lines = written(source, "difficulty mbm show=p50_gain,mean_gain,geometric_gain baseline=planned")
    assert lines[3] == "| 1 to 10 ms | asked | 2 (2 to 2) | ≥ 2 (2 to 2) | ≥ 2 (2 to 2) |"
    assert lines[4].startswith("| 1 to 10 ms | replayed | ≤ 2 (2 to 2) | open | open |")


def test_rows_count_the_runs_that_used_memory(source):
    rows = ["set,planner,sampler,setting,status,retrieval_time_s,replayed,total_time_s,timeout_s,is_valid",
            'cage,rrt_connect,gl,"a b",solved,0.001,0,0.003,4,1', 'cage,rrt_connect,gl,"a b",solved,0,7,0.001,4,1',
            'cage,rrt_connect,gl,"a b",invalid start,0.1,3,9,4,0', 'box,rrt_connect,gl,c,solved,0,,0.003,0.004,0', '"a, b",x,x,x,solved,0,0,0,4,1']
    with lzma.open(source / "bench" / "results" / "mbm.csv.xz", "wt") as packed:
        packed.write("\n".join(rows) + "\n")
    lines = written(source, "rows mbm by=set show=retrieved,replayed where=set!all")
    assert lines[0] == "| set | retrieved | replayed |"
    assert lines[2:-2] == ["| cage | 1 of 100 | 1 of 100 |", "| box | 0 of 100 | 0 of 100 |"]
    assert written(source, "rows mbm by=set show=mean time=total where=set!all")[2:-2] == ["| cage | >2.00 |", "| box | >4.00 |"]


def test_gains_of_used_memory_stand_beside_runs_that_did_not_query_it(source):
    rows = ["set,problem,seed,planner,sampler,setting,status,planning_time_s,retrieval_time_s,replayed,is_valid"]
    for seed in range(1, 13):
        rows += [f"a,p,{seed},rrt_connect,uniform,planned,solved,0.004,0,0,1",
                 f'a,p,{seed},rrt_connect,gl,"asked, arm",solved,{0.002 if seed > 2 else 0.005},{0.001 if seed > 2 else 0},0,1']
    with lzma.open(source / "bench" / "results" / "mbm.csv.xz", "wt") as packed:
        packed.write("\n".join(rows) + "\n")
    lines = written(source, "used mbm show=pairs,p50_gain,geometric_gain,slower baseline=planned")
    assert lines[0] == "|  | memory | pairs | p50 gain | geometric gain | slower pairs |"
    assert lines[2:-2] == ["| asked | queried | 10 | 2 (2 to 2) | 2 (2 to 2) | 0 of 10 |",
                           "| asked | not queried | 2 | 0.8 (0.8 to 0.8) | 0.8 (0.8 to 0.8) | 2 of 2 |"]
    by_set = written(source, "used mbm by=set show=pairs,slower baseline=uniform")
    assert by_set[0] == "|  | set | pairs | slower pairs |" and by_set[2] == "| asked | a | 12 | 2 of 12 |"


def test_total_times_and_a_choice_of_rows(source):
    lines = written(source, "rows mbm by=setting show=p50 time=total where=setting:a_b")
    assert lines[2:-2] == ["| a b | 0.25 |"]


def test_alternatives_and_exceptions(source):
    assert written(source, "rows mbm by=setting show=p50 where=setting:c|a_b where=set:cage|box")[2:-2] == [
        "| a b | 0.12 |", "| c | 0.12 |"]
    assert written(source, "rows mbm by=setting show=p50 where=set!box|all")[2:-2] == ["| a b | 0.12 |"]
    assert written(source, "rows mbm by=setting show=p50 where=setting~x|b")[2:-2] == ["| a b | 0.12 |"]


def test_several_files_have_a_line_each_over_all_sets(source):
    lines = written(source, "rows mbm mbm by=setting show=p50")
    assert lines[2:-2] == ["| mbm | c | 0.12 |"] * 2


def test_ratios_have_intervals_and_bounds(source):
    lines = written(source, "ratios mbm show=pairs,p50,p95,p99")
    assert lines[2] == ("| cage | rrt_connect, gl | rrt_connect, uniform | 100 | 3.14 (1 to 20.1) | ≥ 2 (1 to 20.1) | open |")
    both = written(source, "ratios mbm mbm show=pairs")
    assert both[0] == "|  | set | this | against | pairs |"
    assert both[2:-2] == ["| mbm | cage | rrt_connect, gl | rrt_connect, uniform | 100 |"] * 2


def test_problems_are_binned_by_what_the_baseline_needs(source):
    rows = ["set,problem,setting,planning_time_s,timeout_s,is_valid"]
    rows += [f"a,1,planned,{time},5,1" for time in (0.002, 0.003, 0.5)]
    rows += ["a,2,planned,0.001,5,0", '"a",1,"asked, arm",0.001,5,1', '"a",2,"asked, arm",0.02,5,1']
    with lzma.open(source / "bench" / "results" / "mbm.csv.xz", "wt") as packed:
        packed.write("\n".join(rows) + "\n")
    lines = written(source, "difficulty mbm show=tasks,p50_gain,mean_gain,slower baseline=planned")
    assert lines[0] == "| planned needs |  | tasks | p50 gain | mean gain | slower pairs |"
    assert lines[2:4] == ["| 1 to 10 ms | planned | 1 |  |  |  |",
                          "| 1 to 10 ms | asked | 1 | 3 (3 to 3) | 168 (168 to 168) | 0 of 1 |"]
    lines = written(source, "difficulty mbm show=solved,p50,mean,p95 baseline=planned")
    assert lines[0] == "| planned needs |  | solved | p50 ms | mean ms | p95 ms |"
    assert lines[2:-2] == ["| 1 to 10 ms | planned | 3 of 3 | 3 | 168 | 500 |", "| 1 to 10 ms | asked | 1 of 1 | 1 | 1 | 1 |",
                           "| 1000 ms and more | planned | 0 of 1 | 5000 | 5000 | 5000 |",
                           "| 1000 ms and more | asked | 1 of 1 | 20 | 20 | 20 |"]


def test_problems_are_binned_by_total_times(source):
    rows = ["set,problem,setting,planning_time_s,total_time_s,is_valid", "a,1,planned,0.002,0.03,1", "a,1,asked,0.001,0.04,1"]
    with lzma.open(source / "bench" / "results" / "mbm.csv.xz", "wt") as packed:
        packed.write("\n".join(rows) + "\n")
    lines = written(source, "difficulty mbm show=p50 baseline=planned time=total")
    assert lines[2:-2] == ["| 10 to 100 ms | planned | 30 |", "| 10 to 100 ms | asked | 40 |"]


def test_a_baseline_that_there_is_not_is_a_mistake(source):
    page = source / "docs" / "a.md"
    with lzma.open(source / "bench" / "results" / "mbm.csv.xz", "wt") as packed:
        packed.write("set,problem,setting,planning_time_s,is_valid\na,1,planned,1,1\n")
    page.write_text("<!-- difficulty mbm show=p50 baseline=none -->\n<!-- /rows -->\n", encoding="utf-8")
    done = run(source)
    assert done.returncode != 0
    assert "expected one of planned" in done.stdout + done.stderr


def test_a_stale_document_fails_the_check_and_is_left_alone(source):
    written(source, "rows mbm by=set show=p50")
    assert run(source, "--check").returncode == 0
    page = source / "docs" / "a.md"
    stale = page.read_text(encoding="utf-8").replace("0.12", "0.11")
    page.write_text(stale, encoding="utf-8")
    done = run(source, "--check")
    assert done.returncode == 1
    assert "a.md: differs from its rows" in done.stdout
    assert page.read_text(encoding="utf-8") == stale


def test_a_table_has_at_most_15_lines(source):
    (source / "docs" / "a.md").write_text(f"<!-- rows {'mbm ' * 16}show=p50 -->\n<!-- /rows -->\n", encoding="utf-8")
    done = run(source)
    assert done.returncode == 1
    assert "16 lines; choose at most 15 with where=" in done.stderr


def test_long_origins_are_wrapped(source):
    origin = {"command": "`mneme bench run x` " * 8, "commit": "abc", "machine": "m"}
    (source / "bench" / "results" / "mbm.json").write_text(json.dumps(origin), encoding="utf-8")
    assert all(len(line) <= 100 for line in written(source, "rows mbm by=set show=p50"))


@pytest.mark.parametrize("marker, message", [
    ("rows other by=set show=p50", "other.csv.xz: there is no such file of rows"),
    ("rows mbm by=set", "expected show="),
    ("rows mbm show=p50 shwo=p95", "'shwo=p95': expected by="),
    ("rows mbm show=p50 where=set:nowhere", "no rows are meant")])
def test_mistakes_name_document_and_word(source, marker, message):
    (source / "docs" / "a.md").write_text(f"<!-- {marker} -->\n<!-- /rows -->\n", encoding="utf-8")
    done = run(source)
    assert done.returncode == 1
    assert "docs/a.md" in done.stderr and message in done.stderr


def test_rows_are_added_with_what_made_them(source):
    rows = source / "new.csv"
    rows.write_text("problem,machine\n1,\"a, b\"\n", encoding="utf-8")
    assert run(source, "--add", "new", rows, "--command", "c", "--commit", "r", "--note", "n").returncode == 0
    folder = source / "bench" / "results"
    assert lzma.open(folder / "new.csv.xz", "rt").read() == rows.read_text(encoding="utf-8")
    assert json.loads((folder / "new.json").read_text(encoding="utf-8")) == {
        "command": "c", "commit": "r", "machine": "a, b", "note": "n"}


def test_rows_of_several_runs_become_one_file(source):
    for name in "ab":
        (source / f"{name}.csv").write_text(f"problem,machine\n{name},m\n", encoding="utf-8")
    done = run(source, "--add", "both", source / "a.csv", source / "b.csv", "--command", "c", "--commit", "r")
    assert done.returncode == 0, done.stderr
    assert lzma.open(source / "bench" / "results" / "both.csv.xz", "rt").read() == "problem,machine\na,m\nb,m\n"


def test_rows_of_other_columns_are_refused(source):
    (source / "a.csv").write_text("problem,machine\na,m\n", encoding="utf-8")
    (source / "b.csv").write_text("problem,set,machine\na,s,m\n", encoding="utf-8")
    done = run(source, "--add", "both", source / "a.csv", source / "b.csv", "--command", "c", "--commit", "r")
    assert done.returncode == 1
    assert "b.csv: its columns differ" in done.stderr


def test_what_a_program_printed_stands_as_it_is_with_its_command(source):
    (source / "soak.log").write_text("robot  plans\nfetch     12   \n", encoding="utf-8")
    assert run(source, "--add", "soak", source / "soak.log", "--command", "`soak`", "--commit", "r").returncode == 0
    assert written(source, "output soak")[:4] == ["```text", "robot  plans", "fetch     12", "```"]
    text = (source / "docs" / "a.md").read_text(encoding="utf-8")
    assert "- `soak`, commit r, " in text and "hardware threads" in text
    assert run(source, "--check").returncode == 0


def test_wide_output_is_narrowed_and_folded(source):
    (source / "wide.log").write_text(f"a{' ' * 60}1{' ' * 60}x\nbb{' ' * 59}2{' ' * 60}{'y ' * 60}\n", encoding="utf-8")
    assert run(source, "--add", "wide", source / "wide.log", "--command", "`w`", "--commit", "r").returncode == 0
    lines = written(source, "output wide")
    assert lines[1] == "a  1 x" and lines[2].startswith("bb 2 y y") and lines[3].startswith("    y y")
    assert all(len(line) <= 100 for line in lines)


def test_output_that_there_is_not_is_a_mistake(source):
    (source / "docs" / "a.md").write_text("<!-- output none -->\n<!-- /rows -->\n", encoding="utf-8")
    done = run(source, "--check")
    assert done.returncode == 1
    assert "none.txt: No such file or directory" in done.stderr


def test_difficulty_of_some_sets_only(source):
    with lzma.open(source / "bench" / "results" / "mbm.csv.xz", "wt") as packed:
        packed.write("set,problem,setting,planning_time_s,is_valid\na,1,planned,0.00005,1\nb,1,planned,5,1\n")
    lines = written(source, "difficulty mbm show=solved baseline=planned where=set:a")
    assert lines[2:-2] == ["| 0 to 0.1 ms | planned | 1 of 1 |"]


def test_a_memory_is_paid_for_by_what_its_queries_gain(source):
    folder = source / "bench" / "results"
    with lzma.open(folder / "mbm.csv.xz", "wt") as packed:
        packed.write("set,problem,setting,settings,status,planning_time_s,retrieval_time_s,timeout_s,is_valid\n")
        packed.writelines(f"a,{i},no memory,range=1,solved,0.03,0,0.5,1\na,{i},grid,range=1 memory=first 12,solved,0.01,{i * 5e-5},0.5,1\n"
                          for i in range(2))
        packed.write("a,3,grid,range=1 memory=first 12,invalid_start,5,1,0.5,0\na,1,worse,memory=large,solved,0.01,0,0.5,0\n")
    (folder / "mbm.memories.csv").write_text("name,primitives,components,bytes,learning_time_s\nfirst 12,12,99,2500000,1.5\n"
                                             "large,800,9,1,2\nthere already,1,1,1,0\nunused,1,1,1,3\n", encoding="utf-8")
    lines = written(source, "cost mbm baseline=no_memory")
    assert lines[0] == "| memory | setting | rows | components | MB | s to learn | retrieval ms | mean ms | gained after |"
    assert lines[2:-2] == ["| first 12 | grid | 12 | 99 | 2.50 | 1.5 | 0.05 | 30 → 10 | 75 queries |",
                           "| large | worse | 800 | 9 | 0.00 | 2 | none | 30 → 500 | never |"]


def test_growth_sums_total_times_with_failures_at_their_limit(source):
    rows = ["set,problem,setting,total_time_s,timeout_s,is_valid,replayed"]
    rows += [f"a,{i},planned,1,9,1,0" for i in range(3)] + ["a,0,kept,2,9,1,0", "a,1,kept,0.1,4,0,7", "a,2,kept,0.5,9,1,7"]
    with lzma.open(source / "bench" / "results" / "mbm.csv.xz", "wt") as packed:
        packed.write("\n".join(rows) + "\n")
    lines = written(source, "growth mbm show=1,3 baseline=planned")
    assert lines[2] == "| a | kept | 2 of 3 | 1 → 2 | 3 → 6.5 | 0.462 | not yet |"
    for count in ("4", "0", "all"):
        (source / "docs" / "a.md").write_text(f"<!-- growth mbm show={count} baseline=planned -->\n<!-- /rows -->\n", encoding="utf-8")
        done = run(source)
        assert done.returncode == 1 and "set a: expected show= of numbers from 1 to 3" in done.stderr


def test_two_programs_are_compared_on_the_problems_of_both(source):
    folder = source / "bench" / "results"
    head = "set,problem,status,is_valid,planning_time_s,total_time_s,path_length,timeout_s\n"
    with lzma.open(folder / "mbm.csv.xz", "wt") as packed:
        packed.write(head)
        packed.writelines(f"a,{i},solved,1,0.001,0.01,{length},4\n" for i in range(9) for length in (1, 2, 6))
        packed.write("a,9,solved,0,0.001,0.01,0,4\n")
    with lzma.open(folder / "other.csv.xz", "wt") as packed:
        packed.write(head)
        packed.writelines(f"a,{i},solved,1,{0.002 if i < 8 else 0.5},0.03,3,4\n" for i in range(10))
        packed.write("a,elsewhere,solved,1,9,9,9,4\na,2,invalid_start,0,9,9,9,4\n")
    (folder / "other.json").write_text(json.dumps({"command": "other", "commit": "", "machine": "m"}), encoding="utf-8")
    lines = written(source, "beside mbm:other show=pairs,p50,p95,length")
    assert lines[0] == "|  | pairs | p50 | p95 | mean length |"
    cells = lines[2].split(" | ")
    assert cells[:3] == ["| mbm:other", "10", "2 (2 to 2)"]
    assert cells[3].startswith("0.125 (") and cells[4] == "1.5 (1.5 to 1.5) |"
    assert lines[4:] == ["- `mneme bench run x`, commit abc, m", "- other, m"]
    assert "| mbm:other | 3 (" in "\n".join(written(source, "beside mbm:other show=p50 time=total"))


ORIGINS = sorted((TOOLS.parent / "bench" / "results").glob("*.json"))


def git(*words):
    return subprocess.run(["git", "-C", TOOLS.parent, *words], capture_output=True, text=True, check=False)


@pytest.mark.skipif(git("rev-parse", "--is-shallow-repository").stdout.strip() != "false", reason="needs the whole history")
@pytest.mark.parametrize("path", ORIGINS, ids=lambda path: path.stem)
def test_rows_name_a_commit_of_this_history_or_say_that_it_is_none(path):
    origin = json.loads(path.read_text(encoding="utf-8"))
    is_there = not origin["commit"] or git("merge-base", "--is-ancestor", origin["commit"], "HEAD").returncode == 0
    assert is_there != ("commit not in this history" in origin.get("note", ""))
