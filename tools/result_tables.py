#!/usr/bin/python3
# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the measured figures of documents from what was measured, in bench/results.

usage: result_tables.py SOURCE_DIRECTORY MNEME [--check]
       result_tables.py SOURCE_DIRECTORY MNEME --add NAME FILE .. --command TEXT --commit REV [--note TEXT] [--memories FILE.csv]

bench/results/NAME.csv.xz are rows of `mneme bench run`, of one or several FILEs that end with .csv; NAME.txt is what any other
program printed, of one FILE of another ending. NAME.memories.csv is what a suite left of its memories. NAME.json says by which command, of which commit, on which machine. MNEME, which
has `bench report`, summarises rows. Documents have tables between markers, and what programs printed as it is:

  <!-- rows NAME [NAME ..] by=COLUMNS show=COLUMNS [time=total] [where=COLUMN:VALUE ..] -->
  <!-- ratios NAME [NAME ..] show=COLUMNS [baseline=SAMPLER] [where=COLUMN:VALUE ..] -->
  <!-- used NAME [NAME ..] show=COLUMNS baseline=SETTING [by=set] [time=total] [where=COLUMN:VALUE ..] -->
  <!-- difficulty NAME [NAME ..] show=COLUMNS baseline=SETTING [time=total] [where=COLUMN:VALUE ..] -->
  <!-- growth NAME show=QUERIES baseline=SETTING [where=COLUMN:VALUE ..] -->
  <!-- cost NAME baseline=SETTING -->
  <!-- beside NAME:OTHER [NAME:OTHER ..] show=COLUMNS [time=total] -->
  <!-- output NAME -->
  <!-- /rows -->

