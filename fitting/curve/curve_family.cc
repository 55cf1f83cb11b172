#include "fitting/curve/curve_family.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fitting/numerics/least_squares.h"
#include "formats/base/error.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

Eigen::VectorXd vector_of(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.begin(),
                                           static_cast<Eigen::Index>(values.size()));
}

class QuadraticLinear : public CurveFamily {
 public:
  QuadraticLinear() {
    add_parameter({"k", "N/m^2", 0.0, kInf, 1, -2});
    add_parameter({"d1", "m", 0.02, 1.0, 0, 1});
  }
  std::string_view name() const override { return "quadratic-linear"; }

  FamilyPoint at(std::span<const double> q, double d) const override {
    const double k = q[0], d1 = q[1];
    if (d <= 0.0) {
      return {};
    }
    if (d <= d1) {
      return {k * d * d, 2.0 * k * d, k * d * d * d / 3.0};
    }
    return {k * d1 * (2.0 * d - d1), 2.0 * k * d1,
            k * d1 * (d1 * d1 / 3.0 + d * (d - d1))};
  }

  void gradient(std::span<const double> q, double d,
                std::span<double> row) const override {
    const double k = q[0], d1 = q[1];
    row[0] = d <= 0.0 ? 0.0 : d <= d1 ? d * d : d1 * (2.0 * d - d1);
    row[1] = d <= d1 ? 0.0 : 2.0 * k * (d - d1);
  }

  std::vector<Eigen::VectorXd> starts() const override {
    std::vector<Eigen::VectorXd> all;
    for (const double d1 : {0.2, 0.5, 0.9}) {
      all.push_back(vector_of({1.0 / (d1 * (2.0 - d1)), d1}));
    }
    return all;
  }
};

class PowerLaw : public CurveFamily {
 public:
  PowerLaw() {
    add_parameter({"force_at_depth_max", "N", 0.0, kInf, 1, 0});
    add_parameter({"exponent", "", 1.0, 4.0, 0, 0});
  }
  std::string_view name() const override { return "power-law"; }

  FamilyPoint at(std::span<const double> q, double d) const override {
    if (d <= 0.0) {
      return {};
    }
    const double f = q[0] * std::pow(d, q[1]);
    return {f, q[1] * f / d, f * d / (q[1] + 1.0)};
  }

  void gradient(std::span<const double> q, double d,
                std::span<double> row) const override {
    const double log_d = d > 0.0 ? std::log(d) : 0.0;
    row[0] = d > 0.0 ? std::exp(q[1] * log_d) : 0.0;
    row[1] = q[0] * row[0] * log_d;
  }

  std::vector<Eigen::VectorXd> starts() const override {
    return {vector_of({1.0, 1.2}), vector_of({1.0, 2.0}), vector_of({1.0, 3.0})};
  }
};

// B is what the exponential adds at d = 1: with the textbook's factor, B / (e^(1/l) -
// 1), a short l would need one of 1e-14.
class LinearExponential : public CurveFamily {
 public:
  LinearExponential() {
    add_parameter({"k", "N/m", 0.0, kInf, 1, -1});
    add_parameter({"B", "N", 0.0, kInf, 1, 0});
    add_parameter({"l", "m", 0.03, 3.0, 0, 1});
  }
  std::string_view name() const override { return "linear-exponential"; }

  FamilyPoint at(std::span<const double> q, double d) const override {
    if (d <= 0.0) {
      return {};
    }
    // f = k d + A (e^(d/l) - 1), A = B / (e^(1/l) - 1).
    const double k = q[0], l = q[2], A = q[1] / std::expm1(1.0 / l);
    const double rise = std::expm1(d / l);
    return {k * d + A * rise, k + A * (rise + 1.0) / l,
            0.5 * k * d * d + A * (l * rise - d)};
  }

