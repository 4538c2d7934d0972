# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Python blocks of the README and of the guide run, each on its own, in a folder like a fresh tree."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["MNEME_SOURCE"])


def blocks():
    pages = [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]
    return [pytest.param(block, id=f"{page.stem}-{i}") for page in pages for i, block in enumerate(
        re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL), 1)]


@pytest.mark.parametrize("block", blocks())
def test_python_in_the_documents_runs(tmp_path, block):
    for name in ("scenes", "robots", "examples"):
        (tmp_path / name).symlink_to(SOURCE / name)
    run = subprocess.run([sys.executable, "-c", block], cwd=tmp_path, capture_output=True,
                         text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    assert run.stdout
