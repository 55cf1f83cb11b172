// A fitted measurement as the database stores it.
#pragma once

#include <filesystem>
#include <string>

#include "fitting/curve/family_fit.h"
#include "formats/database/response_database.h"

namespace palpate {

/// Samples the curve from the contact point to the largest depth measured. Samples are
/// at the curve's knots, where the curve has any, else closer together where the curve
/// bends most. So the stored cubic stays within 1e-4 of the largest force. Origin
/// measured. Baseline and drift belong to the sensor and are left out. error_relative
/// is the half width of the 95 % interval over the larger of the force and a tenth of
/// the largest. The error is taken at its worst from a tenth of the depth on. The half
/// width is 1.96 times the root of a sum. The sum is of the curve's variance
/// (log_force_errors) and the square of what the family surely misses.
/// @param direction [-] unit vector of the force on the tool.
[[nodiscard]] NodeResponse fitted_response(const FamilyFit& fit,
                                           const Eigen::Vector3d& direction);

/// A flat square sample, 0.1 m wide, in the plane z = 0 with normal +z: 4 nodes, 2
/// triangles. Every node has the same fitted response; the raw measurement is kept.
/// @param source the file that was measured; its name and digest are kept; empty:
/// none.
/// @throws InputError for a tool out of range, NumericalError where the curve's error
/// is not known.
[[nodiscard]] ResponseDatabase sample_patch(const FamilyFit& fit,
                                            const Measurement& measurement,
                                            const ToolShape& tool,
                                            const std::filesystem::path& source);

}  // namespace palpate
