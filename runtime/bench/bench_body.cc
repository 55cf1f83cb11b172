#include "runtime/bench/bench_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include <Eigen/Geometry>

#include "formats/response/tilt_line.h"
#include "runtime/element/triangle.h"
#include "runtime/slow/thinned_curve.h"

namespace palpate {
namespace {

std::array<double, 3> to_array(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

class NodeMaker {
 public:
  explicit NodeMaker(const BenchBodyOptions& options)
      : o_(options), random_(options.seed) {}

  ElementNode make(int row, int column) {
    ElementNode node;
    node.node = row * (o_.cells + 1) + column;
    const double x = column * o_.cell_m;
    const double y = row * o_.cell_m;
    const double q = 2.0 * std::numbers::pi / o_.wavelength_m;
    const double wave = o_.wave_m / 4.0;
    node.position_m = {x, y, wave * (std::sin(q * x) + std::sin(q * y))};
    const Eigen::Vector3d n =
        Eigen::Vector3d(-wave * q * std::cos(q * x), -wave * q * std::cos(q * y), 1.0)
            .normalized();
    node.normal = to_array(n);
    const Eigen::Vector3d u = leaning(n);
    node.direction = to_array(u);
    const Eigen::Vector3d turning = turning_per_m(n);
    node.tilt = to_array(tilt_line(u, n).tilt - o_.touch_height_m * turning);
    node.tilt_by_height_per_m = to_array(turning);
    node.touch_offset_m = o_.touch_offset_m * (2.0 * unit() - 1.0);
    node.friction = o_.friction_min + (o_.friction_max - o_.friction_min) * unit();
    node.presliding_m = o_.presliding_m;
    set_power_law(node, o_.exponent, o_.force_n * std::pow(o_.contrast, unit() - 0.5),
                  o_.depth_m, o_.samples);
    if (o_.lateral > 0.0) {
      for (std::size_t k = 0; k < kContactDepths; ++k) {
        set_lateral(node, k);
      }
    }
    return node;
  }

 private:
  double unit() { return std::generate_canonical<double, 53>(random_); }

  // A tensor of any axes.
  void set_lateral(ElementNode& node, std::size_t depth) {
    const double one = o_.lateral * (0.1 + 0.9 * unit());
    const double other = o_.lateral * (0.1 + 0.9 * unit());
    const double about = std::numbers::pi * unit();
    const double c = std::cos(about), s = std::sin(about);
    node.lateral[3 * depth] = one * c * c + other * s * s;
    node.lateral[3 * depth + 1] = (one - other) * c * s;
    node.lateral[3 * depth + 2] = one * s * s + other * c * c;
  }

  Eigen::Vector3d leaning(const Eigen::Vector3d& n) {
    const double angle = o_.tilt_rad * unit();
    const double about = 2.0 * std::numbers::pi * unit();
    const Eigen::Vector3d side = n.unitOrthogonal();
    const Eigen::Vector3d t = std::cos(about) * side + std::sin(about) * n.cross(side);
    return std::cos(angle) * n + std::sin(angle) * t;
  }

  Eigen::Vector3d turning_per_m(const Eigen::Vector3d& n) {
    if (o_.tilt_by_height_per_m == 0.0) {
      return Eigen::Vector3d::Zero();
    }
    const double about = 2.0 * std::numbers::pi * unit();
    const Eigen::Vector3d side = n.unitOrthogonal();
    return o_.tilt_by_height_per_m * unit() *
           (std::cos(about) * side + std::sin(about) * n.cross(side));
  }

  BenchBodyOptions o_;
  std::mt19937_64 random_;
};

// Memory at the nodes of a coarser grid, blended over its squares.
NodeMemory node_memory(const BenchBodyOptions& o, int row, int column) {
  NodeMemory memory;
  std::copy(o.relaxing.begin(), o.relaxing.end(), memory.relaxing.begin());
  const int side = o.cells / o.cells_per_site + 2;
  const auto split = [&](int index) {
    const double at = static_cast<double>(index) / o.cells_per_site;
    return std::pair(static_cast<int>(at), at - std::floor(at));
  };
  const auto [r, y] = split(row);
  const auto [c, x] = split(column);
  const std::array<double, 4> weight{(1 - x) * (1 - y), x * (1 - y), (1 - x) * y,
                                     x * y};
  for (std::size_t i = 0; i < 4; ++i) {
    if (weight[i] > 0.0) {
      memory.site[i] =
          (r + static_cast<int>(i / 2)) * side + c + static_cast<int>(i % 2);
      memory.weight[i] = weight[i];
    }
  }
  // Cuts of a convex power law lie closer where it bends more.
  for (int b = 1; b < o.bundles; ++b) {
    memory.cut_m[static_cast<std::size_t>(b - 1)] =
        o.depth_m * std::pow(static_cast<double>(b) / o.bundles, 1.5);
  }
  return memory;
}

void set_memory(BenchBody& body) {
  const BenchBodyOptions& o = body.options;
  for (Element& element : body.element) {
    element.memory.terms = static_cast<std::int32_t>(o.relaxing.size());
    element.memory.bundles = o.bundles;
    std::copy(o.relaxation_s.begin(), o.relaxation_s.end(),
              element.memory.relaxation_s.begin());
    for (std::size_t j = 0; j < 3; ++j) {
      const int node = element.node[j].node;
      element.memory.node[j] =
          node_memory(o, node / (o.cells + 1), node % (o.cells + 1));
    }
  }
}

Eigen::Matrix3d corners(const Element& element) {
  Eigen::Matrix3d v;
  for (int j = 0; j < 3; ++j) {
    v.col(j) = Eigen::Map<const Eigen::Vector3d>(
        element.node[static_cast<std::size_t>(j)].position_m.data());
  }
  return v;
}

}  // namespace

void set_yielding(BenchBody& body, const std::vector<NodeYielding>& by_node) {
  for (Element& element : body.element) {
    element.memory.yields = true;
    for (std::size_t j = 0; j < 3; ++j) {
      ElementNode& node = element.node[j];
      const NodeYielding& yielding = by_node[static_cast<std::size_t>(node.node)];
      NodeMemory& memory = element.memory.node[j];
      memory.yield_depth_m = yielding.yield_depth_m;
      memory.dent_share = yielding.share;
      memory.onset_m = yielding.onset_m;
      memory.soft_scale_m = yielding.scale_m;
      memory.soft_most = yielding.largest;
      if (yielding.largest > 0.0) {
        (void)set_curve(node, undamaged_curve(node.curve(), yielding).view());
      }
    }
  }
}

void set_power_law(ElementNode& node, double exponent, double force_n, double depth_m,
                   int samples) {
  const double a = force_n / std::pow(depth_m, exponent);
  node.samples = samples;
  for (std::size_t i = 0; i < static_cast<std::size_t>(samples); ++i) {
    const double d = depth_m * static_cast<double>(i) / (samples - 1);
    node.depth_m[i] = d;
    node.force_n[i] = a * std::pow(d, exponent);
    node.stiffness_n_per_m[i] = a * exponent * std::pow(d, exponent - 1.0);
    if (i > 0) {
      const double h = d - node.depth_m[i - 1];
      node.energy_j[i] =
          node.energy_j[i - 1] + h * (node.force_n[i - 1] + node.force_n[i]) / 2.0 +
          h * h * (node.stiffness_n_per_m[i - 1] - node.stiffness_n_per_m[i]) / 12.0;
    }
  }
}

std::int32_t BenchBody::triangle_at(const Eigen::Vector3d& p_m) const {
  const auto cell = [&](double coordinate) {
    const double scaled = std::floor(coordinate / options.cell_m);
    return static_cast<int>(std::clamp(scaled, 0.0, options.cells - 1.0));
  };
  const int column = cell(p_m.x());
  const int row = cell(p_m.y());
  const bool upper = p_m.y() - row * options.cell_m > p_m.x() - column * options.cell_m;
  return 2 * (row * options.cells + column) + (upper ? 1 : 0);
}

double BenchBody::height_m(const Eigen::Vector3d& p_m) const {
  Eigen::Matrix3d v = corners(element[static_cast<std::size_t>(triangle_at(p_m))]);
  const Eigen::RowVector3d z = v.row(2);
  v.row(2).setZero();
  return z.dot(triangle::area_coordinates(v, p_m).transpose());
}

std::vector<Element> BenchBody::around(const Eigen::Vector3d& p_m) const {
  const std::int32_t active = triangle_at(p_m);
  const int row = active / 2 / options.cells;
  const int column = active / 2 % options.cells;
  const Element& middle = element[static_cast<std::size_t>(active)];
  const auto touches = [&](const Element& other) {
    return std::ranges::any_of(other.node, [&](const ElementNode& a) {
      return std::ranges::any_of(middle.node, [&](const ElementNode& b) {
        return a.node == b.node;
      });
    });
  };
  std::vector<Element> messages{middle};
  messages.front().active = true;
  // Triangles that share a vertex lie in the nine squares about the active one's.
  for (int r = std::max(0, row - 1); r <= std::min(options.cells - 1, row + 1); ++r) {
    for (int c = std::max(0, column - 1); c <= std::min(options.cells - 1, column + 1);
         ++c) {
      for (const int half : {0, 1}) {
        const int triangle = 2 * (r * options.cells + c) + half;
        const Element& other = element[static_cast<std::size_t>(triangle)];
        if (triangle != active && touches(other)) {
          messages.push_back(other);
        }
      }
    }
  }
  return messages;
}

BenchBody make_bench_body(const BenchBodyOptions& options) {
  BenchBody body{options, {}};
  const int n = options.cells;
  NodeMaker maker(options);
  std::vector<ElementNode> node;
  for (int row = 0; row <= n; ++row) {
    for (int column = 0; column <= n; ++column) {
      node.push_back(maker.make(row, column));
    }
  }
  const auto at = [&](int row, int column) {
    const int index = row * (n + 1) + column;
    return node[static_cast<std::size_t>(index)];
  };
  const auto triangle = [n](int row, int column, int half) {
    const bool inside = row >= 0 && row < n && column >= 0 && column < n;
    return inside ? 2 * (row * n + column) + half : -1;
  };
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      Element lower;  // corners (0,0) (1,0) (1,1); its diagonal is edge 2
      lower.triangle = triangle(row, column, 0);
      lower.touch_height_m = options.touch_height_m;
      lower.node = {at(row, column), at(row, column + 1), at(row + 1, column + 1)};
      lower.neighbour = {triangle(row - 1, column, 1), triangle(row, column + 1, 1),
                         triangle(row, column, 1)};
      Element upper;  // corners (0,0) (1,1) (0,1); its diagonal is edge 0
      upper.triangle = triangle(row, column, 1);
      upper.touch_height_m = options.touch_height_m;
      upper.node = {at(row, column), at(row + 1, column + 1), at(row + 1, column)};
      upper.neighbour = {triangle(row, column, 0), triangle(row + 1, column, 0),
                         triangle(row, column - 1, 0)};
      body.element.push_back(lower);
      body.element.push_back(upper);
    }
  }
  set_memory(body);
  if (options.yielding) {
    set_yielding(body, std::vector<NodeYielding>(node.size(), *options.yielding));
  }
  return body;
}

