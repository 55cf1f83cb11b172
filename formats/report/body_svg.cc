#include "formats/report/body_svg.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "formats/report/colour_map.h"

namespace palpate {
namespace {

// Triangles are cut for smooth colours until there are about so many; a finer body is
// drawn as it is, 65 bytes a triangle.
constexpr double kMostPieces = 24000.0;

Eigen::Vector3d node_position(const SurfaceMesh& body, Eigen::Index t, int j) {
  return body.position_m.row(body.triangle(t, j)).transpose();
}

Eigen::Vector3d area_vector(const SurfaceMesh& body, Eigen::Index t) {
  const Eigen::Vector3d a = node_position(body, t, 0);
  return 0.5 * (node_position(body, t, 1) - a).cross(node_position(body, t, 2) - a);
}

Eigen::Matrix3d axes_from(double azimuth, double elevation) {
  const Eigen::Vector3d towards(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth),
                                std::sin(elevation));
  const Eigen::Vector3d right(-std::sin(azimuth), std::cos(azimuth), 0.0);
  Eigen::Matrix3d axes;
  axes << right.transpose(), towards.cross(right).transpose(), towards.transpose();
  return axes;
}

// Area with responses that the viewer sees, occlusion aside [m^2].
double area_shown(const SurfaceMesh& body, const SurfaceMap& map,
                  const Eigen::Vector3d& towards) {
  double area = 0.0;
  for (Eigen::Index t = 0; t < body.triangle.rows(); ++t) {
    int reached = 0;
    for (int j = 0; j < 3; ++j) {
      const auto node = static_cast<std::size_t>(body.triangle(t, j));
      reached += std::isnan(map.value[node]) ? 0 : 1;
    }
    area += std::max(0.0, area_vector(body, t).dot(towards)) * reached / 3.0;
  }
  return area;
}

// Weights (k + 1 points a side) of the small triangles that a triangle is cut into.
std::vector<Eigen::Matrix3d> cut(int k) {
  const auto point = [&](int i, int j) -> Eigen::RowVector3d {
    return Eigen::RowVector3d(k - i - j, i, j) / k;
  };
  std::vector<Eigen::Matrix3d> pieces;
  Eigen::Matrix3d piece;
  for (int i = 0; i < k; ++i) {
    for (int j = 0; i + j < k; ++j) {
      piece << point(i, j), point(i + 1, j), point(i, j + 1);
      pieces.push_back(piece);
      if (i + j + 1 < k) {
        piece << point(i + 1, j), point(i + 1, j + 1), point(i, j + 1);
        pieces.push_back(piece);
      }
    }
  }
  return pieces;
}

// The colour where the corners of a triangle have these weights.
Colour surface_colour(const SurfaceMap& map, const Eigen::RowVector3i& corner,
                      const Eigen::RowVector3d& weight) {
  const Colour no_response(0.80, 0.81, 0.83);
  double stiffness = 0.0;
  double reached = 0.0;
  for (int j = 0; j < 3; ++j) {
    const double value = map.value[static_cast<std::size_t>(corner[j])];
    if (!std::isnan(value)) {
      stiffness += weight[j] * value;
      reached += weight[j];
    }
  }
  return reached > 0.5 ? viridis(map.place(stiffness / reached)) : no_response;
}

// Light on a surface with this normal, given in the view's axes: a key light from the
// upper left, a weak one that follows the viewer, and a small highlight.
double light_on(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d key = Eigen::Vector3d(-0.45, 0.75, 0.60).normalized();
  const Eigen::Vector3d half = (key + Eigen::Vector3d::UnitZ()).normalized();
  const double diffuse = std::max(0.0, 0.15 + 0.85 * normal.dot(key));
  const double head = std::max(0.0, normal.z());
  const double highlight = std::pow(std::max(0.0, normal.dot(half)), 40.0);
  return std::min(1.0, 0.62 + 0.34 * diffuse + 0.10 * head) + 0.14 * highlight;
}

void append_piece(std::string& svg, const Eigen::Matrix<double, 3, 2>& p,
                  const std::string& colour) {
  svg += fmt::format(
      "<path color=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}z\"/>\n",
      colour, p(0, 0), p(0, 1), p(1, 0), p(1, 1), p(2, 0), p(2, 1));
}

std::vector<Eigen::Index> farthest_first(const SurfaceMesh& body, const View& view) {
  const Eigen::RowVector3d towards = view.axes.row(2);
  std::vector<Eigen::Index> order;
  std::vector<double> depth(static_cast<std::size_t>(body.triangle.rows()));
  for (Eigen::Index t = 0; t < body.triangle.rows(); ++t) {
    if (towards.dot(area_vector(body, t)) > 0.0) {
      order.push_back(t);
      for (int j = 0; j < 3; ++j) {
        depth[static_cast<std::size_t>(t)] += towards.dot(node_position(body, t, j));
      }
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return depth[static_cast<std::size_t>(a)] < depth[static_cast<std::size_t>(b)];
  });
  return order;
}

}  // namespace

