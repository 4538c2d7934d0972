# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""The program on processors without AVX, emulated."""
import json
import shutil

import pytest
from conftest import BUILD, environment, run

QEMU = shutil.which("qemu-x86_64") or shutil.which("qemu-x86_64-static")
pytestmark = pytest.mark.skipif(QEMU is None, reason="there is no qemu-x86_64 (qemu-user)")


@pytest.mark.parametrize("processor, isas", [
    ("core2duo", ["scalar"]),
    ("Nehalem", ["scalar"]),  # Highway's SSE4 includes AES
    ("Westmere", ["scalar", "sse"]),
    ("Haswell", ["scalar", "sse", "avx2"]),
])
def test_the_program_takes_what_the_processor_has(processor, isas):
    doctor = json.loads(run([QEMU, "-cpu", processor, BUILD / "mneme", "doctor", "--json"],
                            env=environment()))
    assert doctor["ok"], doctor
    assert doctor["isas"] == isas
    assert doctor["isa"] == isas[-1]
