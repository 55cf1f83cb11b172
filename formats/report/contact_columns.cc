#include "formats/report/contact_columns.h"

#include <cmath>

#include <fmt/format.h>

namespace palpate {

double contact_radius_m(const ResponseTable& table, std::int64_t node,
                        std::size_t sample) {
  const CurveView curve = table.curve(node);
  const double share = curve.depth_m[sample] / curve.depth_m.back();
  const double radius_m = pressure_at(table.contact, node, share, 1.0).radius_m();
  return std::isfinite(radius_m) ? radius_m : 0.0;
}

std::array<double, 3> lateral_n_per_m(const ResponseTable& table, std::int64_t node,
                                      std::size_t sample) {
  const CurveView curve = table.curve(node);
  const double d_m = curve.depth_m[sample];
  const Eigen::Matrix2d K =
      (d_m > 0.0 ? curve.force_n[sample] / d_m : curve.stiffness_n_per_m[sample]) *
      lateral_at(table.contact, node, d_m / curve.depth_m.back());
  return {K(0, 0), K(0, 1), K(1, 1)};
}

std::string contact_columns(const ContactTable& contact) {
  return fmt::format("{}{}", contact.has_pressure() ? ",contact_radius_m" : "",
                     contact.has_lateral() ? ",lateral_xx_n_per_m,lateral_xy_n_per_m,"
                                             "lateral_yy_n_per_m"
                                           : "");
}

std::string contact_values(const ResponseTable& table, std::int64_t node,
                           std::size_t sample) {
  std::string text;
  if (table.contact.has_pressure()) {
    text = fmt::format(",{}", contact_radius_m(table, node, sample));
  }
  if (table.contact.has_lateral()) {
    for (const double part : lateral_n_per_m(table, node, sample)) {
      text += fmt::format(",{}", part);
    }
  }
  return text;
}

}  // namespace palpate
