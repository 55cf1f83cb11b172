// What a body keeps from one run to the next, in a file.
#pragma once

#include <span>
#include <string>

#include "formats/recording/surface_state.h"
#include "runtime/run/render_run.h"

namespace palpate {

/// Files of a run; each may be empty.
struct SurfaceFiles {
  std::string in = {};   ///< begins with it; none: a fresh body
  std::string out = {};  ///< leaves it there
};

/// What a run begins with, and the body it is of. Without files nothing is read.
/// @param database its file. @throws as read_surface_state(); InputError for a place
/// that cannot be written.
[[nodiscard]] SurfaceState begin_surface(const SurfaceFiles& files,
                                         const std::string& database);

/// For a body of several contacts, which keeps nothing of them.
/// @throws InputError where a file is named.
void refuse_surface(const SurfaceFiles& files);

/// Writes what the body has when the runs are over: of tools that took part theirs, of
/// others what was there. Nothing without a file for it.
void leave_surface(const SurfaceFiles& files, SurfaceState surface,
                   std::span<const SimulationReport> reports);

}  // namespace palpate
