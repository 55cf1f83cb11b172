#include "formats/response/contact_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/LU>
#include <fmt/format.h>

namespace palpate {
namespace {

constexpr auto kStoredDepths = static_cast<Eigen::Index>(kContactDepths);

using Between = BetweenDepths<double>;

std::span<const float> span_of(const RowsOf<float>& rows, Eigen::Index row) {
  return {rows.row(row).data(), static_cast<std::size_t>(rows.cols())};
}

Eigen::Matrix2d tensor_at(const RowsOf<float>& rows, Eigen::Index row,
                          const Between& at) {
  const auto of = span_of(rows, row);
  Eigen::Matrix2d tensor;
  tensor << at.of(of, 3, 0), at.of(of, 3, 1), at.of(of, 3, 1), at.of(of, 3, 2);
  return tensor;
}

bool is_zero(const RowsOf<float>& rows, Eigen::Index row) {
  return (rows.row(row).array() == 0.0F).all();
}

bool is_error(float error) {
  return error >= 0.0F && std::isfinite(error);
}

// Whether xx, xy, yy of every depth are positive definite, their mean at most `most`.
bool are_positive(const RowsOf<float>& rows, Eigen::Index row, double most) {
  for (Eigen::Index k = 0; k < kStoredDepths; ++k) {
    const Eigen::Array3d of =
        rows.row(row).segment<3>(3 * k).cast<double>().transpose();
    if (!of.allFinite() || !(of[0] > 0.0) || !(of[0] * of[2] > of[1] * of[1]) ||
        !(0.5 * (of[0] + of[2]) <= most)) {
      return false;
    }
  }
  return true;
}

double median(std::vector<double>& values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

}  // namespace

ContactTable stacked(std::span<const ContactTable* const> row) {
  ContactTable all;
  const auto stack = [&](RowsOf<float> ContactTable::*part) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const RowsOf<float>& one = row[i]->*part;
      if (one.rows() == 0) {
        continue;
      }
      RowsOf<float>& rows = all.*part;
      if (rows.rows() == 0) {
        rows = RowsOf<float>::Zero(static_cast<Eigen::Index>(row.size()), one.cols());
      }
      rows.row(static_cast<Eigen::Index>(i)) = one.row(0);
    }
  };
  stack(&ContactTable::centre_m);
  stack(&ContactTable::moment_m2);
  stack(&ContactTable::exponent);
  stack(&ContactTable::pressure_error);
  stack(&ContactTable::lateral);
  stack(&ContactTable::lateral_error);
  return all;
}

ContactTable rows_of(const ContactTable& table, std::span<const std::int32_t> nodes) {
  ContactTable some = table;
  const std::vector<std::int32_t> rows_wanted(nodes.begin(), nodes.end());
  for_each_contact_dataset(some, [&](const char* /*name*/, const char* /*units*/,
                                     Eigen::Index /*columns*/, RowsOf<float>& rows) {
    if (rows.rows() > 0) {
      rows = RowsOf<float>(rows(rows_wanted, Eigen::all));
    }
  });
  return some;
}

std::string broken_contact_row(const ContactTable& table, Eigen::Index row) {
  if (table.has_pressure() && !is_zero(table.moment_m2, row)) {
    if (!table.centre_m.row(row).allFinite()) {
      return "pressure/centre_m that is not finite";
    }
    if (!are_positive(table.moment_m2, row, std::numeric_limits<double>::max())) {
      return "pressure/moment_m2 that is not positive definite at every depth";
    }
    const Eigen::RowVectorXf exponent = table.exponent.row(row);
    if (!(exponent.minCoeff() >= static_cast<float>(kPressureExponentLeast) &&
          exponent.maxCoeff() <= static_cast<float>(kPressureExponentMost))) {
      return fmt::format("pressure/exponent outside [{}, {}]", kPressureExponentLeast,
                         kPressureExponentMost);
    }
    if (!is_error(table.pressure_error(row, 0))) {
      return "pressure/error_relative that is not finite and at least 0";
    }
  }
  if (table.has_lateral() && !is_zero(table.lateral, row)) {
    if (!are_positive(table.lateral, row, kLateralMost)) {
      return fmt::format(
          "lateral/stiffness that is not positive definite, or above {}, at some depth",
          kLateralMost);
    }
    if (!is_error(table.lateral_error(row, 0))) {
      return "lateral/error_relative that is not finite and at least 0";
    }
  }
  return "";
}

