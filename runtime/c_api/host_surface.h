// What a body keeps of a host's presses for good, in a file.
#pragma once

#include <filesystem>
#include <optional>

#include "formats/recording/surface_state.h"
#include "runtime/c_api/host_body.h"

namespace palpate {

/// Not while another call of the tool is under way. A file that has the surface of the
/// same body keeps what it says of other tools. @throws InputError for a body without a
/// file; as read_surface_state() and write_surface_state().
void save_surface(const HostBody& body, const HostTool& tool,
                  const std::filesystem::path& file);

/// HostTool::reset(), on a body that has yielded as the file says; none: a fresh one.
/// Nothing changes where it throws. @throws as save_surface().
void load_surface(const HostBody& body, HostTool& tool,
                  const std::optional<std::filesystem::path>& file);

}  // namespace palpate
