#include "precompute/press/surface_displacement.h"

#include <algorithm>
#include <functional>
#include <mutex>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/process/interrupt.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

constexpr std::size_t kPressesPerSolve = 32;  // presses side by side, columns per solve
constexpr double kDrawnAcross = 4.0;          // contact nodes across a contact's radius

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
void add_holding_load(const BodyModel& model, const PressedNode& node,
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
  // Proper orthogonal decomposition: modes U v_i, v_i the eigenvectors of U^T U by
  // falling eigenvalue. Each mode is taken of what is left, so that rounding leaves it
  // orthogonal.
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

PressFields joined(std::span<const PressFields> block, Eigen::Index vertices) {
  PressFields all;
  for (const PressFields& more : block) {
    all.node.insert(all.node.end(), more.node.begin(), more.node.end());
    all.depth_m.insert(all.depth_m.end(), more.depth_m.begin(), more.depth_m.end());
  }
  all.field_m.resize(3 * vertices, static_cast<Eigen::Index>(all.node.size()));
  Eigen::Index first = 0;
  for (const PressFields& more : block) {
    all.field_m.middleCols(first, more.field_m.cols()) = more.field_m;
    first += more.field_m.cols();
  }
  return all;
}

using Group = std::vector<std::int32_t>;

// Of blocks side by side: states of nonlinear presses are too large for all at once.
PressFields in_blocks(const std::vector<Group>& block, Eigen::Index vertices,
                      const std::function<PressFields(const Group&)>& fields,
                      Progress& progress) {
  std::vector<PressFields> of_block(block.size());
  std::mutex progress_mutex;
  std::size_t done = 0;
  in_parallel(block.size(), [&](std::size_t i) {
    check_interrupted();
    of_block[i] = fields(block[i]);
    const std::lock_guard lock(progress_mutex);
    progress.advance(++done, block.size(), "blocks");
  });
  return joined(of_block, vertices);
}

std::vector<Group> blocks_of(std::span<const std::int32_t> vertices) {
  std::vector<Group> blocks;
  for (std::size_t first = 0; first < vertices.size(); first += kPressesPerSolve) {
    const auto block =
        vertices.subspan(first, std::min(kPressesPerSolve, vertices.size() - first));
    blocks.emplace_back(block.begin(), block.end());
  }
  return blocks;
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
  if (!strategy.shared_mesh && !strategy.cut_out) {
    const UniformSurface uniform =
        uniform_surface(body, strategy.focus.contact_m / kDrawnAcross, kMostTriangles);
    drawing.surface = uniform.surface;
    drawing.subdivisions = uniform.subdivisions;
    drawing.spacing_m = uniform.node_spacing_m;
    drawing.shared_mesh = true;
  }
  return drawing;
}

// Those with a contact.
std::vector<const PressedNode*> drawn(std::span<const PressedNode> nodes) {
  std::vector<const PressedNode*> pressed;
  for (const PressedNode& node : nodes) {
    if (can_be_drawn(node)) {
      pressed.push_back(&node);
    }
  }
  return pressed;
}

// Nodes, depths and fields of zero.
PressFields named_fields(std::span<const PressedNode* const> nodes,
                         Eigen::Index vertices) {
  PressFields fields;
  for (const PressedNode* node : nodes) {
    const NonlinearIndentation* state = state_of(*node);
    fields.node.push_back(node->vertex);
    fields.depth_m.push_back(state != nullptr
                                 ? state->sample.back().penetration_m
                                 : node->indentation.sample.back().penetration_m);
  }
  fields.field_m.setZero(3 * vertices, static_cast<Eigen::Index>(nodes.size()));
  return fields;
}

// Of the free degrees of freedom, (n_free x n_nodes).
Eigen::MatrixXd displaced_m(const BodyModel& model,
                            std::span<const PressedNode* const> nodes) {
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(model.factor->size(),
                                            static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    add_holding_load(model, *nodes[k], B.col(static_cast<Eigen::Index>(k)));
  }
  return model.factor->solve(B);
}

// Gives a vertex what a node of the mesh does.
void take_node(const Supports& supports, std::int64_t node, const Eigen::MatrixXd& X,
               std::int64_t vertex, Eigen::MatrixXd& field_m) {
  for (std::int64_t axis = 0; axis < 3; ++axis) {
    const std::int64_t dof =
        supports.free_index[static_cast<std::size_t>(3 * node + axis)];
    if (dof >= 0) {
      field_m.row(3 * vertex + axis) = X.row(dof);
    } else {
      field_m.row(3 * vertex + axis).setZero();
    }
  }
}

// Contact nodes that any of the presses may touch, ascending, and the pressures on
// them, (n x n_nodes) [N].
std::vector<std::int32_t> pressures_of(std::span<const PressedNode* const> nodes,
                                       Eigen::MatrixXd& pressure_n) {
  std::vector<std::int32_t> touched;
  for (const PressedNode* node : nodes) {
    touched.insert(touched.end(), node->patch.begin(), node->patch.end());
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  pressure_n.setZero(static_cast<Eigen::Index>(touched.size()),
                     static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const std::vector<std::int32_t>& patch = nodes[k]->patch;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const auto row =
          std::lower_bound(touched.begin(), touched.end(), patch[i]) - touched.begin();
      pressure_n(row, static_cast<Eigen::Index>(k)) =
          nodes[k]->indentation.sample.back().pressure_n[static_cast<Eigen::Index>(i)];
    }
  }
  return touched;
}

// Blocks of a body whose parts are pressed.
PressFields fields_of_parts(const Scene& scene, const CutOutSolver& cut_out,
                            const BodySource& body, const SharedTool& tool,
                            std::span<const std::int32_t> solved, Progress& progress) {
  const CoarseBody* rest = cut_out.coarse();
  const Eigen::Index vertices = body.surface.position_m.rows();
  std::vector<TetLocator::Place> place;
  for (Eigen::Index v = 0; rest != nullptr && v < vertices; ++v) {
    place.push_back(rest->place(body.surface.position_m.row(v).transpose()));
  }
  return in_blocks(
      cut_out.groups(solved), vertices,
      [&](const Group& group) {
        const ClampedPart part = cut_out.part(group, scene.cutout->radius_m);
        return part_fields(part, rest, place, vertices,
                           cut_out.press_on(part, tool, group));
      },
      progress);
}

// Dense ones; where they do not fit, modes that viewers can draw with do not either.
void require_few_fields(Eigen::Index vertices, std::size_t solved) {
  constexpr double kMostBytes = 2.0 * (1 << 30);
  const double bytes =
      24.0 * static_cast<double>(vertices) * static_cast<double>(solved);
  if (bytes > kMostBytes) {
    throw InputError(fmt::format(
        "{} solved nodes move {} vertices each, {:.0f} GB of displacements; at most "
        "{:.0f} GB are computed",
        solved, vertices, 1e-9 * bytes, 1e-9 * kMostBytes));
  }
}

}  // namespace

