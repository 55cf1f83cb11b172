// From a tool's estimates of error, and what checks found, to errors that are stated.
#pragma once

#include <span>

#include "formats/database/error_calibration.h"
#include "formats/database/place_check.h"
#include "formats/mesh/surface_mesh.h"
#include "formats/response/response_table.h"

namespace palpate {

struct ErrorFactor {
  double factor = 0.0;              ///< [-] on estimates; 0: there is no such node
  double covered = kErrorCoverage;  ///< [-] share of places that the checks cover
};

/// Where the load path at a vertex was near-singular, all nodes of its elements have a
/// factor of their own. So that factor holds at any place there. Few paths are
/// near-singular, and those are off by more. Each factor covers the places of its kind
/// (calibrate_errors()); a place beside both kinds of nodes counts as easy, and is no
/// worse covered.
struct ErrorFactors {
  ErrorFactor easy;
  ErrorFactor hard;  ///< at least easy.factor
};

/// Estimates become stated errors, and flags where those are above the budget.
/// @param checks as compare() left them. @param responses of all vertices.
ErrorFactors state_errors(const SurfaceMesh& body, double budget,
                          std::span<const PlaceCheck> checks,
                          std::span<NodeResponse> responses);

/// What is stated of all places of a tool.
[[nodiscard]] AccuracyRecord accuracy_record(double budget, const ErrorFactors& factor,
                                             std::span<const PlaceCheck> checks);

}  // namespace palpate
