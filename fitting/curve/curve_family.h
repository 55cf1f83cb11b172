// Families of force curves f(d; q), d >= 0 the depth beyond the contact point, f(0) =
// 0.
//
// Depth and force are scaled: d = 1 is the largest depth measured, f = 1 the range of
// the force. All families but interpolating rise (f' >= 0); all but it and
// monotone-cubic are convex.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace palpate {

/// Names of the curve families, as session files and reports write them.
inline constexpr std::array<std::string_view, 7> kFamilyNames{
    "quadratic-linear", "power-law",      "linear-exponential", "polynomial",
    "convex-spline",    "monotone-cubic", "interpolating"};

struct FamilyParameter {
  std::string_view name;
  std::string_view unit;  ///< SI unit; empty for a pure number
  double lower, upper;    ///< in scaled units
  int force_power;        ///< SI value = q (force range)^force_power
  int length_power;       ///<            (largest depth)^length_power
};

/// One point of a curve: force, its derivative by depth, and its integral from 0.
struct FamilyPoint {
  double force = 0.0;
  double slope = 0.0;
  double energy = 0.0;
};

class CurveFamily {
 public:
  virtual ~CurveFamily() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] const std::vector<FamilyParameter>& parameters() const {
    return parameters_;
  }

  /// All zero for d <= 0.
  [[nodiscard]] virtual FamilyPoint at(std::span<const double> q, double d) const = 0;

  /// df/dq (p) at d; zero for d <= 0.
  virtual void gradient(std::span<const double> q, double d,
                        std::span<double> row) const = 0;

  /// Whether f is linear in q, all of which are >= 0: fitted without a start.
  [[nodiscard]] virtual bool linear() const { return false; }

  /// (m) [-] depths between which it is one cubic, as response_curve.h has it; empty:
  /// it is none.
  [[nodiscard]] virtual std::vector<double> knots() const { return {}; }

  /// Where to start from; each reaches about f(1) = 1.
  [[nodiscard]] virtual std::vector<Eigen::VectorXd> starts() const { return {}; }

 protected:
  void add_parameter(const FamilyParameter& parameter) {
    parameters_.push_back(parameter);
  }

 private:
  std::vector<FamilyParameter> parameters_;
};

/// f = k d^2 up to d1, then on along its tangent: k d1 (2 d - d1). (Equation (25).)
[[nodiscard]] std::shared_ptr<const CurveFamily> quadratic_linear_family();

/// f = F d^p, F the force at the largest depth, p in [1, 4].
[[nodiscard]] std::shared_ptr<const CurveFamily> power_law_family();

/// f = k d + B (exp(d / l) - 1) / (exp(1 / l) - 1).
[[nodiscard]] std::shared_ptr<const CurveFamily> linear_exponential_family();

/// f = sum c_i d^i, i = 1 to 4, c_i >= 0.
[[nodiscard]] std::shared_ptr<const CurveFamily> polynomial_family();

/// Convex cubic spline: f'(0) >= 0 and f'' >= 0 at `knots` even knots from 0 to 1,
/// linear between them; linear beyond 1. Every convex, rising cubic spline on these
/// knots is one.
[[nodiscard]] std::shared_ptr<const CurveFamily> convex_spline_family(int knots = 10);

/// C1 cubic that does not overshoot (response_curve.h) through (0, 0) and the forces q
/// at these depths. The gradient is that of the polygon through them.
/// @param name "monotone-cubic", whose forces rise, or "interpolating", whose need not.
/// @param depth (m) rising, > 0
[[nodiscard]] std::shared_ptr<const CurveFamily> cubic_family(
    std::string_view name, std::vector<double> depth);

/// By its name of kFamilyNames; null for those of cubic_family(), whose depths come
/// from the data. @throws InputError for another name.
[[nodiscard]] std::shared_ptr<const CurveFamily> family_by_name(std::string_view name);

}  // namespace palpate
