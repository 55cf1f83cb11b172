#include "precompute/press/contact_coupling.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Cholesky>

#include "formats/base/reproducible.h"
#include "formats/response/memory_sites.h"
#include "precompute/contact/loaded_part.h"
#include "precompute/press/contact_spot.h"
#include "precompute/press/coupling_modes.h"
#include "precompute/press/scene_solver.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

// First distance in contact radii of a press to half of the largest depth.
constexpr double kFirstInRadii = 1.5;
// Columns of which the modes are found: the matrix is dense.
constexpr Eigen::Index kMostForModes = 8000;
constexpr double kNodesWithin = 2.5;  // contact nodes within the first distance

bool tool_couples(const Scene& scene, std::size_t tool) {
  return tool < scene.tool_couples.size() && scene.tool_couples[tool];
}

double typical_radius_m(const Scene& scene, std::size_t tool) {
  return contact_radius_m(scene.tool[tool], 0.5 * scene.reach.depth_max_m);
}

// Of those that couple, the one with the smallest contact.
std::size_t smallest_tool(const Scene& scene) {
  std::size_t smallest = scene.tool.size();
  for (std::size_t t = 0; t < scene.tool.size(); ++t) {
    if (tool_couples(scene, t) &&
        (smallest == scene.tool.size() ||
         typical_radius_m(scene, t) < typical_radius_m(scene, smallest))) {
      smallest = t;
    }
  }
  return smallest;
}

// Of the vertices, and of those in triangles with them.
std::vector<std::int32_t> with_rim(const BodySource& body,
                                   std::span<const std::int32_t> vertices) {
  std::vector<char> is_inner(static_cast<std::size_t>(body.surface.position_m.rows()));
  for (const std::int32_t v : vertices) {
    is_inner[static_cast<std::size_t>(v)] = 1;
  }
  std::vector<std::int32_t> all(vertices.begin(), vertices.end());
  for (const auto& corner : body.surface.triangle.rowwise()) {
    if (std::any_of(corner.begin(), corner.end(), [&](std::int32_t v) {
          return is_inner[static_cast<std::size_t>(v)] != 0;
        })) {
      all.insert(all.end(), corner.begin(), corner.end());
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

// Contact nodes that move and lie nearer to one of the vertices than to any other.
std::vector<std::int32_t> nodes_around(const BodyModel& model, const BodySource& body,
                                       std::span<const std::int32_t> vertices) {
  std::vector<char> counts(model.contact.node.size(), 0);
  in_parallel(counts.size(), [&](std::size_t c) {
    const ContactNode& node = model.contact.node[c];
    Eigen::Index nearest = 0;
    (body.surface.position_m.rowwise() - node.position_m.transpose())
        .rowwise()
        .squaredNorm()
        .minCoeff(&nearest);
    counts[c] =
        model.supports.free_index[3 * static_cast<std::size_t>(node.mesh_node)] >= 0 &&
        std::binary_search(vertices.begin(), vertices.end(), nearest);
  });
  std::vector<std::int32_t> around;
  for (std::size_t c = 0; c < counts.size(); ++c) {
    if (counts[c] != 0) {
      around.push_back(static_cast<std::int32_t>(c));
    }
  }
  return around;
}

// One row, and how much surface is in each bin [m^2].
struct BinnedColumn {
  Eigen::VectorXd sum;   // (K) [m^4/N]
  Eigen::VectorXd area;  // (K) [m^2]
};

BinnedColumn binned(const ContactSurface& surface, std::span<const std::int32_t> rows,
                    const Eigen::VectorXd& u_m, const Eigen::Vector3d& at_m,
                    const ComplianceKnots& knots) {
  const auto count = static_cast<Eigen::Index>(knots.count);
  BinnedColumn bins{Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)};
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const ContactNode& node = surface.node[static_cast<std::size_t>(rows[j])];
    const double r = (node.position_m - at_m).norm();
    // Hats over ln r: r u is averaged over the surface around each knot. On a half
    // space r u is constant away from the load.
    const double step = reproducible::log(r / knots.first_m) / knots.log_step;
    const auto below = static_cast<Eigen::Index>(std::floor(std::max(step, -1.0)));
    for (Eigen::Index k = below; k <= below + 1; ++k) {
      const double hat = 1.0 - std::abs(step - static_cast<double>(k));
      if (k >= 0 && k < count && hat > 0.0) {
        bins.sum[k] += hat * node.area_m2 * r * u_m[static_cast<Eigen::Index>(j)];
        bins.area[k] += hat * node.area_m2;
      }
    }
  }
  return bins;
}

// Where the smallest of the tools presses at vertices.
std::vector<PressureForces> spots_at(const Scene& scene, const BodySource& body,
                                     const BodyModel& model,
                                     std::span<const std::int32_t> vertices,
                                     Progress& progress) {
  const SharedTool& tool = body.tool[smallest_tool(scene)];
  std::vector<PressedNode> placed(vertices.size());
  in_parallel(vertices.size(), [&](std::size_t i) {
    placed[i] = placed_node(scene, body, model, tool, vertices[i]);
  });
  const SurfaceCompliance compliance =
      compliance_of(model, placed, {}, [&](std::size_t done, std::size_t total) {
        progress.advance(done, total, "columns");
      });
  std::vector<PressureForces> spot(vertices.size());
  in_parallel(vertices.size(), [&](std::size_t i) {
    spot[i] = contact_spot(model, compliance, placed[i]);
  });
  return spot;
}

// What spots' forces work at displacements of their nodes, one spot after another.
Eigen::VectorXd work_of(std::span<const PressureForces> spot,
                        const Eigen::Ref<const Eigen::VectorXd>& u_m) {
  Eigen::VectorXd work(std::ssize(spot));
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < work.size(); ++i) {
    const auto& force_n = spot[static_cast<std::size_t>(i)].force_n;
    const Eigen::Map<const Eigen::VectorXd> forces(force_n.data(), std::ssize(force_n));
    work[i] = forces.dot(u_m.segment(row, forces.size()));
    row += forces.size();
  }
  return work;
}

