// What a body keeps from one run to the next, in a file.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
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

/// For a scene that is computed meanwhile: it has no database yet that a surface could
/// belong to. @throws InputError where a file is named.
void refuse_surface(const SurfaceFiles& files);

/// The tables of responses that tools of a database have, which YieldedRow::table
/// counts. @param tools names, one for each hand; none: the only one.
[[nodiscard]] std::vector<std::string> surface_tables(
    const ResponseDatabase& database, const std::vector<std::string>& tools);

/// Writes what the body has when the runs are over: of tools that took part theirs, of
/// others what was there. Nothing without a file for it.
void leave_surface(const SurfaceFiles& files, SurfaceState surface,
                   std::span<const SimulationReport> reports);

}  // namespace palpate
