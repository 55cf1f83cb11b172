// Ogden's law: powers of the principal stretches (Ogden 1972).
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "precompute/material/law_response.h"

namespace palpate {

/// Psi = sum_i mu_i/alpha_i (lbar1^alpha_i + lbar2^alpha_i + lbar3^alpha_i - 3)
///       + K/2 (J - 1)^2, lbar = J^(-1/3) stretch. Energy is +inf for J <= 0.
/// Small-strain shear modulus: 1/2 sum_i mu_i alpha_i > 0.
struct Ogden {
  static constexpr std::size_t kMaxTerms = 4;
  std::array<double, kMaxTerms> mu_pa{};  ///< [Pa], n_terms used
  std::array<double, kMaxTerms> alpha{};  ///< [-] not 0, n_terms used
  std::size_t n_terms = 0;
  double bulk_modulus_pa = 0.0;  ///< [Pa] K > 0
};

/// @param mu_pa, alpha (n), n in [1, 4], finite, alpha not 0.
/// @param poissons_ratio in (-1, 0.5). @throws InputError naming what is out of range.
[[nodiscard]] Ogden ogden(std::span<const double> mu_pa, std::span<const double> alpha,
                          double poissons_ratio);

[[nodiscard]] double distortion_energy(const Ogden& law, const Eigen::Matrix3d& F);
[[nodiscard]] LocalResponse distortion_response(const Ogden& law,
                                                const Eigen::Matrix3d& F);
[[nodiscard]] VolumeTerm volume_term(const Ogden& law);
[[nodiscard]] SmallStrainModuli small_strain_moduli(const Ogden& law);

}  // namespace palpate