PressFields press_fields(const BodyModel& model, Eigen::Index vertices,
                         std::span<const PressedNode> nodes) {
  const std::vector<const PressedNode*> pressed = drawn(nodes);
  PressFields fields = named_fields(pressed, vertices);
  const Eigen::MatrixXd X = displaced_m(model, pressed);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    take_node(model.supports, v, X, v, fields.field_m);
  }
  return fields;
}

PressFields part_fields(const ClampedPart& part, const CoarseBody* rest,
                        std::span<const TetLocator::Place> place, Eigen::Index vertices,
                        std::span<const PressedNode> nodes) {
  const std::vector<const PressedNode*> pressed = drawn(nodes);
  PressFields fields = named_fields(pressed, vertices);
  // 1. Displacements of the part with its cut clamped.
  Eigen::MatrixXd X = displaced_m(part.model, pressed);
  if (rest != nullptr && !part.cut.empty() && !pressed.empty()) {
    Eigen::MatrixXd pressure_n;
    // 2. The coarse body moves under the same pressures. Its motion at the cut carries
    //    the part along; vertices outside the part take it as it is.
    const std::vector<std::int32_t> touched = pressures_of(pressed, pressure_n);
    const Eigen::MatrixXd moved_m = rest->displaced_m(part, touched, pressure_n);
    X += rest->carried_m(part, moved_m);
    for (Eigen::Index v = 0; v < vertices; ++v) {
      fields.field_m.middleRows(3 * v, 3) =
          rest->at_m(place[static_cast<std::size_t>(v)], moved_m);
    }
  }
  // 3. Vertices of the part, except those on the cut, take the sum of both.
  for (std::size_t i = 0; i < part.corner.size(); ++i) {
    const auto node = static_cast<std::int32_t>(i);
    if (part.corner[i] < vertices &&
        !std::binary_search(part.cut.begin(), part.cut.end(), node)) {
      take_node(part.model.supports, node, X, part.corner[i], fields.field_m);
    }
  }
  return fields;
}

DisplacementField compress_fields(const PressFields& fields, double error_relative) {
  DisplacementField stored;
  if (fields.node.empty()) {
    return stored;
  }
  const Eigen::MatrixXd& field_m = fields.field_m;
  // Every field is scaled to a largest displacement of 1, so that modes serve small
  // fields as well as large ones. Coefficients u^T B are of the unscaled fields [m].
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
  const Eigen::Index vertices = body.surface.position_m.rows();
  for (std::size_t t = 0; t < database.tools.size(); ++t) {
    const SharedTool& tool = body.tool[t];
    const std::vector<std::int32_t> solved = solved_nodes(database.tools[t]);
    require_few_fields(vertices, solved.size());
    // Parts of a cut-out, or blocks of presses on the shared mesh.
    const PressFields fields =
        strategy.cut_out
            ? fields_of_parts(scene, *solver.cut_out(), body, tool, solved, progress)
            : in_blocks(
                  blocks_of(solved), vertices,
                  [&](const Group& block) {
                    return press_fields(*solver.shared(), vertices,
                                        solver.with_states(tool, block));
                  },
                  progress);
    database.tools[t].displacement =
        compress_fields(fields, scene.drawing.error_relative);
  }
  progress.finish();
}

}  // namespace palpate
