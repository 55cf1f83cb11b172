// How the whole surface moves under each solved node, for viewers: few modes for all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/database/response_database.h"
#include "formats/scene/scene.h"
#include "precompute/body/coarse_body.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/fem/tet_locator.h"
#include "precompute/press/node_press.h"
#include "precompute/press/scene_solver.h"
#include "precompute/process/progress.h"

namespace palpate {

/// Displacements of the body's vertices under presses of its nodes.
struct PressFields {
  std::vector<std::int32_t> node;  ///< (k)
  std::vector<double> depth_m;     ///< (k) penetration, the deepest that was solved
  Eigen::MatrixXd field_m;         ///< (3 n_vertices x k)
};

/// Fields of the presses' surface displacement. A nonlinear press with its state
/// (PressMode::keep_states) has the solved field. Any other press has the linear body's
/// field under the pressures of the last sample. Presses without a contact are left
/// out.
/// @param model whose first nodes are the vertices.
/// @param nodes pressed on the model.
[[nodiscard]] PressFields press_fields(const BodyModel& model, Eigen::Index vertices,
                                       std::span<const PressedNode> nodes);

/// The fields of a part that is cut out of the body, linear. The part's own vertices
/// move as in front of the coarse body, all others with the coarse body. The other
/// vertices are at rest where `rest` is none.
/// @param place (vertices) in the coarse body.
[[nodiscard]] PressFields part_fields(const ClampedPart& part, const CoarseBody* rest,
                                      std::span<const TetLocator::Place> place,
                                      Eigen::Index vertices,
                                      std::span<const PressedNode> nodes);

/// Basis and coefficients of the fields. The basis has left singular vectors of the
/// fields, each field divided by its largest displacement. The number of vectors is the
/// least for an error of at most `error_relative` of a field's largest displacement, at
/// any vertex of any field. Node, depth and the errors of the numbers as they are
/// stored (L2 over vertices) are kept with them.
/// @param fields no column zero. @param error_relative (0, 1).
[[nodiscard]] DisplacementField compress_fields(const PressFields& fields,
                                                double error_relative);

/// Gives every tool's table the fields of its solved nodes, as the scene's [drawing]
/// wants them. The fields are solved on a shared mesh made for them, at the cost of one
/// more factor and the presses once more. These presses are nonlinear where the body
/// is, and on cut-outs where the strategy has cut-outs.
/// @throws InputError where fields are too many to compute.
void add_surface_fields(const Scene& scene, const BodySource& body,
                        const PressStrategy& strategy,
                        std::span<const std::int32_t> reachable,
                        ResponseDatabase& database, Progress& progress);

}  // namespace palpate
