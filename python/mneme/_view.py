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


def view(plan, path):
    """Writes a page that shows `plan` to the file `path`; it needs no network. Returns the path.

    With plan(..., record=True) it also shows samples and trees.
    """
    page = plan.to_page()
    temporary = f"{os.fspath(path)}.tmp"
    with open(temporary, "w", encoding="utf-8") as file:
        file.write(page)
    os.replace(temporary, path)
    return path


_mneme.Plan._repr_html_ = _repr_html
_mneme.Plan.view = view
