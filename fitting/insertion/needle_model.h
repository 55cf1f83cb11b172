// Force on a needle in a tissue of layers, and its derivatives.
//
//   F = b + d t + f(e) + q,   f(e) = c e^n,   e = max(z - z0 - L, 0)
//
// Symbols: F force [N], f force of the tip, q friction of the shaft. z is the depth of
// the needle [m], z0 the contact point, L the depth of the channel that the tip has
// opened. e is the deflection of the tissue before the tip [m]; c [N/m^n] and n [-]
// belong to the curve before rupture. The baseline has the offset b [N] and the drift d
// [N] over the clock t [-].
//
// Layer k lies between the boundaries B_(k-1) and B_k, B_0 = 0, each behind a membrane.
// After s ruptures the tip cuts layer s, with the cutting force C_s. The channel grows:
//
//   L = max(L', min(z - z0 - (C_s / c)^(1/n), B_s)),   L = 0 before the first rupture
//
// L' is the channel of the passes before. At a boundary the force rises along f again.
// phi_k is the friction per length [N/m] of a layer, and l = min(z - z0, L) the
// inserted length. Phi(l) sums phi_k over l. The friction of the shaft is
//
//   q = Phi(l) inwards,   q = -Phi(l) outwards,
//   q = Phi(l_turn) - k_b (z_turn - z) outwards, as long as the shaft sticks.
//
// Model: Okamura, Simone, O'Leary 2004 (cutting force constant in a tissue); Mahvash
// and Dupont 2010 (rupture). All events lie at known samples, so that F is smooth in
// the parameters but for corners.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "fitting/numerics/least_squares.h"

namespace palpate {

enum class ShaftState { kInwards, kOutwards, kSticks };

struct NeedleSample {
  double depth_m = 0.0;
  double clock = 0.0;  ///< [-] of its file
  int file = 0;
  int pass = 0;
  int ruptures = 0;  ///< before the sample
  ShaftState shaft = ShaftState::kInwards;
};

/// What is known before the parameters.
struct NeedleEvents {
  int ruptures = 0;
  int files = 1;
  double reference_m = 1e-3;       ///< [m] deflection at which f is a parameter
  std::vector<double> turn_m;      ///< (passes) [m] depth of the deepest sample
  std::vector<int> turn_ruptures;  ///< (passes) ruptures until then
};

constexpr int kNeedleParametersMax = 64;

/// A quantity and its derivatives by the parameters.
struct NeedleTerm {
  double value = 0.0;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kNeedleParametersMax, 1> slope;
};

class NeedleModel {
 public:
  /// @throws InputError where the parameters would be more than kNeedleParametersMax.
  explicit NeedleModel(NeedleEvents events);

  // Places of the parameters.
  static constexpr int kLogForce = 0;    ///< ln f(reference_m)
  static constexpr int kExponent = 1;    ///< n
  static constexpr int kContact = 2;     ///< z0 [m]
  static constexpr int kPresliding = 3;  ///< k_b [N/m]
  /// C of layer 1 to ruptures [N].
  [[nodiscard]] int cutting(int layer) const { return 3 + layer; }
  /// phi of layer 1 to ruptures [N/m].
  [[nodiscard]] int friction(int layer) const { return 3 + events_.ruptures + layer; }
  /// B of layer 1 to ruptures - 1 [m].
  [[nodiscard]] int boundary(int layer) const {
    return 3 + 2 * events_.ruptures + layer;
  }
  [[nodiscard]] int offset(int file) const {
    return 3 + 3 * events_.ruptures + 2 * file;
  }
  [[nodiscard]] int drift(int file) const { return offset(file) + 1; }
  /// How far a pass turns beyond its deepest sample [m].
  [[nodiscard]] int turn(int pass) const { return offset(events_.files) + pass; }
  [[nodiscard]] int parameters() const {
    return turn(static_cast<int>(events_.turn_m.size()));
  }
  [[nodiscard]] const NeedleEvents& events() const { return events_; }

  /// c [N/m^n].
  [[nodiscard]] double coefficient(const Eigen::VectorXd& q) const;
  /// e = (C / c)^(1/n) while layer 1 to ruptures is cut.
  [[nodiscard]] NeedleTerm cutting_deflection(const Eigen::VectorXd& q,
                                              int layer) const;
  /// Depth L of the channel at the end of each pass.
  [[nodiscard]] std::vector<NeedleTerm> channels(const Eigen::VectorXd& q) const;
  /// L at a depth, `before` the channel of the passes before.
  [[nodiscard]] NeedleTerm channel(const Eigen::VectorXd& q, const NeedleTerm& depth,
                                   int ruptures, const NeedleTerm& before) const;
  [[nodiscard]] NeedleTerm tip_force(const Eigen::VectorXd& q, double depth_m,
                                     const NeedleTerm& channel) const;
  /// Phi(l) for min(z - z0, L).
  [[nodiscard]] NeedleTerm shaft_friction(const Eigen::VectorXd& q,
                                          const NeedleTerm& depth,
                                          const NeedleTerm& channel) const;
  /// F. @param ends of channels().
  [[nodiscard]] NeedleTerm force(const Eigen::VectorXd& q, const NeedleSample& sample,
                                 const std::vector<NeedleTerm>& ends) const;
  /// A quantity that no parameter changes.
  [[nodiscard]] NeedleTerm constant(double value) const;
  /// Depth at which a pass turns.
  [[nodiscard]] NeedleTerm turn_depth(const Eigen::VectorXd& q, std::size_t pass) const;

  /// Model less measured force, (n), and derivatives (n x parameters()).
  void evaluate(const std::vector<NeedleSample>& samples,
                const std::vector<double>& force_n, const Eigen::VectorXd& q,
                Eigen::Ref<Eigen::VectorXd> residual, RowMajorMatrix* jacobian) const;

 private:
  NeedleEvents events_;
};

}  // namespace palpate
