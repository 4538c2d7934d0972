# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Commands of the guide run in a fresh tree, and print what the pages show.

Blocks of a page run in their order in one folder: `sh` as one script, `console` line by line. Numbers and names of
instruction sets may differ from what a `console` block shows, and `...` stands for any lines. `text` blocks need
another machine, rights or hours; nothing runs them.
"""
import os
import pathlib
import re
import socket
import subprocess

import pytest

SOURCE = pathlib.Path(os.environ["MNEME_SOURCE"])
PROGRAM = pathlib.Path(os.environ["MNEME_PROGRAM"])
PAGES = [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"(?<![A-Za-z_])-?\d[\d.]*(?:e[+-]?\d+)?")


def blocks(page):
    return BLOCK.findall(page.read_text())


def normal(line):
    """The line without what differs between machines: numbers, and which instruction sets there are."""
    line = re.sub(r"\b(?:scalar|sse|avx2|avx512)\b(?:, (?:sse|avx2|avx512)\b)*", "ISA", line)
    return re.sub(r"\s+", " ", NUMBER.sub("#", line)).strip()


def shown_matches(shown, printed):
    """Whether `printed` is `shown` up to numbers, where a line `...` stands for any lines and a trailing one for more."""
    pattern = ""
    for line in shown:
        if line.strip() == "...":
            pattern += r"(?:.*\n)*"
        elif line.endswith("..."):
            pattern += re.escape(normal(line[:-3])) + r".*\n"
        else:
            pattern += re.escape(normal(line)) + r"\n"
    return re.fullmatch(pattern, "".join(f"{normal(line)}\n" for line in printed)) is not None


def commands(block):
    """Pairs of a command and the lines that a `console` block shows after it."""
    found = []
    for line in block.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        else:
            found[-1][1].append(line)
    return found


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture()
def shell(tmp_path):
    """Runs text in bash in a folder that looks like a fresh tree, and keeps the folder it ends in."""
    tree, state = tmp_path / "tree", tmp_path / "folder"
    tree.mkdir()
    for name in ("scenes", "examples", "robots", "bench"):
        (tree / name).symlink_to(SOURCE / name)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/mneme").symlink_to(PROGRAM)
    state.write_text(str(tree))
    environment = {**os.environ, "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}"}

    def run(text):
        text = text.replace("7890", str(free_port()))
        done = subprocess.run(["bash", "-e", "-m", "-c", f"cd '{state.read_text()}'\n{text}\npwd > '{state}.new'"],
                              capture_output=True, text=True, timeout=300, env=environment, check=False)
        assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"
        state.write_text(pathlib.Path(f"{state}.new").read_text().strip())
        return done.stdout
    return run


@pytest.fixture(scope="session")
def can_serve():
    return subprocess.run([PROGRAM, "serve", "--help"], capture_output=True, check=False).returncode == 0


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_run_and_print_what_is_shown(page, shell, can_serve):
    for kind, block in blocks(page):
        if "mneme serve" in block and not can_serve:
            pytest.skip("this mneme has no service")
        if kind == "sh":
            shell(block)
        for command, shown in commands(block) if kind == "console" else ():
            printed = shell(command).splitlines()
            assert shown_matches(shown, printed), f"{command}\n" + "\n".join(printed)


@pytest.mark.parametrize("page", PAGES[1:], ids=lambda page: page.stem)
def test_a_page_begins_with_a_command(page):
    assert blocks(page)[0][0] in ("sh", "console"), "expected a block of commands first"


def test_files_on_the_page_of_own_robots_are_those_of_the_example():
    page = SOURCE / "docs/own_robot.md"
    shown = [block for kind, block in blocks(page) if kind == "yaml"]
    for name, block in zip(("scene.yaml", "problem.yaml"), shown, strict=True):
        text = (SOURCE / "examples/own_robot" / name).read_text()
        lines = [line for line in text.splitlines() if not line.startswith("#")]
        assert lines == block.splitlines(), name


def test_shown_lines_may_differ_in_numbers_only():
    assert shown_matches(["planning 1.5 ms, avx2", "..."], ["planning 22 ms, avx512", "more"])
    assert shown_matches(["sets scalar, sse, avx2, avx512; used: avx512"], ["sets scalar, sse, avx2; used: avx2"])
    assert not shown_matches(["planning 1.5 ms"], ["planned 1.5 ms"])
    assert not shown_matches(["a"], ["a", "b"])
