# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tables of settings and the keywords of the Python stub are what the program declares."""
import os
import pathlib
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["MNEME_SOURCE"])


def test_settings_in_documents_and_stubs_are_as_declared():
    declared = subprocess.run([os.environ["MNEME_PROGRAM"], "settings", "--json"], capture_output=True, text=True)
    if declared.returncode == 2:
        pytest.skip("this mneme has no subcommand settings")
    assert declared.returncode == 0, declared.stderr
    done = subprocess.run([sys.executable, "-B", SOURCE / "tools/generate_settings.py", SOURCE, "--check"],
                          input=declared.stdout, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
