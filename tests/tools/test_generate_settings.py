# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/generate_settings.py on made-up settings."""
import json
import subprocess
import sys

import pytest
from tools_of_source import TOOLS

GROUPS = [
    {"group": "plan", "settings": [
        {"name": "range", "type": "float", "optional": True, "default": None, "least": 0.001, "most": 1000,
         "meaning": "longest step, radians"},
        {"name": "max-nodes", "type": "int", "default": 10000000, "least": 0, "meaning": "a | b"},
        {"name": "lambda", "type": "float", "default": 0.05000000074505806, "least": 0, "most": 1e6, "meaning": "share"},
        {"name": "verify", "type": "bool", "default": True, "meaning": "check the path"},
        {"name": "isa", "type": "choice", "default": "automatic", "choices": ["automatic", "sse"], "meaning": "which"},
        {"name": "label", "type": "text", "default": "", "meaning": "free"}]},
    {"group": "learn", "settings": [
        {"name": "learn-iterations", "type": "int", "default": 20000, "least": 1, "most": 100000000, "meaning": "limit"}]},
]
TABLES = """before
<!-- settings:plan -->
old
<!-- /settings -->
between
<!-- settings:learn -->
<!-- /settings -->
after
"""
STUB = """def plan(
    problem: Problem,
    *,
    # settings:plan
    old: int = 3,
    # /settings
) -> Plan: ...
def learn(
    # settings:learn
    # /settings
) -> None: ...
"""


@pytest.fixture()
def tree(tmp_path):
    (tmp_path / "docs/design").mkdir(parents=True)
    (tmp_path / "python/mneme").mkdir(parents=True)
    (tmp_path / "docs/design/settings.md").write_text(TABLES)
    (tmp_path / "python/mneme/__init__.pyi").write_text(STUB)
    return tmp_path


def generate(root, *arguments, groups=GROUPS):
    return subprocess.run([sys.executable, TOOLS / "generate_settings.py", root, *arguments], input=json.dumps(groups),
                          capture_output=True, text=True)


def test_tables_say_default_range_and_meaning(tree):
    assert generate(tree).returncode == 0
    assert (tree / "docs/design/settings.md").read_text() == """before
<!-- settings:plan -->
| setting | default | range | meaning |
|---|---|---|---|
| `range` | - | 0.001 to 1000 | longest step, radians |
| `max-nodes` | 1e7 | 0 or more | a \\| b |
| `lambda` | 0.05 | 0 to 1e6 | share |
| `verify` | on | on, off | check the path |
| `isa` | automatic | automatic, sse | which |
| `label` | - |  | free |
<!-- /settings -->
between
<!-- settings:learn -->
| setting | default | range | meaning |
|---|---|---|---|
| `learn-iterations` | 20000 | 1 to 1e8 | limit |
<!-- /settings -->
after
"""


def test_stubs_have_keywords_with_types_and_defaults(tree):
    assert generate(tree).returncode == 0
    assert (tree / "python/mneme/__init__.pyi").read_text() == """def plan(
    problem: Problem,
    *,
    # settings:plan
    range: Optional[float] = None,
    max_nodes: int = 10000000,
    lambda_: float = 0.05,
    verify: bool = True,
    isa: str = "automatic",
    label: str = "",
    # /settings
) -> Plan: ...
def learn(
    # settings:learn
    learn_iterations: int = 20000,
    # /settings
) -> None: ...
"""


def test_check_names_what_is_stale_and_writes_nothing(tree):
    done = generate(tree, "--check")
    assert done.returncode == 1
    assert "docs/design/settings.md: settings are not as declared" in done.stderr
    assert (tree / "docs/design/settings.md").read_text() == TABLES
    generate(tree)
    assert generate(tree, "--check").returncode == 0


def test_groups_without_marker_and_markers_without_group_are_named(tree):
    done = generate(tree, groups=[GROUPS[0], {"group": "solve", "settings": []}])
    assert done.returncode == 1
    assert "settings:learn is marked, but mneme settings has no such group" in done.stderr
    assert "settings:solve is not marked anywhere" in done.stderr