  void gradient(std::span<const double> q, double d,
                std::span<double> row) const override {
    std::fill(row.begin(), row.end(), 0.0);
    if (d > 0.0) {
      // By l: d e^(d/l)/dl = -d/l^2 e^(d/l), in the numerator and (d = 1) in the
      // denominator.
      const double l = q[2], end = std::expm1(1.0 / l), rise = std::expm1(d / l);
      row[0] = d;
      row[1] = rise / end;
      row[2] =
          q[1] / (l * l) * (rise / end * (1.0 + 1.0 / end) - d * (rise + 1.0) / end);
    }
  }

  std::vector<Eigen::VectorXd> starts() const override {
    return {vector_of({0.5, 0.5, 0.1}), vector_of({0.5, 0.5, 0.3}),
            vector_of({0.5, 0.5, 1.0})};
  }
};

class Polynomial : public CurveFamily {
 public:
  Polynomial() {
    constexpr std::string_view kNames[] = {"c1", "c2", "c3", "c4"};
    constexpr std::string_view kUnits[] = {"N/m", "N/m^2", "N/m^3", "N/m^4"};
    for (int i = 0; i < 4; ++i) {
      add_parameter({kNames[i], kUnits[i], 0.0, kInf, 1, -(i + 1)});
    }
  }
  std::string_view name() const override { return "polynomial"; }
  bool linear() const override { return true; }

  FamilyPoint at(std::span<const double> q, double d) const override {
    FamilyPoint point;
    double power = 1.0;  // d^(i - 1)
    for (int i = 1; i <= 4 && d > 0.0; ++i) {
      const double c = q[static_cast<std::size_t>(i - 1)];
      point.force += c * power * d;
      point.slope += c * i * power;
      point.energy += c * power * d * d / (i + 1);
      power *= d;
    }
    return point;
  }

  void gradient(std::span<const double>, double d,
                std::span<double> row) const override {
    double power = std::max(d, 0.0);
    for (double& value : row) {
      value = power;
      power *= d;
    }
  }
};

// f'' = sum c_j hat_j: hats are second differences of ramps, so that f, f' and the
// energy are those of their powers.
class ConvexSpline : public CurveFamily {
 public:
  explicit ConvexSpline(int knots) : intervals_(knots - 1) {
    add_parameter({"slope_at_contact", "N/m", 0.0, kInf, 1, -1});
    for (int j = 0; j < knots; ++j) {
      add_parameter({"curvature", "N/m^2", 0.0, kInf, 1, -2});
    }
  }
  std::string_view name() const override { return "convex-spline"; }
  bool linear() const override { return true; }

  FamilyPoint at(std::span<const double> q, double d) const override {
    FamilyPoint point;
    for (int j = -1; j <= intervals_ && d > 0.0; ++j) {
      const FamilyPoint part = basis(j, d);
      const double c = q[static_cast<std::size_t>(j) + 1];
      point.force += c * part.force;
      point.slope += c * part.slope;
      point.energy += c * part.energy;
    }
    return point;
  }

  void gradient(std::span<const double>, double d,
                std::span<double> row) const override {
    for (int j = -1; j <= intervals_; ++j) {
      row[static_cast<std::size_t>(j) + 1] = d > 0.0 ? basis(j, d).force : 0.0;
    }
  }

 private:
  // The part of curvature j, -1 for the slope at 0.
  FamilyPoint basis(int j, double d) const {
    // Past the last knot the curve goes on straight.
    if (d > 1.0) {
      const FamilyPoint end = basis(j, 1.0);
      const double on = d - 1.0;
      return {end.force + end.slope * on, end.slope,
              end.energy + end.force * on + 0.5 * end.slope * on * on};
    }
    if (j < 0) {
      return {d, 1.0, 0.5 * d * d};
    }
    // Ramps z = <d - knot> of weight 1/h, -2/h, 1/h make hat j of f''. Its integrals
    // are z^2/2 (slope), z^3/6 (force) and z^4/24 (energy). Hat 0 is 1 less a ramp at
    // first.
    const double h = 1.0 / intervals_;
    FamilyPoint part;
    const auto add = [&](double weight, double knot) {
      const double z = d - knot;
      if (z > 0.0) {
        part.force += weight * z * z * z / 6.0;
        part.slope += weight * z * z / 2.0;
        part.energy += weight * z * z * z * z / 24.0;
      }
    };
    if (j == 0) {
      part = {d * d / 2.0, d, d * d * d / 6.0};
      add(-1.0 / h, 0.0);
      add(1.0 / h, h);
    } else {
      add(1.0 / h, (j - 1) * h);
      add(-2.0 / h, j * h);
      add(1.0 / h, (j + 1) * h);
    }
    return part;
  }

