#include "precompute/press/surface_displacement.h"

#include <algorithm>
#include <iterator>
#include <mutex>

#include <Eigen/Eigenvalues>

#include "precompute/process/interrupt.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

constexpr std::size_t kBlock = 32;    // presses side by side, columns per solve
constexpr double kDrawnAcross = 4.0;  // contact nodes across a contact's radius

// The last state of a nonlinear press, if there is one.
const NonlinearIndentation* state_of(const PressedNode& node) {
  return node.nonlinear && !node.nonlinear->sample.empty() ? node.nonlinear.get()
                                                           : nullptr;
}

bool can_be_drawn(const PressedNode& node) {
  const auto& sample = node.indentation.sample;
  return sample.size() > 1 && sample.back().pressure_n.sum() > 0.0 &&
         sample.back().pressure_n.allFinite();
}

// What holds the linear body in the press's shape, on the free degrees of freedom.
void add_load(const BodyModel& model, const PressedNode& node,
              Eigen::Ref<Eigen::VectorXd> b) {
  if (const NonlinearIndentation* state = state_of(node)) {
    for (std::size_t i = 0; i < state->near_dof.size(); ++i) {
      if (state->near_dof[i] >= 0) {
        b[state->near_dof[i]] += state->state.source_n[static_cast<Eigen::Index>(i)];
      }
    }
    return;
  }
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

void append(const SurfaceFields& more, SurfaceFields& all) {
  all.node.insert(all.node.end(), more.node.begin(), more.node.end());
  all.depth_m.insert(all.depth_m.end(), more.depth_m.begin(), more.depth_m.end());
  const Eigen::Index before = all.field_m.cols();
  all.field_m.conservativeResize(more.field_m.rows(), before + more.field_m.cols());
  all.field_m.rightCols(more.field_m.cols()) = more.field_m;
}

// In blocks side by side: states of nonlinear presses are too large for all at once.
SurfaceFields fields_under(const SceneSolver& solver, const BodySource& body,
                           const SharedTool& tool,
                           std::span<const std::int32_t> vertices, Progress& progress) {
  std::vector<SurfaceFields> block((vertices.size() + kBlock - 1) / kBlock);
  std::mutex told;
  std::size_t done = 0;
  in_parallel(block.size(), [&](std::size_t i) {
    check_interrupted();
    const std::size_t first = i * kBlock;
    const auto of_block =
        vertices.subspan(first, std::min(kBlock, vertices.size() - first));
    block[i] = surface_fields(*solver.shared(), body.surface.position_m.rows(),
                              solver.on_shared_mesh(tool, of_block, true));
    const std::lock_guard lock(told);
    done += of_block.size();
    progress.advance(done, vertices.size(), "fields");
  });
  SurfaceFields all;
  for (const SurfaceFields& more : block) {
    append(more, all);
  }
  return all;
}

std::vector<std::int32_t> solved_nodes(const ResponseTable& table) {
  std::vector<std::int32_t> solved;
  for (std::size_t v = 0; v < table.origin.size(); ++v) {
    if (table.origin[v] == static_cast<std::uint8_t>(ResponseOrigin::kSimulated)) {
      solved.push_back(static_cast<std::int32_t>(v));
    }
  }
  return solved;
}

// On one mesh, not as fine as forces want it.
PressStrategy for_drawing(const PressStrategy& strategy, const BodySource& body) {
  PressStrategy drawing = strategy;
  if (!strategy.shared_mesh) {
    const UniformSurface uniform =
        uniform_surface(body, strategy.focus.contact_m / kDrawnAcross, kMostTriangles);
    drawing.surface = uniform.surface;
    drawing.subdivisions = uniform.subdivisions;
    drawing.spacing_m = uniform.node_spacing_m;
    drawing.shared_mesh = true;
  }
  return drawing;
}

}  // namespace

SurfaceFields surface_fields(const BodyModel& model, Eigen::Index vertices,
                             std::span<const PressedNode> nodes) {
  SurfaceFields fields;
  std::vector<const PressedNode*> drawn;
  for (const PressedNode& node : nodes) {
    if (can_be_drawn(node)) {
      const NonlinearIndentation* state = state_of(node);
      drawn.push_back(&node);
      fields.node.push_back(node.vertex);
      fields.depth_m.push_back(state != nullptr
                                   ? state->sample.back().penetration_m
                                   : node.indentation.sample.back().penetration_m);
    }
  }
  const auto columns = static_cast<Eigen::Index>(drawn.size());
  fields.field_m = Eigen::MatrixXd::Zero(3 * vertices, columns);
  constexpr auto kColumns = static_cast<Eigen::Index>(kBlock);
  for (Eigen::Index first = 0; first < columns; first += kColumns) {
    const Eigen::Index count = std::min(kColumns, columns - first);
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(model.factor->size(), count);
    for (Eigen::Index k = 0; k < count; ++k) {
      add_load(model, *drawn[static_cast<std::size_t>(first + k)], B.col(k));
    }
    const Eigen::MatrixXd X = model.factor->solve(B);
    for (Eigen::Index i = 0; i < 3 * vertices; ++i) {
      const std::int64_t dof = model.supports.free_index[static_cast<std::size_t>(i)];
      if (dof >= 0) {
        fields.field_m.row(i).segment(first, count) = X.row(dof);
      }
    }
  }
  return fields;
}

DisplacementField compress_fields(const SurfaceFields& fields, double error_relative) {
  DisplacementField stored;
  if (fields.node.empty()) {
    return stored;
  }
  const Eigen::MatrixXd& field_m = fields.field_m;
  const Eigen::VectorXd scale_m = largest_m(field_m);
  const Eigen::MatrixXd unit = field_m * scale_m.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd basis = modes_of(unit, error_relative);
  stored.node = fields.node;
  stored.depth_m = fields.depth_m;
  stored.basis = basis.cast<float>();
  stored.coefficient = (field_m.transpose() * basis).cast<float>();
  const Eigen::MatrixXd missed =
      field_m -
      stored.basis.cast<double>() * stored.coefficient.cast<double>().transpose();
  for (Eigen::Index k = 0; k < field_m.cols(); ++k) {
    stored.error_relative.push_back(missed.col(k).norm() / field_m.col(k).norm());
  }
  return stored;
}

void add_surface_fields(const Scene& scene, const BodySource& body,
                        const PressStrategy& strategy,
                        std::span<const std::int32_t> reachable,
                        ResponseDatabase& database, Progress& progress) {
  std::vector<std::int32_t> any;
  for (const ResponseTable& table : database.tools) {
    const std::vector<std::int32_t> solved = solved_nodes(table);
    any.insert(any.end(), solved.begin(), solved.end());
  }
  std::sort(any.begin(), any.end());
  const PressStrategy shared = for_drawing(strategy, body);
  const SceneSolver solver(scene, body, shared, reachable, any, progress);
  progress.stage("surface fields");
  for (std::size_t t = 0; t < database.tools.size(); ++t) {
    ResponseTable& table = database.tools[t];
    table.displacement = compress_fields(
        fields_under(solver, body, body.tool[t], solved_nodes(table), progress),
        scene.drawing.error_relative);
  }
  progress.finish();
}

}  // namespace palpate
