# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""bench(): problems x planners x samplers x seeds."""
import html
import operator
import os

from . import _mneme
from ._connections import make_error


class Benchmark:
    """The runs of a benchmark. A run without a valid path counts as slower than all others."""

    def __init__(self, rows):
        self.rows = rows

    def table(self):
        """Returns a line of text per problem, planner and sampler; planning times in ms."""
        return _mneme._to_table(self.rows)

    def to_csv(self):
        """Returns a header and a line per run, as `mneme bench run --csv` writes them."""
        return _mneme._csv_header() + "".join(map(_mneme._to_csv_line, self.rows))

    def __len__(self):
        return len(self.rows)

    def __repr__(self):
        solved = sum(row.is_solved and row.is_path_valid for row in self.rows)
        return f"<mneme.Benchmark: {solved} of {len(self.rows)} runs solved>"

    def _repr_html_(self):
        return f"<pre>{html.escape(self.table())}</pre>"


def _whole(name, value, most):
    """Returns a whole number of 0 to `most`."""
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise TypeError(f"bench: {name}={value!r:.80} is not a whole number")
    if not 0 <= operator.index(value) <= most:
        raise make_error("invalid", f"bench: {name}={value!r:.80} is out of range: expected 0 to {most}")
    return operator.index(value)


def bench(problems, database=None, *, planners=("rrt_connect",), samplers=None, seeds=1, seed=1,
          csv=None, on_row=None, **settings):
    """Plans every problem with every planner and sampler, and checks every path again.

    problems: Problem objects. samplers: default "uniform"; with a database "gl" and "uniform".
    seeds: runs of each, with seeds from `seed` on; the runs of a problem follow each other,
    so that caches are warm, and their paths are checked afterwards.
    csv: a file that gets a line after each run. The first run replaces an earlier file. It must not
    be an input file.
    on_row: called with each BenchmarkRow. settings: as for plan(), such as timeout=4.
    """
    problems = [problems] if isinstance(problems, _mneme.Problem) else list(problems)
    planners = [planners] if isinstance(planners, str) else list(planners)
    if samplers is None:
        samplers = ["uniform"] if database is None else ["gl", "uniform"]
    samplers = [samplers] if isinstance(samplers, str) else list(samplers)
    for sampler in samplers:
        if database is None and _mneme._needs_memory(sampler):
            raise TypeError(f"bench: the sampler '{sampler}' needs a database to sample from")
    seeds, seed = _whole("seeds", seeds, 2**31 - 1), _whole("seed", seed, 2**64 - 1)
    if not problems or not planners or not samplers or seeds < 1:
        raise TypeError("bench: expected at least one problem, planner, sampler and seed")
    if csv is not None:
        _mneme._check_output(os.fsdecode(csv), problems, database)
        # Fails before the first run where the file cannot be written, and keeps its rows.
        open(csv, "a", encoding="utf-8").close()
    rows = []
    file = None

    def write(line):
        # Opened late: a wrong keyword must not cost the rows of an earlier call.
        nonlocal file
        if csv is None:
            return
        if file is None:
            file = open(csv, "w", encoding="utf-8", newline="")
            file.write(_mneme._csv_header())
        file.write(line)
        file.flush()

    def take(row):
        rows.append(row)
        write(_mneme._to_csv_line(row))
        if on_row:
            on_row(row)

    try:
        _mneme._bench(problems, database, planners, samplers, seeds, seed, take, **settings)
        write("")
    finally:
        if file:
            file.close()
    return Benchmark(rows)