View choose_view(const SurfaceMesh& body, const SurfaceMap& map, const Panel& panel) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  View view;
  double most = -1.0;
  for (int azimuth = -60; azimuth < 300; azimuth += 30) {
    const Eigen::Matrix3d axes = axes_from(azimuth * kDegree, 38.0 * kDegree);
    const double area = area_shown(body, map, axes.row(2).transpose());
    // A later view must show clearly more: no flutter between almost equal ones.
    if (area > 1.02 * most) {
      most = area;
      view.axes = axes;
    }
  }
  const Points seen = body.position_m * view.axes.transpose();
  const Eigen::RowVector3d low = seen.colwise().minCoeff();
  const Eigen::RowVector3d high = seen.colwise().maxCoeff();
  const Eigen::RowVector3d size = (high - low).cwiseMax(1e-9);
  view.px_per_m = std::min(panel.width / size.x(), panel.height / size.y());
  view.origin_x =
      panel.x + panel.width / 2.0 - view.px_per_m * (low.x() + high.x()) / 2.0;
  view.origin_y =
      panel.y + panel.height / 2.0 + view.px_per_m * (low.y() + high.y()) / 2.0;
  return view;
}

std::string draw_body(const SurfaceMesh& body, const Points& normal,
                      const SurfaceMap& map, const View& view) {
  const std::vector<Eigen::Index> order = farthest_first(body, view);
  const double room =
      kMostPieces / std::max<double>(1.0, static_cast<double>(order.size()));
  const std::vector<Eigen::Matrix3d> pieces =
      cut(std::clamp(static_cast<int>(std::sqrt(room)), 1, 8));
  // A thin line of the fill's colour closes the seams between neighbours.
  std::string svg =
      "<g fill=\"currentColor\" stroke=\"currentColor\" stroke-width=\"0.7\" "
      "stroke-linejoin=\"round\">\n";
  for (const Eigen::Index t : order) {
    const Eigen::RowVector3i corner = body.triangle.row(t);
    Eigen::Matrix3d corner_normal;
    Eigen::Matrix<double, 3, 2> at;
    for (int j = 0; j < 3; ++j) {
      corner_normal.row(j) = normal.row(corner[j]) * view.axes.transpose();
      at.row(j) = view.at(node_position(body, t, j)).transpose();
    }
    for (const Eigen::Matrix3d& piece : pieces) {
      const Eigen::RowVector3d middle = piece.colwise().mean();
      const Eigen::Vector3d n = (middle * corner_normal).transpose().normalized();
      append_piece(svg, piece * at,
                   hex(lit(surface_colour(map, corner, middle), light_on(n))));
    }
  }
  return svg + "</g>\n";
}

bool faces_viewer(const View& view, const Eigen::Vector3d& normal) {
  return view.axes.row(2).dot(normal.transpose()) > 0.2;
}

std::string draw_marks(const SurfaceMesh& body, const Points& normal,
                       const std::vector<std::int64_t>& nodes, const View& view) {
  std::string svg;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!faces_viewer(view, normal.row(nodes[i]).transpose())) {
      continue;
    }
    const Eigen::Vector2d p = view.at(body.position_m.row(nodes[i]).transpose());
    svg += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"8.5\" fill=\"#ffffff\" "
        "stroke=\"#1d2430\" stroke-width=\"1.4\"/>"
        "<text x=\"{0:.1f}\" y=\"{2:.1f}\" text-anchor=\"middle\" font-size=\"11.5\" "
        "font-weight=\"600\">{3}</text>\n",
        p.x(), p.y(), p.y() + 4.1, i + 1);
  }
  return svg;
}

}  // namespace palpate