  int intervals_;
};

class Cubic : public CurveFamily {
 public:
  Cubic(std::string_view name, std::vector<double> depth)
      : name_(name), depth_(std::move(depth)) {
    depth_.insert(depth_.begin(), 0.0);
    for (std::size_t j = 1; j < depth_.size(); ++j) {
      add_parameter({"force", "N", 0.0, kInf, 1, 0});
    }
  }
  std::string_view name() const override { return name_; }
  std::vector<double> knots() const override { return depth_; }

  FamilyPoint at(std::span<const double> q, double d) const override {
    if (d <= 0.0) {
      return {};
    }
    std::vector<double> force{0.0};
    force.insert(force.end(), q.begin(), q.end());
    const auto point = ResponseCurve(depth_, force).at(d);
    // Of forces that are none negative: below 0 are rounding and what is beyond them.
    return {std::max(0.0, point.force_n), point.stiffness_n_per_m, point.energy_j};
  }

  void gradient(std::span<const double>, double d,
                std::span<double> row) const override {
    std::fill(row.begin(), row.end(), 0.0);
    if (d <= 0.0) {
      return;
    }
    // By the forces at the knots, of the polygon through them.
    const auto above = std::upper_bound(depth_.begin(), depth_.end() - 1, d);
    const auto j = static_cast<std::size_t>(above - depth_.begin());
    const double t = (d - depth_[j - 1]) / (depth_[j] - depth_[j - 1]);
    row[j - 1] = t;
    if (j >= 2) {
      row[j - 2] = 1.0 - t;
    }
  }

 private:
  std::string_view name_;
  std::vector<double> depth_;
};

}  // namespace

std::shared_ptr<const CurveFamily> quadratic_linear_family() {
  return std::make_shared<QuadraticLinear>();
}

std::shared_ptr<const CurveFamily> power_law_family() {
  return std::make_shared<PowerLaw>();
}

std::shared_ptr<const CurveFamily> linear_exponential_family() {
  return std::make_shared<LinearExponential>();
}

std::shared_ptr<const CurveFamily> polynomial_family() {
  return std::make_shared<Polynomial>();
}

std::shared_ptr<const CurveFamily> convex_spline_family(int knots) {
  return std::make_shared<ConvexSpline>(knots);
}

std::shared_ptr<const CurveFamily> cubic_family(std::string_view name,
                                                std::vector<double> depth) {
  const auto known = std::find(kFamilyNames.begin(), kFamilyNames.end(), name);
  return std::make_shared<Cubic>(*known, std::move(depth));
}

std::shared_ptr<const CurveFamily> family_by_name(std::string_view name) {
  if (name == "quadratic-linear") {
    return quadratic_linear_family();
  }
  if (name == "power-law") {
    return power_law_family();
  }
  if (name == "linear-exponential") {
    return linear_exponential_family();
  }
  if (name == "polynomial") {
    return polynomial_family();
  }
  if (name == "convex-spline") {
    return convex_spline_family();
  }
  if (name == "monotone-cubic" || name == "interpolating") {
    return nullptr;
  }
  throw InputError(fmt::format("family \"{}\" is not available; available: {}", name,
                               fmt::join(kFamilyNames, ", ")));
}

}  // namespace palpate
