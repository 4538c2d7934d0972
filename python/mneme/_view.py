# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plans as pages: for a browser and for a notebook."""
import html
import os

from . import _mneme

_PAGE = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>{title}</title>
<body style="margin:1em;font-family:sans-serif">{body}</body></html>
"""


def _summary(plan):
    lines = [
        f"{plan.problem.name}: {plan.status}",
        f"{plan.planner}, sampler {plan.sampler}, seed {plan.seed}",
        f"{1e3 * plan.planning_time_s:.3f} ms, {plan.iterations} samples",
        f"{len(plan.path)} configurations, length {plan.path_length:.3f}",
    ]
    return "<pre>" + html.escape("\n".join(lines)) + "</pre>"


def _repr_html(plan):
    if plan.problem.robot.is_planar and plan.status not in ("invalid_start", "invalid_goal"):
        return plan.to_svg()
    return _summary(plan)


def view(plan, path):
    """Writes a page that shows `plan` to the file `path`; it needs no network. Returns the path."""
    page = _PAGE.format(title=html.escape(plan.problem.name), body=_repr_html(plan))
    temporary = f"{os.fspath(path)}.tmp"
    with open(temporary, "w", encoding="utf-8") as file:
        file.write(page)
    os.replace(temporary, path)
    return path


_mneme.Plan._repr_html_ = _repr_html
_mneme.Plan.view = view
