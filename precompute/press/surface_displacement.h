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

/// @param model whose first nodes are the vertices. @param nodes pressed on it: of a
/// nonlinear press with its state (PressMode::keep_states) the field is the solved one,
/// else the linear body's under the pressures of the last sample. Presses without a
/// contact are left out.
[[nodiscard]] PressFields press_fields(const BodyModel& model, Eigen::Index vertices,
                                       std::span<const PressedNode> nodes);

/// The same of a part that is cut out of the body, linear: its own vertices as it moves
/// in front of the coarse body, all others with the coarse body; at rest where `rest`
/// is none. @param place (vertices) in the coarse body.
[[nodiscard]] PressFields part_fields(const ClampedPart& part, const CoarseBody* rest,
                                      std::span<const TetLocator::Place> place,
                                      Eigen::Index vertices,
                                      std::span<const PressedNode> nodes);

/// Basis and coefficients of the fields: left singular vectors of the fields, each
/// divided by its largest displacement, as many as are needed until no vertex of any
/// field is off by more than `error_relative` of that field's largest displacement.
/// Node, depth and, of the numbers as they are stored, the errors (L2 over vertices)
/// with them. @param fields no column zero. @param error_relative (0, 1).
[[nodiscard]] DisplacementField compress_fields(const PressFields& fields,
                                                double error_relative);

/// Gives every tool's table the fields of its solved nodes, as the scene's [drawing]
/// wants them. On a shared mesh of their own, made for this: one more factor, and the
/// presses once more, nonlinear where the body is; on cut-outs where the strategy has
/// them. @throws InputError where fields are too many to compute.
void add_surface_fields(const Scene& scene, const BodySource& body,
                        const PressStrategy& strategy,
                        std::span<const std::int32_t> reachable,
                        ResponseDatabase& database, Progress& progress);

}  // namespace palpate
