// `palpate-run bench fidelity`: how truly each local model renders a poke.
#pragma once

#include <string>
#include <vector>

#include "runtime/account/local_model.h"

namespace palpate {

/// Pokes x = depth sin^2(pi frequency t) into f = a x^p with f(depth) = force.
struct FidelityOptions {
  std::vector<double> exponents{1.0, 1.5, 2.0, 3.0};
  std::vector<double> frequencies_hz{0.5, 2.0};
  double depth_m = 0.01;   ///< [m] > 0
  double force_n = 2.0;    ///< [N] > 0
  double slow_hz = 100.0;  ///< divides fast_hz
  double fast_hz = 2000.0;
  int pokes = 4;
};

struct FidelityRow {
  double exponent = 0.0;
  double frequency_hz = 0.0;
  LocalModel model = LocalModel::kSingle;
  double rms_relative_error =
      0.0;                       ///< [-] rms of the force error over rms of the force
  double net_energy_j = 0.0;     ///< [J] absorbed over all pokes, ends outside; exact
  double lowest_energy_j = 0.0;  ///< [J] lowest that the account ever was
  double stored_energy_j = 0.0;  ///< [J] what the true curve stores at full depth
};

[[nodiscard]] FidelityRow run_poke(const FidelityOptions& options, double exponent,
                                   double frequency_hz, LocalModel model);

/// Every exponent, frequency and model.
/// @throws InputError if the slow rate does not divide the fast one.
[[nodiscard]] std::vector<FidelityRow> run_fidelity(const FidelityOptions& options);

[[nodiscard]] std::string table_text(const std::vector<FidelityRow>& rows);
[[nodiscard]] std::string to_json(const std::vector<FidelityRow>& rows);

}  // namespace palpate
