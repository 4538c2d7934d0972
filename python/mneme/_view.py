# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pages that show plans, for browsers and notebooks."""
import html
import os

from . import _mneme
from ._connections import make_error


def _repr_html(plan):
    if plan.status in ("invalid_start", "invalid_goal"):
        return f"<pre>{html.escape(plan.problem.name)}: {html.escape(plan.message)}</pre>"
    # A frame, because the page has styles and scripts.
    page = html.escape(plan.to_page(), quote=True)
    return f'<iframe srcdoc="{page}" style="width:100%;height:600px;border:0"></iframe>'


def _write_in_one(path, text):
    """Replaces a file as one step. Follows links, and writes pipes and devices directly. Raises mneme.Error."""
    try:
        _replace(path, text)
    except OSError as failure:
        raise make_error("io", f"{path}: cannot be written: {failure.strerror}") from failure


def _replace(path, text):
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
    """Writes a page that shows `plan` to the file `path` and returns the path. The page needs no network.

    With plan(..., record=True) it also shows samples and trees. Raises mneme.Error if `path` is an input file of the
    plan or any memory.
    """
    if not isinstance(plan, _mneme.Plan):
        raise TypeError(f"view: expected a Plan, got {plan!r:.80}")
    file = os.fsdecode(path)
    plan._check_output(file)
    _write_in_one(file, plan.to_page())
    return path


_mneme.Plan._repr_html_ = _repr_html
_mneme.Plan.view = view
