// How stiff the field between nodes is.
//
// A force that is held while the tool moves by dx gives a hand more than the potential
// falls by, dx . H dx / 2 with H the Hessian of U (potential_field.h): the K of
// K dx^2 / 2 is H's largest eigenvalue. On a node's line it is the slope of the node's
// curve. Between nodes the eigenvalue may be larger. There energies, forces and slopes
// of neighbours may belong to no one smooth energy, as with noise or errors of their
// own. Then the field bends to meet them all.
#pragma once

#include "formats/database/response_database.h"
#include "formats/response/response_table.h"
#include "runtime/account/local_model.h"
#include "runtime/device/stability_margin.h"

namespace palpate {

/// Largest eigenvalues of the smooth field's Hessian over a body, over the largest
/// slope of its curves [-]; 1 where that is less, and without curves.
struct FieldStiffening {
  double inside = 1.0;  ///< where all nodes of an element respond
  /// Where some nodes do not respond, at the border of the reach. There the field falls
  /// to nothing within an element. The fall is steeper the deeper the tool is beside
  /// the element's size.
  double border = 1.0;
};

/// Found by looking at four places of every element that responds (of 16 384 evenly
/// among more). The search goes closer and closer where most was found; it is no bound
/// by proof.
/// @param table of the database. Curves as they are stored: what softens, stiffens or
///   scales them all scales both.
[[nodiscard]] FieldStiffening field_stiffening(const ResponseDatabase& database,
                                               const ResponseTable& table);

/// rendered_stiffness() of the table by that model: of the smooth field with its
/// stiffening.
[[nodiscard]] RenderedStiffness model_stiffness(const ResponseDatabase& database,
                                                const ResponseTable& table,
                                                LocalModel model, double force_max_n);

}  // namespace palpate
