# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plans as pages: for a browser and for a notebook."""
import html
import os

from . import _mneme


def _repr_html(plan):
    if plan.status in ("invalid_start", "invalid_goal"):
        return f"<pre>{html.escape(plan.problem.name)}: {html.escape(plan.message)}</pre>"
    # A frame of its own: the page has styles and scripts.
    page = html.escape(plan.to_page(), quote=True)
    return f'<iframe srcdoc="{page}" style="width:100%;height:600px;border:0"></iframe>'


def _write_in_one(path, text):
    """Readers see the old file or the whole new one; pipes and devices are written to, links followed."""
    target = os.path.realpath(path)
    if os.path.exists(target) and not os.path.isfile(target):
        with open(target, "w", encoding="utf-8") as file:
            file.write(text)
        return
    temporary = f"{target}.{os.getpid()}.tmp"
    try:
        with open(temporary, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(temporary, target)
    except BaseException:
        if os.path.exists(temporary):
            os.remove(temporary)
        raise


def view(plan, path):
    """Writes a page that shows `plan` to the file `path`; it needs no network. Returns the path.

    With plan(..., record=True) it also shows samples and trees. A mneme.Error if the plan's problem, robot, scene or
    memory was read from that file, or it is another memory.
    """
    file = os.fsdecode(path)
    plan._check_output(file)
    _write_in_one(file, plan.to_page())
    return path


_mneme.Plan._repr_html_ = _repr_html
_mneme.Plan.view = view