Of several NAMEs each has one line, named after it, over all of its sets. by: set, planner, sampler, setting. show of rows: solved, bad, p50, mean, p95, p99, max,
iterations, states, length, duration, simplification, retrieved, replayed (runs that queried the memory for samples, or replayed a task); of ratios: pairs, p50, p95,
p99, mean, geometric. difficulty: tasks, which are problems that `mneme scene repeat` made of one (t01_0001, t01_0002), by the baseline's median for them, with
tasks, solved, p50, mean and p95 of each setting, whose name up to a comma counts; p50_gain and mean_gain are the baseline's by its own, geometric_gain the geometric
mean of the pairs', with 95 % intervals over tasks, slower the pairs in which it took longer than the baseline. used: the same gains of each setting, apart for runs
that queried the memory and for those that ended before and computed what the baseline computed: what these differ by is noise; or by set. Its baseline may be a
sampler. growth: sums of total times after so many queries, in the order of the rows, of the baseline and of each other setting, whose name up to a comma counts, and
the query from which on it has taken less in all. cost: of each setting with a memory of its own that was learned, the first of them, what it took to learn, the
median time of retrieval where there was one, its mean planning time without (the baseline's) and with it, and after how many queries that is gained. beside: rows of
two programs on the same problems, OTHER's by NAME's, from what is the median of each problem's runs, with 95 % intervals over problems: pairs, percentiles, and
length of those that both solved. In VALUE of where _ stands for a space, and | separates alternatives; COLUMN~VALUE means lines whose COLUMN contains VALUE,
COLUMN!VALUE those whose does not. A table has at most 15 lines. With --check nothing is written: it fails if something would be.
"""
import argparse
import csv
import itertools
import json
import lzma
import math
import os
import pathlib
import platform
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import textwrap

MARKED = re.compile(r"^(?P<open><!-- (?P<kind>rows|ratios|used|difficulty|growth|cost|beside|output) (?P<words>[^>]+?)\s-->\n)(?P<text>.*?)(?P<close><!-- /rows -->\n)",
                    re.DOTALL | re.MULTILINE)
OPENED = re.compile(r"^<!-- (?:rows|ratios|used|difficulty|growth|cost|beside|output) ", re.MULTILINE)
PERCENT = {"p50": 50, "p95": 95, "p99": 99, "max": 100}
TITLES = {"bad": "bad paths", "p50_gain": "p50 gain", "mean_gain": "mean gain", "geometric_gain": "geometric gain", "slower": "slower pairs", "iterations": "iterations p50", "states": "states p50", "length": "mean length",
          "duration": "mean duration s", "simplification": "simplification p50 ms"}
RESAMPLES = 2000
MOST_LINES = 15
LEAST_UNITS = 5  # of a bootstrap
BINS_MS = (0, 0.1, 1, 10, 100, 1000, math.inf)
GAINS = ("p50_gain", "mean_gain", "geometric_gain", "slower")
RATIO_NAMES = ("set", "this", "against")
# What a row says of memory that was used.
USED = {"retrieved": lambda row: float(row["retrieval_time_s"] or 0) > 0, "replayed": lambda row: row["replayed"] not in ("", "0")}


class Mistake(Exception):
    """What a document or a file of rows says that cannot be followed."""


class Results:
    """Summaries of the files in bench/results, each made once."""

    def __init__(self, folder, mneme):
        self.folder, self.mneme, self.known = folder, mneme, {}

    def origin(self, name):
        try:
            return json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))
        except (OSError, ValueError) as problem:
            raise Mistake(f"{self.folder / name}.json: {problem}") from problem

    def summary(self, name, baseline="uniform"):
        if (name, baseline) not in self.known:
            self.known[name, baseline] = self._summarise(name, baseline)
        return self.known[name, baseline]

    def packed(self, name):
        path = self.folder / f"{name}.csv.xz"
        if not path.exists():
            raise Mistake(f"{path}: there is no such file of rows")
        return path

    def text(self, file):
        path = self.folder / file
        try:
            return path.read_text(encoding="utf-8")
        except OSError as problem:
            raise Mistake(f"{path}: {problem.strerror}") from problem

    def rows(self, name):
        with lzma.open(self.packed(name), "rt", encoding="utf-8", newline="") as source:
            return list(csv.DictReader(source))

    def _summarise(self, name, baseline):
        packed = self.packed(name)
        with tempfile.TemporaryDirectory() as scratch:
            rows = pathlib.Path(scratch, "rows.csv")
            with lzma.open(packed) as source, rows.open("wb") as target:
                shutil.copyfileobj(source, target)
            run = subprocess.run([self.mneme, "bench", "report", str(rows), "--json", "--baseline", baseline,
                                  "--output", str(pathlib.Path(scratch, "report.html"))],
                                 capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise Mistake(f"{packed}: {run.stderr.strip()}")
        return json.loads(run.stdout)


def milliseconds(seconds):
    """Three significant digits, or two decimals."""
    value = seconds * 1e3
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def cell(summary, column, time):
    if column in USED:
        return f"{summary[column]} of {summary['valid']}"
    if column in PERCENT:
        is_failure = rank(summary["valid"], column) >= summary["solved"]
        return (">" if is_failure else "") + milliseconds(summary[f"{time}_{column}_s"])
    if column == "mean":
        return (">" if summary["solved"] < summary["valid"] else "") + milliseconds(summary[f"{time}_mean_s"])
    if column == "solved":
        return f"{summary['solved']} of {summary['valid']}"
    plain = {"length": "path_length_mean", "duration": "duration_mean_s"}
    if column in plain:
        return f"{summary[plain[column]]:.2f}"
    if column == "simplification":
        return milliseconds(summary["simplification_p50_s"])
    return str(summary[{"bad": "invalid_paths", "iterations": "iterations_p50", "states": "states_p50"}.get(column, column)])


def factor(value):
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def bounded(text, is_at_least, is_at_most):
    """A ratio, marked where failures, which stand at their limit, make it a bound."""
    mark = "≥ " if is_at_least else "≤ " if is_at_most else ""
    return "open" if is_at_least and is_at_most else mark + text


def ratio_cell(ratio):
    text = f"{factor(ratio['value'])} ({factor(ratio['low'])} to {factor(ratio['high'])})"
    return bounded(text, ratio["is_at_least"], ratio["is_at_most"])


def parse(words):
    """Names, and what is said of columns."""
    names, options, where = [], {}, []
    for word in words.split():
        key, equals, value = word.partition("=")
        if not equals:
            names.append(word)
        elif key == "where":
            where.append(re.split("([:~!])", value, maxsplit=1))
        elif key in ("by", "show", "time", "baseline"):
            options[key] = value.split(",") if key in ("by", "show") else value
        else:
            raise Mistake(f"'{word}': expected by=, show=, time=, baseline= or where=")
    if not names:
        raise Mistake(f"'{words}': expected the name of a file of rows")
    return names, options, where


def is_meant(line, where):
    def holds(key, relation, values):
        text = line[key].replace(" ", "_")
        if relation == ":":
            return text in values.split("|")
        return any(value in text for value in values.split("|")) == (relation == "~")

    return all(holds(*condition) for condition in where)


def together(summary):
    sets = summary["sets"]
    return [line for line in sets if line["set"] == "all"] or sets


def add_from_rows(results, name, summary):
    """Adds to the summary's sets in how many of their runs memory was used, and means of total times."""
    runs = {}
    for row in results.rows(name):
        if not row["status"].startswith("invalid"):
            for of in (row["set"], "all"):
                runs.setdefault((of, row["planner"], row["sampler"], row["setting"]), []).append(row)
    for line in summary["sets"]:
        of_line = runs.get((line["set"], line["planner"], line["sampler"], line["setting"]), [])
        line.update({column: sum(map(is_used, of_line)) for column, is_used in USED.items()})
        line["total_mean_s"] = statistics.fmean(seconds_of(row, "total") for row in of_line) if of_line else math.nan


def row_lines(results, names, options, where):
    time = options.get("time", "planning")
    lines = []
    for name in names:
        summary = results.summary(name)
        if USED.keys() & set(options["show"]) or (time == "total" and "mean" in options["show"]):
            add_from_rows(results, name, summary)
        meant = [s for s in (together(summary) if len(names) > 1 else summary["sets"]) if is_meant(s, where)]
        head = [name] if len(names) > 1 else []
        lines += [head + [s[column] for column in options.get("by", [])] +
                  [cell(s, column, time) for column in options["show"]] for s in meant]
    unit = {column: f"{column} ms" for column in (*PERCENT, "mean")}
    titles = [""] * (len(names) > 1) + options.get("by", []) + [
        unit.get(column, TITLES.get(column, column)) for column in options["show"]]
    return titles, lines


def ratio_lines(results, names, options, where):
    lines = []
    for name in names:
        ratios = results.summary(name, options.get("baseline", "uniform"))["ratios"]
        head = [name] if len(names) > 1 else []
        lines += [head + [ratio[column] for column in RATIO_NAMES] +
                  [str(ratio["pairs"]) if column == "pairs" else ratio_cell(ratio[column]) for column in options["show"]]
                  for ratio in ratios if is_meant(ratio, where)]
    return [""] * (len(names) > 1) + [TITLES.get(column, column) for column in (*RATIO_NAMES, *options["show"])], lines


def task_of(problem):
    """The task that a problem of `mneme scene repeat` repeats; of others the problem itself."""
    return re.sub(r"(\bt[0-9]+)_[0-9]+$", r"\1", problem)


def seconds_of(row, time):
    """Planning or total time; the limit without a path that survived its check."""
    return float(row[f"{time}_time_s" if row["is_valid"] == "1" else "timeout_s"])


def times_of(rows, time):
    """Times in ms, and whether there is a path, by setting and task, of pairs of a file's name and a row."""
    times = {}
    for name, row in rows:
        if row.get("status", "").startswith("invalid"):
            continue
        task = (name, row["set"], task_of(row["problem"]))
        setting = row["setting"].partition(",")[0]
        run = (1e3 * seconds_of(row, time), row["is_valid"] == "1")
        times.setdefault(setting, {}).setdefault(task, []).append(run)
    return times


def rank(count, column):
    return max(0, math.ceil(PERCENT[column] * count / 100) - 1)


def percentile(values, column):
    return sorted(values)[rank(len(values), column)]


def resampled(ratio, units):
    """The ratio of all units, and its bootstrap interval of 95 %."""
    dice = random.Random(1)
    values = sorted(ratio(dice.choices(units, k=len(units))) for _ in range(RESAMPLES))
    return f"{factor(ratio(units))} ({factor(values[round(0.025 * RESAMPLES)])} to {factor(values[round(0.975 * RESAMPLES) - 1])})"


def gain_cell(column, runs, base):
    """Of runs and the baseline's, both by task: how many times less they take, or in how many pairs they take longer."""
    if column == "slower":
        pairs = [(this[0], that[0]) for task, these in runs.items() for this, that in zip(these, base[task])]
        return f"{sum(this > that for this, that in pairs)} of {len(pairs)}"
    sides = [[run for task in runs for run in of[task]] for of in (base, runs)]
    decisive = [sorted(side)[rank(len(side), "p50")] if column == "p50_gain" else min(side, key=lambda run: run[1]) for side in sides]
    return bounded(gain(column, runs, base), *(not is_solved for _, is_solved in decisive))


def gain(column, runs, base):
    if column == "p50_gain":
        tasks = [([time for time, _ in base[task]], [time for time, _ in these]) for task, these in runs.items()]
        return resampled(lambda drawn: percentile(sum((that for that, _ in drawn), []), "p50") /
                         percentile(sum((this for _, this in drawn), []), "p50"), tasks)
    if column == "mean_gain":
        sums = [(sum(time for time, _ in of), len(of)) for task, these in runs.items() for of in (base[task], these)]
        return resampled(lambda drawn: (sum(that[0] for that, _ in drawn) / sum(that[1] for that, _ in drawn)) /
                         (sum(this[0] for _, this in drawn) / sum(this[1] for _, this in drawn)), list(zip(sums[::2], sums[1::2])))
    logs = [(sum(math.log(that[0] / this[0]) for that, this in zip(base[task], these)), len(these)) for task, these in runs.items()]
    return resampled(lambda drawn: math.exp(sum(log for log, _ in drawn) / sum(count for _, count in drawn)), logs)


def summary_cells(by_task, base, columns):
    runs = [run for of_task in by_task.values() for run in of_task]
    for column in columns:
        if column == "tasks":
            yield str(len(by_task))
        elif column == "solved":
            yield f"{sum(is_solved for _, is_solved in runs)} of {len(runs)}"
        elif column == "mean":
            yield factor(statistics.fmean(time for time, _ in runs))
        elif column in GAINS:
            yield "" if by_task == base else gain_cell(column, by_task, base)
        else:
            yield factor(percentile([time for time, _ in runs], column))


def difficulty_lines(results, names, options, where):
    meant = ((name, row) for name in names for row in results.rows(name) if is_meant(row, where))
    times = times_of(meant, options.get("time", "planning"))
    baseline = options.get("baseline", "").replace("_", " ")
    if baseline not in times:
        raise Mistake(f"baseline={baseline}: expected one of {', '.join(times)}")
    needed = {task: statistics.median(time for time, _ in runs) for task, runs in times[baseline].items()}
    lines = []
    for low, high in zip(BINS_MS, BINS_MS[1:]):
        base = {task: times[baseline][task] for task, time in needed.items() if low <= time < high}
        for setting in times if base else ():
            runs = {task: times[setting][task] for task in base if task in times[setting]}
            if runs:
                title = f"{low:g} to {high:g} ms" if high < math.inf else f"{low:g} ms and more"
                lines.append([title, setting, *summary_cells(runs, base, options["show"])])
    unit = {column: f"{column} ms" for column in ("p50", "mean", "p95")}
    return [f"{baseline} needs", "", *(unit.get(column, TITLES.get(column, column)) for column in options["show"])], lines


def paired(runs, base):
    """Times, and whether there is a path, of the runs that both have, by task; by problem, or by run, where there are fewer than five tasks."""
    both = sorted(runs.keys() & base.keys())
    for unit in (lambda run: (*run[:2], task_of(run[2])), lambda run: run[:3], lambda run: run):
        by_unit = [{}, {}]
        for run in both:
            for side, times in zip(by_unit, (runs, base)):
                side.setdefault(unit(run), []).append(times[run])
        if len(by_unit[0]) >= LEAST_UNITS:
            break
    return by_unit


def used_lines(results, names, options, where):
    time, baseline = options.get("time", "planning"), options.get("baseline", "").replace("_", " ")
    base, others, seen = {}, {}, {}
    for name, row in ((name, row) for name in names for row in results.rows(name) if is_meant(row, where)):
        if row["status"].startswith("invalid"):
            continue
        setting = row["setting"].partition(",")[0]
        run = (name, row["set"], row["problem"], row["seed"], row["planner"], row["sampler"], row["setting"])
        seen[run] = seen.get(run, 0) + 1  # problems of several files of a set may have one name
        run = (*run[:2], f"{run[2]} {seen[run]}" if seen[run] > 1 else run[2], run[3])
        timed = (seconds_of(row, time), row["is_valid"] == "1")
        if baseline in (setting, row["sampler"]):
            base[run] = timed
        else:
            group = row["set"] if "by" in options else "queried" if USED["retrieved"](row) else "not queried"
            others.setdefault((setting, group), {})[run] = timed
    if not base:
        raise Mistake(f"baseline={baseline}: expected a setting or a sampler of the rows")
    lines = []
    for (setting, group), runs in sorted(others.items(), key=lambda of: of[0][1] == "not queried"):
        by_task = paired(runs, base)
        cells = [str(len(runs)) if column == "pairs" else gain_cell(column, *by_task) for column in options["show"]]
        lines.append([setting, group, *cells])
    return ["", "set" if "by" in options else "memory", *(TITLES.get(column, column) for column in options["show"])], lines


def cumulative(rows):
    return list(itertools.accumulate(seconds_of(row, "total") for row in rows))


def growth_lines(results, names, options, where):
    by_set = {}
    for row in (row for name in names for row in results.rows(name)):
        by_set.setdefault(row["set"], {}).setdefault(row["setting"], []).append(row)
    lines = []
    for title, settings in by_set.items():
        base = settings.pop(options.get("baseline"), [])
        for setting, grown in settings.items():
            if not is_meant(grown[0], where):
                continue
            if [row["problem"] for row in grown] != [row["problem"] for row in base]:
                raise Mistake(f"set {title}: expected baseline={options.get('baseline')} and {setting} on the same problems in the same order")
            times, base_times = cumulative(grown), cumulative(base)
            if not all(n.isdigit() and 0 < int(n) <= len(times) for n in options["show"]):
                raise Mistake(f"set {title}: expected show= of numbers from 1 to {len(times)}, its queries")
            behind = [i for i, (this, that) in enumerate(zip(times, base_times)) if this >= that]
            pays = behind[-1] + 2 if behind else 1
            replayed = sum(row["replayed"] != "0" for row in grown)
            sums = [f"{base_times[int(n) - 1]:.3g} → {times[int(n) - 1]:.3g}" for n in options["show"]]
            lines.append([title, setting.partition(",")[0], f"{replayed} of {len(grown)}", *sums, factor(base_times[-1] / times[-1]),
                          str(pays) if pays <= len(times) else "not yet"])
    return ["", "", "replayed", *(f"s after {n}" for n in options["show"]), "in all", "pays from query"], lines


def cost_lines(results, names, options, where):
    rows = [row for row in results.rows(names[0]) if is_meant(row, where) and not row["status"].startswith("invalid")]
    means, retrievals = {}, {}
    for row in rows:
        means.setdefault(row["setting"].replace(" ", "_"), []).append(1e3 * seconds_of(row, "planning"))
        if float(row["retrieval_time_s"]) > 0:
            retrievals.setdefault(row["setting"], []).append(1e3 * float(row["retrieval_time_s"]))
    if options.get("baseline") not in means:
        raise Mistake(f"baseline={options.get('baseline')}: expected one of {', '.join(means)}")
    means = {setting: statistics.fmean(times) for setting, times in means.items()}
    without = means[options["baseline"]]
    lines = []
    for memory in csv.DictReader(results.text(f"{names[0]}.memories.csv").splitlines()):
        drawing = [row["setting"] for row in rows if row["settings"].endswith(f"memory={memory['name']}")]
        if not drawing or float(memory["learning_time_s"]) == 0:
            continue
        with_it = means[drawing[0].replace(" ", "_")]
        pays = 1e3 * float(memory["learning_time_s"]) / (without - with_it) if with_it < without else math.inf
        lines.append([memory["name"], drawing[0], memory["primitives"], memory["components"], f"{int(memory['bytes']) / 1e6:.2f}",
                      factor(float(memory["learning_time_s"])), factor(statistics.median(retrievals[drawing[0]])) if drawing[0] in retrievals else "none",
                      f"{factor(without)} → {factor(with_it)}",
                      f"{math.ceil(pays)} queries" if pays < math.inf else "never"])
    return ["memory", "setting", "rows", "components", "MB", "s to learn", "retrieval ms", "mean ms", "gained after"], lines


def medians_of(results, name, column, time):
    """Of each problem's runs, and of those with a path alone if `column` is its length."""
    values = {}
    for row in results.rows(name):
        is_solved = row["is_valid"] == "1"
        if not row["status"].startswith("invalid") and (is_solved or column != "length"):
            value = float(row["path_length"]) if column == "length" else seconds_of(row, time)
            values.setdefault((row["set"], row["problem"]), []).append(value)
    return {problem: statistics.median(runs) for problem, runs in values.items()}


def beside_lines(results, names, options, where):
    lines = []
    for pair in names:
        cells = [pair]
        for column in options["show"]:
            ours, theirs = (medians_of(results, name, column, options.get("time", "planning")) for name in pair.split(":"))
            both = sorted(ours.keys() & theirs.keys())
            if not both:
                raise Mistake(f"{pair}: expected rows of the same problems")
            if column == "pairs":
                cells.append(str(len(both)))
                continue

            def ratio(problems):
                of_each = ([times[problem] for problem in problems] for times in (theirs, ours))
                this, that = (statistics.fmean(v) if column == "length" else percentile(v, column) for v in of_each)
                return this / that

            cells.append(resampled(ratio, both))
        lines.append(cells)
    return ["", *(TITLES.get(column, column) for column in options["show"])], lines


def said_of(results, names, told):
    """By which commands the rows came to be, but for those that the document has told."""
    said = []
    for origin in dict.fromkeys(json.dumps(results.origin(name), sort_keys=True) for name in names):
        origin = json.loads(origin)
        if origin in told:
            continue
        told.append(origin)
        parts = [origin["command"], origin["commit"] and f"commit {origin['commit']}", origin["machine"], origin.get("note")]
        said.append(", ".join(part for part in parts if part))
    return "\nFrom:\n\n" + "".join(f"{wrapped(origin)}\n" for origin in said) if said else ""


def folded(text, **indents):
    """Lines of at most 100 columns; words that are longer stay whole."""
    return textwrap.fill(text, 100, break_long_words=False, break_on_hyphens=False, replace_whitespace=False, **indents)


def wrapped(origin):
    """An item of a list."""
    return folded(origin, initial_indent="- ", subsequent_indent="  ")


def narrowed(text):
    """Output in at most 100 columns: of blanks that all lines share one column each stays, then lines are folded."""
    lines = text.splitlines()
    if all(len(line) <= 100 for line in lines):
        return text
    width = max(map(len, lines))
    blank = [all(line[i:i + 1] in ("", " ") for line in lines) for i in range(width)]
    kept = [i for i in range(width) if not blank[i] or not (i and blank[i - 1])]
    lines = ["".join(line[i] for i in kept if i < len(line)) for line in lines]
    return "".join(f"{folded(line, subsequent_indent='    ')}\n" for line in lines)


def block(results, kind, words, told):
    if kind == "output":
        return f"\n```text\n{narrowed(results.text(words + '.txt'))}```\n{said_of(results, [words], told)}"
    names, options, where = parse(words)
    if kind != "cost" and "show" not in options:
        raise Mistake(f"'{words}': expected show=")
    make_lines = {"rows": row_lines, "ratios": ratio_lines, "used": used_lines, "difficulty": difficulty_lines, "growth": growth_lines,
                  "cost": cost_lines, "beside": beside_lines}[kind]
    titles, lines = make_lines(results, names, options, where)
    if not lines:
        raise Mistake(f"'{words}': no rows are meant")
    if len(lines) > MOST_LINES:
        raise Mistake(f"'{words}': {len(lines)} lines; choose at most {MOST_LINES} with where=")
    rule = ["---"] * len(titles)
    text = "".join("| " + " | ".join(str(c).replace("|", "\\|") for c in line) + " |\n" for line in (titles, rule, *lines))
    return f"\n{text}{said_of(results, [part for name in names for part in name.split(':')], told)}"


def documents(source):
    return [source / "README.md", *sorted((source / "docs").rglob("*.md"))]


def rewrite(source, results, is_check):
    stale = []
    for path in documents(source):
        text, told = path.read_text(encoding="utf-8"), []
        if len(OPENED.findall(text)) != len(MARKED.findall(text)):
            raise Mistake(f"{path.relative_to(source)}: a table is not closed; expected '-->' at the end of a line, then <!-- /rows -->")
        try:
            new = MARKED.sub(lambda m: m["open"] + block(results, m["kind"], m["words"], told) + m["close"], text)
        except Mistake as mistake:
            raise Mistake(f"{path.relative_to(source)}: {mistake}") from mistake
        if new != text:
            stale.append(path)
            if not is_check:
                path.write_text(new, encoding="utf-8")
    return stale


def machine_of(rows):
    with rows.open(encoding="utf-8", newline="") as lines:
        return next(csv.DictReader(lines))["machine"]


def this_machine():
    """As rows of benchmarks name it."""
    models = re.findall("^model name[^:]*: *(.*)", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.MULTILINE)
    return f"{models[0] if models else platform.machine()}, {os.cpu_count()} hardware threads, {platform.system()} {platform.release()}"


def pack(files, target):
    """Rows of several runs of a benchmark as those of one."""
    header = None
    with lzma.open(target, "wb", preset=9) as packed:
        for path in files:
            first, *lines = path.read_bytes().splitlines(keepends=True)
            if header not in (None, first):
                raise Mistake(f"{path}: its columns differ from those of {files[0]}")
            packed.writelines(lines if header else [first, *lines])
            header = first


def add(folder, args):
    name, *files = args.add[0], *map(pathlib.Path, args.add[1:])
    folder.mkdir(parents=True, exist_ok=True)
    if all(path.suffix == ".csv" for path in files):
        machine = machine_of(files[0])
        pack(files, folder / f"{name}.csv.xz")
        if args.memories:
            shutil.copyfile(args.memories, folder / f"{name}.memories.csv")
    elif len(files) == 1:
        machine = this_machine()
        text = files[0].read_text(encoding="utf-8")
        (folder / f"{name}.txt").write_text("".join(f"{line.rstrip()}\n" for line in text.splitlines()), encoding="utf-8")
    else:
        raise Mistake(f"--add {name}: expected files of rows, which end with .csv, or one of another ending")
    origin = {"command": args.command, "commit": args.commit, "machine": machine}
    if args.note:
        origin["note"] = args.note
    (folder / f"{name}.json").write_text(json.dumps(origin, indent=2) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("mneme")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--add", nargs="+", metavar=("NAME", "FILE"))
    parser.add_argument("--command", default="")
    parser.add_argument("--commit", default="")
    parser.add_argument("--note", default="")
    parser.add_argument("--memories")
    args = parser.parse_args()
    folder = args.source / "bench" / "results"
    if args.add:
        if not args.command or len(args.add) < 2:
            parser.error("--add needs a name, files and --command")
        add(folder, args)
    stale = rewrite(args.source, Results(folder, args.mneme), args.check)
    for path in stale:
        print(f"{path}: {'differs from its rows' if args.check else 'written'}")
    return 1 if args.check and stale else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Mistake as mistake:
        sys.exit(f"result_tables: {mistake}")
