#include "precompute/press/surface_displacement.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace palpate {
namespace {

constexpr Eigen::Index kBlock = 64;  // columns per solve

// On the free degrees of freedom, at the node's last sample.
void add_load(const BodyModel& model, const PressedNode& node,
              Eigen::Ref<Eigen::VectorXd> b) {
  const Eigen::VectorXd load_n = pressure_load_n(
      model.contact, node.patch, node.indentation.sample.back().pressure_n);
  for (Eigen::Index i = 0; i < load_n.size(); ++i) {
    const std::int64_t dof = model.supports.free_index[static_cast<std::size_t>(i)];
    if (dof >= 0) {
      b[dof] += load_n[i];
    }
  }
}

// (k) largest displacement of a vertex in each field.
Eigen::VectorXd largest_m(const Eigen::MatrixXd& field_m) {
  Eigen::VectorXd largest(field_m.cols());
  for (Eigen::Index k = 0; k < field_m.cols(); ++k) {
    const Eigen::VectorXd column = field_m.col(k);
    largest[k] = Eigen::Map<const Eigen::Matrix3Xd>(column.data(), 3, column.size() / 3)
                     .colwise()
                     .norm()
                     .maxCoeff();
  }
  return largest;
}

// Orthonormal modes of fields whose largest displacement is 1. One field more than
// needed never helps: k modes reproduce k fields.
Eigen::MatrixXd modes_of(const Eigen::MatrixXd& unit, double error_relative) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gram(unit.transpose() * unit);
  Eigen::MatrixXd basis(unit.rows(), unit.cols());
  Eigen::MatrixXd rest = unit;
  Eigen::Index modes = 0;
  while (modes < unit.cols() && largest_m(rest).maxCoeff() > error_relative) {
    // Ascending eigenvalues: the largest is last.
    Eigen::VectorXd mode = rest * gram.eigenvectors().col(unit.cols() - 1 - modes);
    const double norm = mode.norm();
    if (!(norm > 0.0)) {
      break;
    }
    mode /= norm;
    rest -= mode * (mode.transpose() * rest).eval();
    basis.col(modes++) = mode;
  }
  return basis.leftCols(modes);
}

}  // namespace

Eigen::MatrixXd surface_displacements_m(const BodyModel& model, Eigen::Index vertices,
                                        std::span<const PressedNode> nodes) {
  const auto columns = static_cast<Eigen::Index>(nodes.size());
  Eigen::MatrixXd field = Eigen::MatrixXd::Zero(3 * vertices, columns);
  for (Eigen::Index first = 0; first < columns; first += kBlock) {
    const Eigen::Index count = std::min(kBlock, columns - first);
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(model.factor->size(), count);
    for (Eigen::Index k = 0; k < count; ++k) {
      add_load(model, nodes[static_cast<std::size_t>(first + k)], B.col(k));
    }
    const Eigen::MatrixXd X = model.factor->solve(B);
    for (Eigen::Index i = 0; i < 3 * vertices; ++i) {
      const std::int64_t dof = model.supports.free_index[static_cast<std::size_t>(i)];
      if (dof >= 0) {
        field.row(i).segment(first, count) = X.row(dof);
      }
    }
  }
  return field;
}

DisplacementField compress_fields(const Eigen::MatrixXd& field_m,
                                  std::span<const PressedNode> nodes,
                                  double error_relative) {
  DisplacementField field;
  if (nodes.empty()) {
    return field;
  }
  const Eigen::VectorXd scale_m = largest_m(field_m);
  const Eigen::MatrixXd unit = field_m * scale_m.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd basis = modes_of(unit, error_relative);
  field.basis = basis.cast<float>();
  field.coefficient = (field_m.transpose() * basis).cast<float>();
  const Eigen::MatrixXd missed =
      field_m -
      field.basis.cast<double>() * field.coefficient.cast<double>().transpose();
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    field.node.push_back(nodes[j].vertex);
    field.depth_m.push_back(nodes[j].indentation.sample.back().penetration_m);
    field.error_relative.push_back(missed.col(k).norm() / field_m.col(k).norm());
  }
  return field;
}

void add_surface_fields(const Scene& scene, const BodySource& body,
                        const PressStrategy& strategy,
                        std::span<const std::int32_t> reachable,
                        ResponseDatabase& database, Progress& progress) {
  std::vector<std::vector<std::int32_t>> solved(database.tools.size());
  std::vector<std::int32_t> any;
  for (std::size_t t = 0; t < database.tools.size(); ++t) {
    const std::vector<std::uint8_t>& origin = database.tools[t].origin;
    for (std::size_t v = 0; v < origin.size(); ++v) {
      if (origin[v] == static_cast<std::uint8_t>(ResponseOrigin::kSimulated)) {
        solved[t].push_back(static_cast<std::int32_t>(v));
      }
    }
    any.insert(any.end(), solved[t].begin(), solved[t].end());
  }
  std::sort(any.begin(), any.end());
  PressStrategy shared = strategy;
  shared.shared_mesh = true;
  const SceneSolver solver(scene, body, shared, reachable, any, progress);
  progress.stage("surface fields");
  for (std::size_t t = 0; t < database.tools.size(); ++t) {
    std::vector<PressedNode> nodes = solver.cheap(body.tool[t], solved[t]);
    std::erase_if(nodes, [](const PressedNode& node) {
      const auto& sample = node.indentation.sample;
      return sample.size() < 2 || !(sample.back().pressure_n.sum() > 0.0) ||
             !sample.back().pressure_n.allFinite();
    });
    database.tools[t].displacement =
        compress_fields(surface_displacements_m(*solver.shared(),
                                                body.surface.position_m.rows(), nodes),
                        nodes, scene.drawing.error_relative);
  }
  progress.finish();
}

}  // namespace palpate
