# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""script/fuzz: what it makes of what each target printed."""
import subprocess

import pytest
from tools_of_source import TOOLS

STATISTICS = """echo 'stat::number_of_executed_units: 1000'
echo 'stat::peak_rss_mb: 97'
"""


def run_fuzz(built, **programs):
    folder = built / "tests/fuzz"
    folder.mkdir(parents=True)
    for target, text in programs.items():
        program = folder / f"fuzz_{target}"
        program.write_text(f"#!/bin/sh\n{text}")
        program.chmod(0o755)
    return subprocess.run([TOOLS.parent / "script/fuzz", "--built", built, "--runs", "1", *programs],
                          capture_output=True, text=True)


def rows_of(output):
    """{target: executions, memory, findings}; the rate depends on the machine."""
    table = output.partition("target ")[2].splitlines()[1:]
    return {name: [runs, memory, findings] for name, runs, _, memory, findings in map(str.split, table)}


def test_statistics_of_each_target_are_a_row_of_the_table(tmp_path):
    done = run_fuzz(tmp_path, csv=STATISTICS, octree=STATISTICS.replace("1000", "50"))
    assert done.returncode == 0
    assert rows_of(done.stdout) == {"csv": ["1000", "97", "0"], "octree": ["50", "97", "0"]}


def test_a_target_that_fails_is_counted_and_the_others_still_run(tmp_path):
    fails = STATISTICS + f"touch {tmp_path}/findings/csv-crash-1\nexit 77\n"
    done = run_fuzz(tmp_path, csv=fails, octree=STATISTICS)
    assert done.returncode == 1
    assert "fuzz: failed: csv" in done.stderr
    assert rows_of(done.stdout) == {"csv": ["1000", "97", "1"], "octree": ["1000", "97", "0"]}


@pytest.mark.parametrize("text", ["", "echo '3000 runs with seed 1'\n"])
def test_without_statistics_there_is_no_table(tmp_path, text):
    done = run_fuzz(tmp_path, csv=text)
    assert done.returncode == 0
    assert "executions" not in done.stdout
