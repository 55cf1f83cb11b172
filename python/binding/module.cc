#include "python/binding/bind.h"
#include "python/binding/held_renderer.h"

#include "formats/base/error.h"

namespace palpate {

void bind_errors(pybind11::module_& module) {
  // The latest that was registered is asked first: from the general to the special.
  const auto& error = pybind11::register_exception<Error>(module, "Error");
  pybind11::register_exception<InputError>(module, "InputError", error);
  pybind11::register_exception<FormatError>(module, "FormatError", error);
  pybind11::register_exception<NumericalError>(module, "NumericalError", error);
  pybind11::register_exception<RenderingFault>(module, "RenderingFault", error);
}

}  // namespace palpate

PYBIND11_MODULE(_palpate, module) {
  module.doc() = "Compiled part of palpate.";
  module.attr("__version__") = PALPATE_VERSION;
  palpate::bind_errors(module);
  palpate::bind_tool(module);
  palpate::bind_database(module);
  palpate::bind_make(module);
  palpate::bind_measurement(module);
  palpate::bind_fit(module);
  palpate::bind_renderer(module);
  palpate::bind_batch(module);
}
