// [[run]] and [points] of a session file. Only for session*.cc.
#pragma once

#include <filesystem>
#include <string>

#include "fitting/session/session.h"
#include "formats/scene/toml_section.h"

namespace palpate::session_parts {

inline constexpr std::string_view kRunKeys[] = {"file",     "files",      "point",
                                                "specimen", "position_m", "normal"};
inline constexpr std::string_view kPointKeys[] = {"table", "length_unit"};

/// A file that the session names: relative to where the session lies.
[[nodiscard]] std::filesystem::path beside(const Session& session,
                                           const std::string& name);

/// Appends the runs of one [[run]].
void append_runs(const SceneSection& section, Session& session);

/// What was taken from files of layout "auto": the radius of a sphere for which the
/// session has none, and the session's notes.
/// @throws InputError where files state no radius, or several.
void take_from_files(Session& session);

/// Positions, normals and points of runs that have none of their own, from the table.
void read_points(const SceneSection& section, Session& session);

}  // namespace palpate::session_parts