std::vector<Eigen::Vector3d> make_bench_walk(const BenchBody& body,
                                             const BenchWalkOptions& o) {
  std::mt19937_64 random(o.seed);
  std::normal_distribution<double> normal;
  const double side = body.side_m();
  const Eigen::Vector3d low(0.2 * side, 0.2 * side, o.tool_radius_m - o.depth_m);
  const Eigen::Vector3d high(0.8 * side, 0.8 * side, o.tool_radius_m + o.lift_m);
  // v' = -v / memory_s + white noise. With the noise speed sqrt(2 decay) per tick v
  // keeps the standard deviation `speed`, to first order in decay = tick / memory.
  const double decay = o.tick_s / o.memory_s;
  const double noise = o.speed_m_per_s * std::sqrt(2.0 * decay);
  Eigen::Vector3d x = 0.5 * (low + high);
  x.z() = high.z();
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> walk;
  walk.reserve(static_cast<std::size_t>(o.ticks));
  for (int tick = 0; tick < o.ticks; ++tick) {
    walk.push_back(x);
    for (int i = 0; i < 3; ++i) {
      v(i) += -decay * v(i) + noise * normal(random);
      x(i) += o.tick_s * v(i);
      // Reflected at the box.
      if (x(i) < low(i) || x(i) > high(i)) {
        x(i) = std::clamp(x(i), low(i), high(i));
        v(i) = -v(i);
      }
    }
  }
  return walk;
}

}  // namespace palpate
