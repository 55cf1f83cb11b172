// What each file of this folder adds to the module.
#pragma once

#include "python/binding/held_database.h"

#include <pybind11/pybind11.h>

namespace palpate {

class HeldRenderer;

void bind_errors(pybind11::module_& module);
void bind_optional(pybind11::class_<HeldTool>& type);
void bind_tool(pybind11::module_& module);
void bind_contact(pybind11::class_<HeldTool>& tool);
void bind_pressure(pybind11::module_& module, pybind11::class_<HeldTool>& tool);
void bind_database(pybind11::module_& module);
void bind_make(pybind11::module_& module);
void bind_measurement(pybind11::module_& module);
void bind_fit(pybind11::module_& module);
void bind_renderer(pybind11::module_& module);
void bind_batch(pybind11::module_& module);
void bind_drawing(pybind11::class_<HeldRenderer>& type);
void bind_needle(pybind11::class_<HeldRenderer>& type);
void bind_service(pybind11::class_<HeldRenderer>& type);

}  // namespace palpate
