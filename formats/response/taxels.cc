#include "formats/response/taxels.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/base/reproducible.h"
#include "formats/response/tangent_frame.h"
#include "formats/response/tool_support.h"

namespace palpate {
namespace {

constexpr double kPointsToRadius = 100.0;

void check_taxels(const ResponseTable& table, const Eigen::Vector3d& position_m,
                  const TaxelGrid& grid) {
  if (!(grid.rows >= 1 && grid.rows <= kMostTaxels && grid.columns >= 1 &&
        grid.columns <= kMostTaxels && grid.pitch_m > 0.0 &&
        std::isfinite(grid.pitch_m))) {
    throw InputError(fmt::format(
        "a grid of {} x {} taxels {} m apart; must have 1 to {} to a side, a positive "
        "distance apart",
        grid.columns, grid.rows, grid.pitch_m, kMostTaxels));
  }
  if (!table.contact.has_pressure()) {
    throw InputError(fmt::format(
        "tool {:?} has no pressures; build the database again with this version",
        table.tool.name));
  }
  if (!position_m.allFinite()) {
    throw InputError(
        fmt::format("the tool's position is ({}, {}, {}) m, must be finite",
                    position_m.x(), position_m.y(), position_m.z()));
  }
}

Eigen::Vector3d normal_at(const SurfaceMesh& mesh, const Points& normal,
                          const SurfacePoint& point) {
  Eigen::Vector3d outward = Eigen::Vector3d::Zero();
  for (Eigen::Index j = 0; j < 3; ++j) {
    outward += point.area_coordinate[j] *
               normal.row(mesh.triangle(point.triangle, j)).transpose();
  }
  return outward.normalized();
}

// One node's part of the pressure.
struct NodePressure {
  ContactPressure at;
  double error_relative = 0.0;
};

NodePressure node_pressure(const ResponseTable& table, const Eigen::Vector3d& outward,
                           std::int32_t node, double depth_m) {
  NodePressure pressure;
  const CurveView curve = table.curve(node);
  const double past_m = depth_m - table.touch_offset_m[static_cast<std::size_t>(node)];
  if (curve.depth_m.empty() || !(past_m > 0.0) ||
      !(table.contact.moment_m2(node, 0) > 0.0F)) {
    return pressure;
  }
  const double along = std::abs(table.direction.row(node).dot(outward.transpose()));
  const double d_m = along * past_m;
  pressure.at = pressure_at(table.contact, node, d_m / curve.depth_m.back(),
                            along * curve.at(d_m).force_n);
  pressure.error_relative = static_cast<double>(table.contact.pressure_error(node, 0));
  return pressure;
}

// Lays the ellipse out over the grid: by points of each taxel, also of those beside the
// grid, so that all of them make up the whole force.
void lay_out(const TaxelGrid& grid, Taxels& taxels) {
  const ContactPressure& whole = taxels.contact;
  const double radius_m = whole.radius_m();
  const double step_m =
      grid.pitch_m /
      std::clamp(std::ceil(kPointsToRadius * grid.pitch_m / radius_m), 4.0, 400.0);
  const Eigen::Matrix2d scaled = 2.0 * (whole.exponent + 2.0) * whole.moment_m2;
  const Eigen::Matrix2d inverse = scaled.inverse();
  const Eigen::Vector2d half_m = scaled.diagonal().cwiseSqrt();
  const auto first = [&](int axis) {
    return std::floor((whole.centre_m[axis] - half_m[axis]) / step_m);
  };
  const auto last = [&](int axis) {
    return std::ceil((whole.centre_m[axis] + half_m[axis]) / step_m);
  };
  const auto taxel_of = [&](double at_m, int count) {
    return std::floor(at_m / grid.pitch_m + 0.5 * count);
  };
  double sum = 0.0;
  double beside = 0.0;
  for (double j = first(1); j < last(1); ++j) {
    for (double i = first(0); i < last(0); ++i) {
      // The grid's edges lie between points, also of an odd number of taxels.
      const Eigen::Vector2d at_m((i + 0.5) * step_m, (j + 0.5) * step_m);
      const Eigen::Vector2d from_m = at_m - whole.centre_m;
      const double rho2 = from_m.dot(inverse * from_m);
      if (!(rho2 < 1.0)) {
        continue;
      }
      const double p = reproducible::pow(1.0 - rho2, whole.exponent);
      sum += p;
      const double column = taxel_of(at_m.x(), grid.columns);
      const double row = taxel_of(at_m.y(), grid.rows);
      if (column >= 0.0 && column < grid.columns && row >= 0.0 && row < grid.rows) {
        taxels.pressure_pa(static_cast<Eigen::Index>(row),
                           static_cast<Eigen::Index>(column)) += p;
      } else {
        beside += p;
      }
    }
  }
  taxels.pressure_pa *= whole.normal_n / (sum * grid.pitch_m * grid.pitch_m);
  taxels.beside_n = whole.normal_n * beside / sum;
}

}  // namespace

Eigen::Vector3d pressed_position_m(const SurfaceMesh& mesh, const Points& normal,
                                   const SurfaceSearch& search, const ToolShape& tool,
                                   const Eigen::Vector3d& at_m, double depth_m) {
  const SurfacePoint foot = search.nearest(at_m);
  return foot.position_m +
         (nominal_height_m(tool) - depth_m) * normal_at(mesh, normal, foot);
}

Taxels taxels_at(const SurfaceMesh& mesh, const Points& normal,
                 const SurfaceSearch& search, const ResponseTable& table,
                 const Eigen::Vector3d& position_m, const TaxelGrid& grid) {
  check_taxels(table, position_m, grid);
  Taxels taxels{.pressure_pa = Eigen::MatrixXd::Zero(grid.rows, grid.columns),
                .contact = {}};
  const SurfacePoint foot = search.nearest(position_m);
  if (foot.triangle < 0) {
    return taxels;
  }
  const auto nodes = mesh.triangle.row(foot.triangle);
  taxels.middle_m = foot.position_m;
  taxels.outward = normal_at(mesh, normal, foot);
  const double depth_m =
      nominal_height_m(table.tool) - taxels.outward.dot(position_m - foot.position_m);
  const auto frame = tangent_frame(taxels.outward);
  ContactPressure& whole = taxels.contact;
  whole.exponent = 0.0;
  for (Eigen::Index j = 0; j < 3; ++j) {
    const Eigen::Vector3d outward = normal.row(nodes[j]).transpose();
    const NodePressure node = node_pressure(table, outward, nodes[j], depth_m);
    const double part_n = foot.area_coordinate[j] * node.at.normal_n;
    const Eigen::Matrix2d turn = frame.transpose() * tangent_frame(outward);
    whole.normal_n += part_n;
    whole.centre_m += part_n * turn * node.at.centre_m;
    whole.moment_m2 += part_n * turn * node.at.moment_m2 * turn.transpose();
    whole.exponent += part_n * node.at.exponent;
    taxels.error_relative += part_n * node.error_relative;
  }
  if (!(whole.normal_n > 0.0)) {
    whole = {};
    return taxels;
  }
  whole.centre_m /= whole.normal_n;
  whole.moment_m2 /= whole.normal_n;
  whole.exponent /= whole.normal_n;
  taxels.error_relative /= whole.normal_n;
  lay_out(grid, taxels);
  return taxels;
}

}  // namespace palpate
