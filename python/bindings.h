// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/// Functions that add the bindings of each room to the module.
#pragma once

#include "mneme/robot.h"

#include <pybind11/pybind11.h>

namespace mneme::python {

void bind_base(pybind11::module_& module);
void bind_robot(pybind11::module_& module);
void bind_attached(pybind11::class_<Robot>& robot);
void bind_scene(pybind11::module_& module);
void bind_goal(pybind11::module_& module);
void bind_line(pybind11::module_& module);
void bind_problem(pybind11::module_& module);
void bind_collision(pybind11::module_& module);
void bind_cell(pybind11::module_& module);
void bind_primitive(pybind11::module_& module);
void bind_experience(pybind11::module_& module);
void bind_learning(pybind11::module_& module);
void bind_pipeline(pybind11::module_& module);
void bind_many(pybind11::module_& module);
void bind_benchmark(pybind11::module_& module);
void bind_task(pybind11::module_& module);

}  // namespace mneme::python
