# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Documents name files that exist, and ARCHITECTURE.md is a map, not a book."""
import re

import pytest
from tools_of_source import TOOLS

ROOT = TOOLS.parent
DOCUMENTS = [path.relative_to(ROOT).as_posix()
             for path in [*sorted(ROOT.rglob("docs/**/*.md")), *(ROOT / f"{name}.md" for name in
                                                             ("README", "CONTRIBUTING", "ARCHITECTURE"))]]
# Not behind another folder; capitals stand for what the reader fills in.
NAMED = re.compile(r"(?<![\w/.])(?:src|include|apps|python|tests|tools|script|examples)/[\w./*-]*\w")
LINKED = re.compile(r"\]\((?!https?:)([^)#]+)")


def is_there(name):
    if re.search("/(unit|law|oracle|flow)$", name):  # a ctest
        return True
    return any(ROOT.glob(name)) or bool(re.search(r"\b[A-Z]{2,}\b", name.replace("_", " ")))


@pytest.mark.parametrize("name", DOCUMENTS)
def test_documents_name_files_that_exist(name):
    text = (ROOT / name).read_text()
    missing = {path for path in NAMED.findall(text) if not is_there(path)}
    missing |= {link for link in LINKED.findall(text) if not ((ROOT / name).parent / link).exists()}
    assert not missing


def test_the_architecture_is_a_map_of_at_most_1000_words():
    text = re.sub(r"<!-- map -->.*<!-- /map -->", "", (ROOT / "ARCHITECTURE.md").read_text(), flags=re.DOTALL)
    assert len(text.split()) <= 1000