// Rows from bins; what has too little surface takes the mean of all, and where no node
// has any, what is nearer.
RowsOf<float> rows_of(const std::vector<BinnedColumn>& bins, double least_m2) {
  const auto knots = bins.front().sum.size();
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(knots);
  for (Eigen::Index k = 0; k < knots; ++k) {
    // Mean over all columns, weighted by surface.
    double area = 0.0;
    for (const BinnedColumn& column : bins) {
      mean[k] += column.sum[k];
      area += column.area[k];
    }
    mean[k] = area > 0.0 ? mean[k] / area : k > 0 ? mean[k - 1] : 0.0;
  }
  RowsOf<float> rows(std::ssize(bins), knots);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const BinnedColumn& column = bins[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k < knots; ++k) {
      rows(i, k) = static_cast<float>(
          column.area[k] > least_m2 ? column.sum[k] / column.area[k] : mean[k]);
    }
  }
  return rows;
}

}  // namespace

bool couples(const Scene& scene) {
  return std::find(scene.tool_couples.begin(), scene.tool_couples.end(), true) !=
         scene.tool_couples.end();
}

std::vector<double> coupling_distances(const Scene& scene, const BodySource& body,
                                       std::span<const std::int32_t> vertices) {
  const double first_m = kFirstInRadii * typical_radius_m(scene, smallest_tool(scene));
  Eigen::AlignedBox3d box;
  for (const std::int32_t v : vertices) {
    box.extend(Eigen::Vector3d(body.surface.position_m.row(v).transpose()));
  }
  // A body that is smaller than that has contacts at the first distances alone.
  constexpr double kLeastRatio = 4.0;
  const double last_m = std::max(box.diagonal().norm(), kLeastRatio * first_m);
  return log_spaced(first_m, last_m, kCouplingKnots);
}

UniformSurface coupling_surface(const BodySource& body, double first_m) {
  return uniform_surface(body, first_m / kNodesWithin);
}

BodyModel coupling_model(const Scene& scene, const BodySource& body, double first_m) {
  require_whole_body(scene, "coupling of contacts");
  const UniformSurface uniform = coupling_surface(body, first_m);
  BodyModel model = make_body_model(scene, body, uniform.surface);
  model.contact_spacing_m = uniform.node_spacing_m;
  return model;
}

