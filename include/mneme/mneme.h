// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// The library mneme::mneme, in the order of the flow.
#pragma once

#include "mneme/base.h"
#include "mneme/geometry.h"
#include "mneme/robot.h"
#include "mneme/spheres.h"
#include "mneme/scene.h"
#include "mneme/problem.h"
#include "mneme/check.h"
#include "mneme/collision.h"
#include "mneme/sampling.h"
#include "mneme/path.h"
#include "mneme/trajectory.h"
#include "mneme/goal.h"
#include "mneme/line.h"
#include "mneme/planning.h"
#include "mneme/cell.h"
#include "mneme/store.h"
#include "mneme/upkeep.h"
#include "mneme/experience.h"
#include "mneme/memory.h"
#include "mneme/learning.h"
#include "mneme/pipeline.h"
#include "mneme/task.h"
#include "mneme/task_file.h"
