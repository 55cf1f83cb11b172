// Optional arguments that come by name.
#pragma once

#include <string>
#include <type_traits>

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace palpate {

/// Takes what `given` has under the name, unless it is None, out of it.
/// @throws pybind11::type_error saying what it is and must be.
template <typename Value>
void take_option(const pybind11::dict& given, const char* name, Value& into) {
  if (!given.contains(name)) {
    return;
  }
  const pybind11::object value = given.attr("pop")(name);
  if (value.is_none()) {
    return;
  }
  try {
    into = pybind11::cast<Value>(value);
  } catch (const pybind11::cast_error&) {
    constexpr const char* kWanted = std::is_same_v<Value, bool> ? "True or False"
                                    : std::is_same_v<Value, std::string> ? "a str"
                                                                         : "a number";
    throw pybind11::type_error(fmt::format(
        "{} is {}, must be {}", name, std::string(pybind11::repr(value)), kWanted));
  }
}

/// @throws pybind11::type_error naming what nobody took.
inline void refuse_rest(const pybind11::dict& given, const char* whose) {
  for (const auto& [name, value] : given) {
    throw pybind11::type_error(
        fmt::format("{} has no option {}", whose, std::string(pybind11::str(name))));
  }
}

}  // namespace palpate
