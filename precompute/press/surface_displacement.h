// How the whole surface moves under each solved node, for viewers: few modes for all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/database/response_database.h"
#include "formats/scene/scene.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/node_press.h"
#include "precompute/press/scene_solver.h"
#include "precompute/process/progress.h"

namespace palpate {

/// Displacements of the body's vertices [m], one column per node: of the linear body
/// under the pressures of the node's last sample, whatever the body's laws (enough to
/// draw it, not to measure it). @return (3 n_vertices x n_nodes).
/// @param model whose first nodes are the vertices. @param nodes linear presses of two
/// or more samples.
[[nodiscard]] Eigen::MatrixXd surface_displacements_m(
    const BodyModel& model, Eigen::Index vertices, std::span<const PressedNode> nodes);

/// Basis and coefficients of the fields: left singular vectors of the fields, each
/// divided by its largest displacement, as many as are needed until no vertex of any
/// field is off by more than `error_relative` of that field's largest displacement.
/// Node, depth and, of the numbers as they are stored, the errors (L2 over vertices)
/// with them. @param field_m (3 n x k), no column zero. @param error_relative (0, 1).
[[nodiscard]] DisplacementField compress_fields(const Eigen::MatrixXd& field_m,
                                                std::span<const PressedNode> nodes,
                                                double error_relative);

/// Gives every tool's table the fields of its solved nodes, as the scene's [drawing]
/// wants them. On a shared mesh of their own, made for this: one more factor.
void add_surface_fields(const Scene& scene, const BodySource& body,
                        const PressStrategy& strategy,
                        std::span<const std::int32_t> reachable,
                        ResponseDatabase& database, Progress& progress);

}  // namespace palpate
