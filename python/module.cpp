// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mneme/baselines.h"
#ifdef MNEME_WITH_OMPL
#include "mneme/ompl.h"
#endif

#include "bindings.h"

#include <pybind11/pybind11.h>

PYBIND11_MODULE(_mneme, module) {
  mneme::add_baseline_samplers();
#ifdef MNEME_WITH_OMPL
  mneme::add_ompl_planners();
#endif
  module.doc() = "The compiled part of mneme; import mneme instead.";
  mneme::python::bind_base(module);
  mneme::python::bind_scene(module);
  mneme::python::bind_robot(module);
  mneme::python::bind_goal(module);
  mneme::python::bind_line(module);
  mneme::python::bind_problem(module);
  mneme::python::bind_collision(module);
  mneme::python::bind_cell(module);
  mneme::python::bind_task(module);
  mneme::python::bind_primitive(module);
  mneme::python::bind_experience(module);
  mneme::python::bind_learning(module);
  mneme::python::bind_pipeline(module);
  mneme::python::bind_many(module);
  mneme::python::bind_benchmark(module);
}
