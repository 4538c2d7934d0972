# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the README shows in Python really runs."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["MNEME_SOURCE"])


def blocks():
    return re.findall(r"^```python\n(.*?)^```", (SOURCE / "README.md").read_text(),
                      re.MULTILINE | re.DOTALL)


@pytest.mark.skipif(not blocks(), reason="the README has no Python")
def test_the_readme_runs(tmp_path):
    for name in ("scenes", "robots"):
        (tmp_path / name).symlink_to(SOURCE / name)
    for block in blocks():
        run = subprocess.run([sys.executable, "-c", block], cwd=tmp_path, capture_output=True,
                             text=True, timeout=300)
        assert run.returncode == 0, run.stderr
        assert run.stdout
