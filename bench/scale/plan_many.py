#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Throughput of plan_many().

usage: plan_many.py PROBLEMS.json .. [--every N] [--seeds N] [--dt SECONDS]

Plans every N-th problem of compact files without memory: paths with their proofs, then also trajectories that are
sampled every dt seconds, as fast as mneme makes them, and those of shortest paths that are timed once. Rates are per
second of one core, from the time that the process took of all cores, so that other work on the machine does not count.
"""
import argparse
import time

import mneme


def measure(problems, seeds, what, **settings):
    begin = time.process_time()
    runs = [mneme.plan_many(problems, seed=seed, **settings) for seed in range(1, seeds + 1)]
    seconds = time.process_time() - begin
    solved = sum(int(plans.is_solved.sum()) for plans in runs)
    print(f"{what}: {solved} of {seeds * len(problems)}, {solved / seconds:.0f} per second of a core")
    return runs[0]


def mean_duration(plans):
    ends = plans.trajectory_offsets[1:][plans.is_solved]
    return plans.times[ends - 1].mean()


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--dt", type=float, default=0.02)
    arguments = parser.parse_args()
    problems = []
    for file in arguments.files:
        for name in mneme.list_problems(file)[::arguments.every]:
            robot = {"robot": problems[0].robot} if problems else {}
            problems.append(mneme.Problem.load(f"{file}#{name}", **robot))
    mneme.plan_many(problems)  # caches
    measure(problems, arguments.seeds, "paths with proof")
    plans = measure(problems, arguments.seeds, f"with trajectories every {arguments.dt} s", dt=arguments.dt)
    simple = measure(problems, arguments.seeds, "the same of shortest paths, timed once", dt=arguments.dt,
                     minimize_time=False, time_rounds=0)
    print(f"mean duration: {mean_duration(plans):.3f} s, of shortest paths {mean_duration(simple):.3f} s")
    print(f"rows per trajectory: {len(plans.times) / max(1, int(plans.is_solved.sum())):.0f}")


if __name__ == "__main__":
    main()
