// A fitted measurement as the database stores it.
#pragma once

#include <filesystem>
#include <string>

#include "fitting/curve/power_law_fit.h"
#include "formats/database/response_database.h"

namespace palpate {

/// Samples K d^p from the contact point to the largest depth measured, closer together
/// where the curve bends, so that the stored cubic stays within 1e-4 of the largest
/// force. Origin measured; error_relative is the residuals' rms over the force at the
/// largest depth. Baseline and drift belong to the sensor and are left out.
/// @param direction [-] unit vector of the force on the tool.
/// @throws NumericalError for an empty run.
[[nodiscard]] NodeResponse fitted_response(const ContactFit& fit,
                                           const Eigen::Vector3d& direction);

/// A flat square sample, 0.1 m wide, in the plane z = 0 with normal +z: 4 nodes, 2
/// triangles, the same fitted response at every node, and the raw measurement.
/// @param source the file that was measured; its name and digest are kept.
/// @throws NumericalError for an empty run, InputError for a tool out of range.
[[nodiscard]] ResponseDatabase sample_patch(const ContactFit& fit,
                                            const Measurement& measurement,
                                            const ToolShape& tool,
                                            const std::filesystem::path& source);

}  // namespace palpate
