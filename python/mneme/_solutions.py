# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""The result of inverse kinematics."""
import numpy as np


class Solutions(np.ndarray):
    """Configurations, shape (k, joint_count). If k is 0, `message` says why; otherwise it is empty."""

    message = ""

    def __array_finalize__(self, source):
        # Copies and views of an empty array keep its message.
        if self.size == 0:
            self.message = getattr(source, "message", "")

    def __reduce__(self):
        make, arguments, state = super().__reduce__()
        return make, arguments, (state, self.message)

    def __setstate__(self, state):
        own, self.message = state
        super().__setstate__(own)
