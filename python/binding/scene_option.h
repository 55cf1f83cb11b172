// Options of a renderer of a scene that is computed meanwhile.
#pragma once

#include <filesystem>

#include <pybind11/pybind11.h>

#include "runtime/c_api/host_tool.h"

namespace palpate {

/// Of a scene (.toml) takes what is its own, and the tool that palpate.build() runs,
/// out of `given`; of another file nothing. @throws what Python's find_tool() raises.
void take_scene(const std::filesystem::path& file, const pybind11::dict& given,
                HostOptions& options);

}  // namespace palpate
