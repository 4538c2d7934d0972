# SPDX-FileCopyrightText: The mneme authors
# SPDX-License-Identifier: BSD-3-Clause
"""What inverse kinematics brings."""
import numpy as np


class Solutions(np.ndarray):
    """Configurations, an array of shape (k, joint_count). `message` says why there are none; empty if there are."""

    message = ""

    def __array_finalize__(self, source):
        # Copies and views of none are none, too.
        if self.size == 0:
            self.message = getattr(source, "message", "")
