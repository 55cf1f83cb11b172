// The machine of a session: its frame, and where its frame of coordinates lies.
#pragma once

#include <optional>
#include <string>

#include "fitting/curve/frame_run.h"
#include "fitting/session/session.h"

namespace palpate {

/// The frame as the session states it, or as its run on a rigid plate has it (then with
/// rms and samples of the fit). None where the session states neither.
/// @throws InputError as frame_of_run() and read_run(), naming the file.
[[nodiscard]] std::optional<FrameRun> session_frame(const Session& session);

/// One line for people: stiffness, standard deviation, where from. Empty for no frame.
[[nodiscard]] std::string describe_frame(const std::optional<FrameRun>& frame);

/// Lines for people: residuals of the pairs and the expected error at the probes. Empty
/// without a registration.
[[nodiscard]] std::string describe_registration(const Session& session);

}  // namespace palpate

namespace palpate {
class SceneSection;
}

/// [machine] and [registration] of a session file. Only for session*.cc.
namespace palpate::session_parts {

inline constexpr std::string_view kMachineKeys[] = {
    "frame_stiffness_n_per_m", "frame_stiffness_sd_n_per_m", "frame_run"};
inline constexpr std::string_view kRegistrationKeys[] = {"pairs", "length_unit"};

void read_machine(const SceneSection& section, Session& session);

/// Reads the pairs, and moves positions and normals of all runs to the mesh's frame.
void read_registration(const SceneSection& section, Session& session);

/// `cycle` of [fit]: a text, or a number.
[[nodiscard]] CycleChoice read_cycle(const SceneSection& section);

}  // namespace palpate::session_parts