ComplianceTable coupling_table(const Scene& scene, const BodySource& body,
                               const BodyModel& model,
                               std::span<const std::int32_t> vertices,
                               const std::vector<double>& distance_m,
                               Progress& progress) {
  ComplianceTable table;
  table.distance_m = distance_m;
  const ComplianceKnots knots = knots_of(table);
  const std::vector<std::int32_t> rows = nodes_around(model, body, vertices);
  const std::vector<std::int32_t> wanted = with_rim(body, vertices);
  const std::vector<PressureForces> spot =
      spots_at(scene, body, model, wanted, progress);
  // Rows at which columns are averaged, then the spots' own, one after another.
  std::vector<std::int32_t> all = rows;
  for (const PressureForces& forces : spot) {
    all.insert(all.end(), forces.node.begin(), forces.node.end());
  }
  const auto averaged = std::ssize(rows);
  const auto n = std::ssize(spot);
  const bool with_modes = n <= kMostForModes;
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(with_modes ? n : 0, with_modes ? n : 0);
  std::vector<BinnedColumn> bins(spot.size());
  for_each_column(
      *model.factor, model.supports, model.contact, all, spot,
      [&](std::size_t k, const Eigen::VectorXd& u_m) {
        // Column k: displacements under the unit pressure of spot k.
        bins[k] = binned(model.contact, rows, u_m.head(averaged),
                         body.surface.position_m.row(wanted[k]).transpose(), knots);
        if (with_modes) {
          C.col(static_cast<Eigen::Index>(k)) =
              work_of(spot, u_m.tail(u_m.size() - averaged));
        }
      },
      [&](std::size_t done) {
        progress.advance(done, spot.size(), "columns");
      });
  double area_m2 = 0.0;
  for (const std::int32_t c : rows) {
    area_m2 += model.contact.node[static_cast<std::size_t>(c)].area_m2;
  }
  const RowsOf<float> found =
      rows_of(bins, 0.5 * area_m2 / static_cast<double>(rows.size()));
  table.value.setZero(body.surface.position_m.rows(),
                      static_cast<Eigen::Index>(knots.count));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto node = static_cast<std::size_t>(corner_of(model, wanted[i]));
    if (model.supports.free_index[3 * node] >= 0) {
      table.value.row(wanted[i]) = found.row(static_cast<Eigen::Index>(i));
    }
  }
  if (with_modes) {
    add_modes(C, wanted, body.surface.position_m, table);
  }
  return table;
}

ComplianceTable make_coupling_table(const Scene& scene, const BodySource& body,
                                    std::span<const std::int32_t> vertices,
                                    Progress& progress) {
  const std::vector<double> distance_m = coupling_distances(scene, body, vertices);
  const BodyModel model = coupling_model(scene, body, distance_m.front());
  return coupling_table(scene, body, model, vertices, distance_m, progress);
}

std::vector<std::int32_t> set_of_contacts(std::span<const std::int32_t> nodes,
                                          const Points& position_m,
                                          const ApartBetween& apart, std::size_t count,
                                          std::mt19937_64& random) {
  constexpr int kTries = 400;
  std::vector<std::int32_t> set{nodes[random() % nodes.size()]};
  for (int i = 0; i < kTries && set.size() < count; ++i) {
    const std::int32_t next = nodes[random() % nodes.size()];
    const auto apart_m = [&](std::int32_t other) {
      return (position_m.row(next) - position_m.row(other)).norm();
    };
    if (apart_m(set.front()) <= apart.farthest_m &&
        std::all_of(set.begin(), set.end(), [&](std::int32_t other) {
          return apart_m(other) >= apart.closest_m;
        })) {
      set.push_back(next);
    }
  }
  return set;
}

bool one_equilibrium(const ComplianceTable& coupling, const ResponseTable& responses,
                     const Points& position_m, double closest_m) {
  constexpr int kSets = 300;
  constexpr double kTogether = 4.0;  // of the closest distance
  std::vector<std::int32_t> nodes;
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(responses.nodes()); ++v) {
    if (responses.stiffness_max_n_per_m[static_cast<std::size_t>(v)] > 0.0) {
      nodes.push_back(v);
    }
  }
  if (nodes.empty()) {
    return false;
  }
  const ComplianceKnots knots = knots_of(coupling);
  std::mt19937_64 random(1);
  for (int i = 0; i < 3 * kSets; ++i) {
    const std::size_t count = i % 3 == 0 ? 2 : i % 3 == 1 ? 4 : 9;
    const auto set = set_of_contacts(nodes, position_m,
                                     {closest_m, kTogether * closest_m}, count, random);
    Eigen::MatrixXd A(std::ssize(set), std::ssize(set));
    for (Eigen::Index a = 0; a < A.rows(); ++a) {
      const std::int32_t v = set[static_cast<std::size_t>(a)];
      // A = C + diag(1 / k_max): the contacts have one equilibrium where A is positive
      // definite.
      A(a, a) = 1.0 / responses.stiffness_max_n_per_m[static_cast<std::size_t>(v)];
      for (Eigen::Index b = 0; b < a; ++b) {
        const std::int32_t w = set[static_cast<std::size_t>(b)];
        A(a, b) = node_coupling_m_per_n(coupling, knots, v, w,
                                        (position_m.row(v) - position_m.row(w)).norm());
      }
    }
    if (Eigen::LLT<Eigen::MatrixXd>(A).info() != Eigen::Success) {
      return false;
    }
  }
  return true;
}

}  // namespace palpate
