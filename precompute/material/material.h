// Constitutive laws behind one type: energy, stress and tangent of the distortion, and
// a volume term that an element averages.
//
// W(F) = distortion(F) + k/2 theta(F)^2. All functions here are pure, allocate nothing
// and do not throw; the factories in the headers of the laws check and throw.
#pragma once

#include <variant>

#include "precompute/material/law_response.h"
#include "precompute/material/material_fibre.h"
#include "precompute/material/material_hyperelastic.h"
#include "precompute/material/material_linear.h"
#include "precompute/material/material_ogden.h"
#include "precompute/material/volume_term.h"

namespace palpate {

using Material = std::variant<Linear, StVenantKirchhoff, NeoHookean, MooneyRivlin,
                              Ogden, TransverselyIsotropic, FibreExponential>;

/// The part of the energy taken at a point, everything but the volume term [J/m^3]. It
/// is +inf where the law does not admit F (det F <= 0 for the laws in Ibar or
/// stretches).
[[nodiscard]] double distortion_energy(const Material& material,
                                       const Eigen::Matrix3d& F);

/// With first and second derivative by F; see LocalResponse for inadmissible F.
[[nodiscard]] LocalResponse distortion_response(const Material& material,
                                                const Eigen::Matrix3d& F);

/// What the volume term k/2 theta^2 measures.
[[nodiscard]] VolumeMeasure volume_measure(const Material& material);

/// k [Pa] >= 0; 0 for VolumeMeasure::kNone.
[[nodiscard]] double volume_modulus_pa(const Material& material);

/// True for laws whose stress is linear in F: one solve is exact.
[[nodiscard]] bool is_linear(const Material& material);

/// True for laws whose stiffness at rest depends on the direction of the strain: fibres
/// that bear nothing when compressed. Its tangent at rest is that of pulled fibres.
[[nodiscard]] bool has_kink(const Material& material);

/// Distortion and volume term at one point: for tests and for laws without averaging.
[[nodiscard]] LocalResponse response(const Material& material,
                                     const Eigen::Matrix3d& F);

/// At small strain [Pa]; for a law with fibres, of the isotropic mean. For scales.
[[nodiscard]] double small_shear_modulus_pa(const Material& material);
[[nodiscard]] double small_youngs_modulus_pa(const Material& material);

}  // namespace palpate
