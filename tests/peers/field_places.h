// What the field gives between nodes, beside presses there.
//
// Places are drawn evenly over the surface of the elements that respond at all nodes. A
// press is along the normal between the vertices' there, solved on a finer mesh
// (true_forces.h). The tool is at the same places in the field.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "runtime/account/local_model.h"
#include "tests/peers/true_forces.h"

namespace palpate::peers {

struct PlacesOptions {
  int places = 200;
  double times_finer = 2.0;  ///< than the scene's budget asks for
  /// File for one line a place of the first database's smooth field: where [m], found,
  /// stated, and what is found at each depth [-]; "": none.
  std::string rows;
  unsigned seed = 1;
};

/// At one share of the depth, over places.
struct PlacesRow {
  FieldKind kind = FieldKind::kSmooth;
  double depth_share = 0.0;  ///< [-] of the scene's largest depth
  double mean = 0.0;         ///< [-] |dF| over the mean true force
  double p95 = 0.0;
  double largest = 0.0;
  double normal = 0.0;    ///< [-] mean of the normal part's
  double bias = 0.0;      ///< [-] mean of the normal part's, with its sign
  double sideways = 0.0;  ///< [-] mean of the rest
};

/// Whether a field keeps the stated error at places. The error is the largest |dF| over
/// depths from a tenth on, over the true force there or a tenth of its largest
/// (force_difference.h).
struct PlacesCoverage {
  FieldKind kind = FieldKind::kSmooth;
  double stated_median = 0.0;   ///< [-] the nodes' own, blended
  double found_median = 0.0;    ///< [-]
  double found_p95 = 0.0;       ///< [-]
  double within_blended = 0.0;  ///< [-] share of places within the nodes' own, blended
  double within_largest = 0.0;  ///< [-] within the largest of the three
  /// By AccuracyRecord::depth_share, [-] the share of places that are from there on
  /// within what the file says.
  std::vector<double> within_from = {};
};

struct PlacesReport {
  int places = 0;  ///< that were pressed
  int failed = 0;
  std::vector<PlacesRow> row;
  std::vector<PlacesCoverage> coverage;
};

/// The same presses judge each database.
/// @param scene of the databases, whose first tool is pressed. @param databases (n >=
/// 1) of one body; the first decides where elements respond. @throws InputError
/// otherwise.
[[nodiscard]] std::vector<PlacesReport> measure_places(
    const Scene& scene, std::span<const ResponseDatabase> databases,
    const PlacesOptions& options);

[[nodiscard]] std::string table_text(const PlacesReport& report);

}  // namespace palpate::peers
