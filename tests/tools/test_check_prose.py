# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/check_prose.py finds each kind of fault, and nothing in a clean tree."""
import sys

import pytest
from tools_of_source import TOOLS

sys.path.insert(0, str(TOOLS))
from check_prose import check  # noqa: E402


@pytest.fixture(name="tree")
def make_tree(tmp_path):
    for folder in ("include/mneme", "apps", "docs/results"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "README.md").write_text("# A\n\nSee `docs/b.md` and b.md.\n\n| a |\n|---|\n" + "| 1 |\n" * 15)
    (tmp_path / "docs/b.md").write_text(f"```text\n{'word ' * 19}\n{'word ' * 19}\n{'word ' * 19}\n```\n\n| {'x' * 120} |\n")
    (tmp_path / "include/mneme/a.h").write_text("/// Returns what it is.\n/// Of no use.\nint f();\n")
    return tmp_path


LONG = "Word" + " word" * 40 + " end."


def test_a_clean_tree_has_no_findings(tree):
    assert check(tree) == []


@pytest.mark.parametrize("name, text, finding", [
    ("include/mneme/b.h", "/// Of the sampler.\nint g();\n", "b.h:1: a doc comment opens with 'Of'"),
    ("include/mneme/b.h", "int a;  ///< What it is.\n", "b.h:1: a doc comment opens with 'What'"),
    ("include/mneme/b.h", f"/// Short.\n/// {LONG}\nint g();\n", "b.h:1: a sentence of 42 words"),
    ("include/mneme/b.h", "/// See docs/none.md.\nint g();\n", "b.h:1: there is no file docs/none.md"),
    ("apps/a.cpp", 'f("word word "\n  "' + "word " * 41 + '");\n', "a.cpp:1: a sentence of 43 words"),
    ("docs/c.md", "# C\n\n- one\n- " + LONG.replace("word word word", "word word\n  word") + "\n", "c.md:4: a sentence of 42 words"),
    ("docs/c.md", "x" * 101 + "\n", "c.md:1: 101 columns"),
    ("docs/c.md", "See none.md.\n", "c.md:1: there is no page none.md"),
    ("docs/c.md", "| a |\n|---|\n" + "| 1 |\n" * 16, "c.md:1: a table of 16 rows"),
    ("docs/c.md", "| message | a |\n|---|---|\n| `.. is 'A' of two; gone` | `or so` |\n", "c.md:3: no string of the code has")])
def test_each_fault_is_found(tree, name, text, finding):
    (tree / name).write_text(text)
    found = check(tree)
    assert len(found) == 1 and finding in found[0]


@pytest.mark.parametrize("message", ["'x' is out of 2", ".. is out of ..; try less", "is out of"])
def test_messages_of_the_code_are_found(tree, message):
    (tree / "apps/a.cpp").write_text('f("it {} is "\n  "out of {}; try {}");  // no match: "try more"\ng("; try less");\n')
    (tree / "docs/c.md").write_text(f"| message | a |\n|---|---|\n| `{message}` | `of none` |\n")
    assert check(tree) == []


def test_a_message_of_placeholders_alone_is_not_found(tree):
    (tree / "apps/a.cpp").write_text('f("{} {} {} of {}");\n')
    (tree / "docs/c.md").write_text("| message | a |\n|---|---|\n| `all of it` | |\n")
    assert len(check(tree)) == 1


def test_tables_of_results_and_generated_text_are_not_checked(tree):
    rows = "| 1 |\n" * 20
    (tree / "docs/results/c.md").write_text(f"<!-- rows a show=b -->\n\n{LONG}\n{rows}<!-- /rows -->\n")
    assert [finding for finding in check(tree) if "columns" not in finding] == []
