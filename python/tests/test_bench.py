# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
import threading

import numpy as np
import pytest
from conftest import raised

import mneme


def test_every_problem_meets_every_planner_sampler_and_seed(problem, blocked, tmp_path):
    seen = []
    runs = mneme.bench([problem, blocked], planners=["rrt_connect", "prm"],
                       samplers=["uniform", "halton"], seeds=2, seed=4, timeout=1e6,
                       max_iterations=400, csv=tmp_path / "runs.csv", on_row=seen.append)
    assert len(runs) == len(seen) == 16
    assert {row.seed for row in runs.rows} == {4, 5}
    assert all(row.is_path_valid for row in runs.rows if row.is_solved)
    assert (tmp_path / "runs.csv").read_text() == runs.to_csv()
    assert runs.to_csv().count("\n") == 17
    assert "prm" in runs.table()
    assert "<pre>" in runs._repr_html_()
    assert "of 16 runs solved" in repr(runs)


def test_memory_is_compared_with_none(robot, problem, memory):
    mneme.learn(robot, memory, scenes=[problem], starts_per_link=1, paths_per_start=1, jobs=1)
    runs = mneme.bench(problem, memory, seeds=3, retrieve_after=0)
    assert [row.sampler for row in runs.rows] == ["gl", "uniform"] * 3
    assert runs.rows[0].components > 0 and runs.rows[1].components == 0
    others = mneme.bench(problem, memory, samplers=["pooled", "nearest_scenes"], retrieve_after=0)
    assert all(row.components > 0 for row in others.rows)


def test_rows_are_told_to_the_caller_s_thread_whose_exceptions_end_the_benchmark(problem, tmp_path):
    threads = []

    def refuse_the_second(row):
        threads.append(threading.get_ident())
        if len(threads) == 2:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        mneme.bench(problem, seeds=3, csv=tmp_path / "runs.csv", on_row=refuse_the_second)
    assert threads == [threading.get_ident()] * 2
    assert (tmp_path / "runs.csv").read_text().count("\n") == 3


def test_wrong_benchmarks_are_errors(problem):
    with pytest.raises(TypeError, match="needs a database"):
        mneme.bench(problem, samplers="gl")
    with pytest.raises(TypeError, match="at least one"):
        mneme.bench([])
    with pytest.raises(TypeError, match="timout"):
        mneme.bench(problem, timout=1)
    assert raised(mneme.bench, problem, planners="best")[0] == "invalid"
    for wrong in ({"seeds": "1"}, {"seeds": 1.5}, {"seed": True}):
        with pytest.raises(TypeError, match="^bench: seeds?=.* is not a whole number"):
            mneme.bench(problem, **wrong)
    for wrong in ({"seeds": -1}, {"seed": -1}, {"seed": 2**64}):
        with pytest.raises(mneme.Error, match="^bench: seeds?=.* is out of range: expected 0 to "):
            mneme.bench(problem, **wrong)


def test_a_wrong_call_leaves_the_rows_of_an_earlier_one(problem, tmp_path):
    csv = tmp_path / "runs.csv"
    runs = mneme.bench(problem, csv=csv)
    with pytest.raises(TypeError, match="timout"):
        mneme.bench(problem, csv=csv, timout=1)
    assert raised(mneme.bench, problem, planners="best", csv=csv)[0] == "invalid"
    assert csv.read_text() == runs.to_csv()


def test_settings_of_a_memory_that_no_sampler_uses_are_refused(problem, memory):
    for database in (None, memory):
        kind, message = raised(mneme.bench, problem, database, samplers="uniform", replay=0.5)
        assert kind == "invalid" and "replay" in message
