// Weights and a height over one surface element, continuous with their gradients over
// the whole surface.
//
// The element's corners v_j have outward normals n_j and rises r_j(s) = p_j + s q_j. A
// rise is the gradient that the height s is to have at the corner. The rise is a node's
// force over its normal part, straight in s as the node's tilt is. On the node's line
// v_j + s n_j the height is s, its gradient r_j(s), and the node's weight is 1.
//
// Edge i goes from v_j to v_k (j, k after i, cyclic), e = v_k - v_j. The edge has the
// normal N(t) = n_j + t (n_k - n_j), and m = unit((n_j + n_k) x e). A place x has the
// coordinate t_i along the edge. Its offset from the face that the edge sweeps along
// its normals is beta_i,
//
//   x - (v_j + t e) = alpha N(t) + beta m,
//
// t the root of a quadratic equation near [0, 1]. Both are functions of the edge and of
// x alone: the neighbour has 1 - t and -beta. b_i = (beta_i / altitude_i) / sum are
// shares, >= 0 over the element.
//
// Side weights (Nielson 1979) W_i = (b_j b_k)^2 / sum are 1 on face i, where the others
// vanish with b_i^2. So what they blend is there a function of (x, t_i, beta_i) up to
// second order. With H(t) = t^2 (3 - 2 t) of t held in [0, 1], eps(t) = 2 t^2
// (1 - t)^2:
//
//   w_k += W_i H(t_i),  w_j += W_i (1 - H(t_i)),
//   s = [sum_j w_j p_j . (x - v_j) + sum_i W_i ((t_i - H) beta_i tau_i - eps gamma_i
//        - b_i^2 kappa_i / 2)] / [1 - sum_j w_j q_j . (x - v_j) - sum_i W_i ((t_i - H)
//        beta_i tau'_i + eps gamma'_i + b_i^2 kappa'_i / 2)]
//
// which solves an equation that is straight in s. First order of every node; -eps gamma
// makes s the cubic along the edge: gamma - s gamma' = (r_j - r_k) . (e + s (n_k -
// n_j)), whose s^2 is taken for straight about the height of the tool at touch; tau + s
// tau' = (r_k - r_j) . m lets its slope across the edge go over linearly; kappa is the
// bend towards the third corner, of the three gamma. So in a plane s reproduces every
// quadratic of the place.
//
// Neighbours share value and gradient on the face, whatever their triangles. So
// functions of w and s that use the nodes' data alone are C1 there, and at the nodes'
// lines.
#pragma once

#include <array>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/smooth_edges.h"
#include "runtime/element/turned.h"

namespace palpate {

/// Where a place is by the three edges.
struct SmoothSides {
  EdgeValues along;             ///< [-] t_i
  EdgeValues offset_m;          ///< [m] beta_i
  EdgeValues altitudes;         ///< [-] beta_i / altitude_i; < 0: beyond
  EdgeVectors along_gradient;   ///< [1/m] of t_i
  EdgeVectors offset_gradient;  ///< [-] of beta_i
  std::array<bool, 3> sound{};  ///< the edge has coordinates there; else altitude 0
};

[[nodiscard]] SmoothSides sides_at(const SmoothTriangle& triangle,
                                   const Vector3& x_m) noexcept;

/// Least stretch at which a place is still taken for sound. The value bounds the
/// stretch of coordinates, their sum and the height's equation, relative to what they
/// are on the triangle.
constexpr Real kStretchMin = 0.2;

/// Weights and height at a place.
struct SmoothPoint {
  Vector3 weight = Vector3::Zero();  ///< [-] w_j >= 0, sum 1
  Turn turn = Turn::Zero();          ///< [1/m] gradient of w_j, one per row
  Real height_m = 0.0;               ///< [m] s
  Vector3 rise = Vector3::Zero();    ///< [-] gradient of s
};

/// The element's own functions at a place over it. @returns whether they are sound.
[[nodiscard]] bool set_inside(const SmoothTriangle& triangle, const SmoothSides& sides,
                              const Vector3& x_m, SmoothPoint& point) noexcept;

/// Continuation of these functions beyond the element's edges, where no neighbour is at
/// hand. The continuation is that of the edge beyond which x is; that edge's ends go on
/// as their tangent planes. With its gradient continuous over the edge. @returns
/// whether it is sound.
[[nodiscard]] bool set_beyond(const SmoothTriangle& triangle, const SmoothSides& sides,
                              const Vector3& x_m, SmoothPoint& point) noexcept;

}  // namespace palpate
