// Boundary elements of a linear viscoelastic half-space under a rigid sphere without
// friction; contact can be lost. Memory at sites of a surface is measured by these
// boundary elements.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "tests/support/relaxation_reference.h"

namespace palpate {

/// Square cells with even pressure (Love 1929); pressures relax as Prony's terms say,
/// which for one spectrum is exact (correspondence principle). The plane strain modulus
/// of a sudden press is 1 Pa: forces go with it.
class ViscoelasticHalfSpace {
 public:
  ViscoelasticHalfSpace(int columns, int rows, double cell_m, double radius_m,
                        const PronyTerms2& terms)
      : columns_(columns),
        rows_(rows),
        cell_m_(cell_m),
        radius_m_(radius_m),
        terms_(terms),
        influence_m_(columns * rows),
        pressure_(Eigen::VectorXd::Zero(columns * rows)),
        carried_(pressure_),
        relaxed_{pressure_, pressure_} {
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        influence_m_[j * columns + i] =
            love_m(i * cell_m, j * cell_m, 0.5 * cell_m) / 3.14159265358979;
      }
    }
  }

  /// Normal force and force along x [N] of the sphere after a step of time. The sphere
  /// is centred at x in the middle row, its lowest point at a depth.
  std::array<double, 2> step(double x_m, double depth_m, double dt_s) {
    const Eigen::Index n = pressure_.size();
    Eigen::VectorXd gap_m(n);
    std::vector<Eigen::Index> candidate;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double dx = place_x_m(i) - x_m;
      const double dy =
          (static_cast<double>(i / columns_) + 0.5 - 0.5 * rows_) * cell_m_;
      gap_m[i] = depth_m - (dx * dx + dy * dy) / (2.0 * radius_m_);
      if (gap_m[i] > 0.0) {
        candidate.push_back(i);
      }
    }
    press(candidate, gap_m);
    std::array<double, 2> force{};
    for (const Eigen::Index i : candidate) {
      const double f = pressure_[i] * cell_m_ * cell_m_;
      force[0] += f;
      force[1] -= f * (place_x_m(i) - x_m) / radius_m_;
    }
    const Eigen::VectorXd whole = pressure_ + carried_;
    carried_.setZero();
    for (std::size_t k = 0; k < 2; ++k) {
      relaxed_[k] = whole + std::exp(-dt_s / terms_.tau_s[k]) * (relaxed_[k] - whole);
      carried_ += terms_.g[k] * relaxed_[k];
    }
    return force;
  }

 private:
  // Depth under the middle of a cell at distance (x, y) from one of half side b.
  static double love_m(double x, double y, double b) {
    const double xp = x + b, xm = x - b, yp = y + b, ym = y - b;
    return xp * std::log((yp + std::hypot(yp, xp)) / (ym + std::hypot(ym, xp))) +
           yp * std::log((xp + std::hypot(yp, xp)) / (xm + std::hypot(yp, xm))) +
           xm * std::log((ym + std::hypot(ym, xm)) / (yp + std::hypot(yp, xm))) +
           ym * std::log((xm + std::hypot(ym, xm)) / (xp + std::hypot(ym, xp)));
  }

  [[nodiscard]] double place_x_m(Eigen::Index i) const {
    return (static_cast<double>(i % columns_) + 0.5) * cell_m_;
  }
  [[nodiscard]] double influence(Eigen::Index i, Eigen::Index j) const {
    return influence_m_[std::abs(i / columns_ - j / columns_) * columns_ +
                        std::abs(i % columns_ - j % columns_)];
  }

  // Pressures >= 0 that bring the surface, which `carried_` holds down already, to the
  // sphere where they are positive; active sets, each by conjugate gradients.
  void press(const std::vector<Eigen::Index>& candidate, const Eigen::VectorXd& gap_m) {
    Eigen::VectorXd down_m = Eigen::VectorXd::Zero(pressure_.size());
    for (const Eigen::Index i : candidate) {
      for (Eigen::Index j = 0; j < carried_.size(); ++j) {
        down_m[i] += carried_[j] > 0.0 ? influence(i, j) * carried_[j] : 0.0;
      }
    }
    std::vector<Eigen::Index> active;
    for (const Eigen::Index i : candidate) {
      if (pressure_[i] > 0.0 || gap_m[i] > down_m[i]) {
        active.push_back(i);
      }
    }
    for (int round = 0; round < 40; ++round) {
      pressure_.setZero();
      const Eigen::VectorXd solved = solve(active, gap_m - down_m);
      std::vector<Eigen::Index> next;
      for (std::size_t a = 0; a < active.size(); ++a) {
        const double p = solved[static_cast<Eigen::Index>(a)];
        pressure_[active[a]] = std::max(0.0, p);
        if (p >= 0.0) {
          next.push_back(active[a]);
        }
      }
      if (next.size() == active.size()) {
        for (const Eigen::Index i : candidate) {
          double u = down_m[i];
          for (const Eigen::Index j : active) {
            u += influence(i, j) * pressure_[j];
          }
          if (pressure_[i] == 0.0 && u < gap_m[i] - 1e-12) {
            next.push_back(i);
          }
        }
        if (next.size() == active.size()) {
          return;
        }
        std::sort(next.begin(), next.end());
      }
      active = next;
    }
  }

  [[nodiscard]] Eigen::VectorXd solve(const std::vector<Eigen::Index>& active,
                                      const Eigen::VectorXd& wanted_m) const {
    const auto n = static_cast<Eigen::Index>(active.size());
    Eigen::MatrixXd A(n, n);
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index b = 0; b < n; ++b) {
        A(a, b) = influence(active[static_cast<std::size_t>(a)],
                            active[static_cast<std::size_t>(b)]);
      }
    }
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd r = wanted_m(active);
    Eigen::VectorXd z = r;
    double rr = r.squaredNorm();
    const double enough = 1e-18 * rr;
    for (int i = 0; i < 150 && rr > enough; ++i) {
      const Eigen::VectorXd Az = A * z;
      const double length = rr / z.dot(Az);
      x += length * z;
      r -= length * Az;
      const double now = r.squaredNorm();
      z = r + now / rr * z;
      rr = now;
    }
    return x;
  }

  Eigen::Index columns_;
  int rows_;
  double cell_m_;
  double radius_m_;
  PronyTerms2 terms_;
  Eigen::VectorXd influence_m_;
  Eigen::VectorXd pressure_;
  Eigen::VectorXd carried_;
  std::array<Eigen::VectorXd, 2> relaxed_;
};

}  // namespace palpate
