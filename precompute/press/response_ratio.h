// How a full solution of a node's press compares with a linear one, and what that says
// about its neighbours.
//
// A ratio needs two forces that mean the same thing. A press is a valid predictor where
// it carries force at every depth after the first touch. A press may carry no force at
// some depth: the tool leaves contact on its way, or touches twice. Nothing can be
// divided by such a press, and nothing scaled.
//
// Two predictors are comparable where the ratio of their forces lies between 1/10 and
// 10 at every depth. Otherwise the full press follows another mechanism than the linear
// one: it lost contact, or a fold closed. The ratio of such a vertex says nothing about
// other vertices, but that these may be as odd. The vertex keeps its own full press,
// and the vertices around it are not interpolated without more solves.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {

/// Good over linear along a path.
struct PathRatio {
  Eigen::VectorXd force;  ///< (k) [-] at the linear path's samples but the first
  /// (k x 3) [-] full direction minus the linear one.
  Eigen::MatrixX3d turn;
  /// (k) [-] Weight of sample k's ratio in an error, as in force_difference(). The
  /// weight is 0 below a tenth of the depth, and less where the force is below a tenth
  /// of the largest.
  Eigen::VectorXd weight;
  /// [-] [0, 1] part of what it was made of that comes from near-singular presses.
  double hard_share = 0.0;
};

/// Whether a path can be scaled, or divided by. It has at least two samples after the
/// first touch, all numbers finite, and force at each sample (above 1e-9 of the
/// largest).
[[nodiscard]] bool is_predictor(const Indentation& path);

/// Of two presses on one mesh, so at the same depths: its errors are alike in both and
/// cancel. None where either path is no valid predictor, or they are not alike. Where
/// the full path is shorter its last ratio goes on.
[[nodiscard]] std::optional<PathRatio> path_ratio(const Indentation& full,
                                                  const Indentation& linear);

/// A linear path, on any mesh, scaled and turned sample by sample. Hard to follow where
/// half of the ratio or more is of such presses. It ends early where the linear path
/// was capped and its force is not past force_max_n there.
[[nodiscard]] Indentation scaled(const Indentation& linear, const PathRatio& ratio,
                                 double force_max_n);

}  // namespace palpate