double ContactPressure::radius_m() const {
  // (a b)^2 = (2 (m + 2))^2 det M
  return std::sqrt(2.0 * (exponent + 2.0) * std::sqrt(moment_m2.determinant()));
}

double ContactPressure::middle_pa() const {
  const double r = radius_m();
  return r > 0.0 ? (exponent + 1.0) * normal_n / (std::numbers::pi * r * r) : 0.0;
}

ContactPressure pressure_at(const ContactTable& table, Eigen::Index row, double share,
                            double normal_n) {
  const Between at = Between::at(share);
  const double shallow = std::clamp(share / kContactDepthShares.front(), 0.0, 1.0);
  return {.normal_n = normal_n,
          .centre_m = {at.of(span_of(table.centre_m, row), 2, 0),
                       at.of(span_of(table.centre_m, row), 2, 1)},
          .moment_m2 = shallow * tensor_at(table.moment_m2, row, at),
          .exponent = at.of(span_of(table.exponent, row), 1, 0)};
}

Eigen::Matrix2d lateral_at(const ContactTable& table, Eigen::Index row, double share) {
  return tensor_at(table.lateral, row, Between::at(share));
}

double relative_difference(const ContactTable& a, const ContactTable& b) {
  if (a.has_pressure() != b.has_pressure() || a.has_lateral() != b.has_lateral() ||
      a.moment_m2.rows() != b.moment_m2.rows() ||
      a.lateral.rows() != b.lateral.rows()) {
    return 1.0;
  }
  double largest = 0.0;
  const auto each = [&](const RowsOf<float>& one, const RowsOf<float>& other,
                        const auto& off) {
    for (Eigen::Index i = 0; i < one.rows(); ++i) {
      if (is_zero(one, i) || is_zero(other, i)) {
        largest = is_zero(one, i) == is_zero(other, i) ? largest : 1.0;
        continue;
      }
      for (const double share : kContactDepthShares) {
        largest = std::max(largest, off(i, share));
      }
    }
  };
  each(a.moment_m2, b.moment_m2, [&](Eigen::Index i, double share) {
    return std::abs(pressure_at(b, i, share, 1.0).radius_m() /
                        pressure_at(a, i, share, 1.0).radius_m() -
                    1.0);
  });
  each(a.lateral, b.lateral, [&](Eigen::Index i, double share) {
    const Eigen::Matrix2d one = lateral_at(a, i, share);
    return (lateral_at(b, i, share) - one).norm() / one.norm();
  });
  return largest;
}

std::string describe(const ContactTable& table) {
  std::string text = table.has_pressure() ? "pressure under the contact" : "";
  if (!table.has_lateral()) {
    return text;
  }
  std::vector<double> ratio;
  std::vector<double> error;
  for (Eigen::Index i = 0; i < table.lateral.rows(); ++i) {
    if (!is_zero(table.lateral, i)) {
      ratio.push_back(0.5 * lateral_at(table, i, 1.0).trace());
      error.push_back(static_cast<double>(table.lateral_error(i, 0)));
    }
  }
  return text + (text.empty() ? "" : ", ") +
         (ratio.empty()
              ? std::string("lateral stiffness of no node")
              : fmt::format("lateral stiffness {:.2f} N/d (median), within {:.1f} %",
                            median(ratio), 100.0 * median(error)));
}

}  // namespace palpate
