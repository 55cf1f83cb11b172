#include "precompute/press/node_detail.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/response_curve.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/press/scene_solver.h"
#include "precompute/press/work_unit_solver.h"

namespace palpate {
namespace {

struct Resultant {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_nm = Eigen::Vector3d::Zero();
  void add(const Eigen::Vector3d& at_m, const Eigen::Vector3d& f_n) {
    force_n += f_n;
    moment_nm += at_m.cross(f_n);
  }
};

Eigen::VectorXd pressed_load_n(const BodyModel& model, const PressedNode& pressed,
                               const Eigen::VectorXd& pressure_n) {
  return pressure_load_n(model.contact, pressed.patch, pressure_n);
}

bool is_held_node(const BodyModel& model, Eigen::Index node) {
  return model.supports.free_index[3 * static_cast<std::size_t>(node)] < 0;
}

// K^-1 of a source on free nodes.
Eigen::VectorXd solved_m(const BodyModel& model, const Eigen::VectorXd& source_n) {
  const RestSolve solve = single_solves(*model.factor);
  return solve(model.supports.free_index, source_n, SolveWith::kFactor);
}

// Pressure (nonlinear or not) of the state that was solved last; empty: none was.
Eigen::VectorXd last_pressure_n(const PressedNode& pressed) {
  if (pressed.nonlinear) {
    return pressed.nonlinear->sample.empty() ? Eigen::VectorXd()
                                             : pressed.nonlinear->pressure_n;
  }
  const auto& sample = pressed.indentation.sample;
  return sample.size() < 2 ? Eigen::VectorXd() : sample.back().pressure_n;
}

DeformedBody deformed(const BodyModel& model, const PressedNode& pressed) {
  DeformedBody body{
      .displacement_m = Eigen::VectorXd::Zero(3 * model.mesh.position_m.rows()),
      .near = std::vector<char>(static_cast<std::size_t>(model.mesh.tet.rows()), 0)};
  if (last_pressure_n(pressed).size() == 0) {
    return body;
  }
  // Linear: u = K^-1 b, b the load of the last pressures.
  if (!pressed.nonlinear) {
    body.penetration_m = pressed.indentation.sample.back().penetration_m;
    body.displacement_m =
        solved_m(model, pressed_load_n(model, pressed, last_pressure_n(pressed)));
    return body;
  }
  const NonlinearIndentation& result = *pressed.nonlinear;
  body.penetration_m = result.sample.back().penetration_m;
  // Nonlinear: u = K^-1 s, s the source on near nodes (near_field.h). `place` leads
  // from a free unknown of K back to 3 node + axis.
  std::vector<Eigen::Index> place(static_cast<std::size_t>(model.supports.free));
  for (std::size_t i = 0; i < model.supports.free_index.size(); ++i) {
    if (model.supports.free_index[i] >= 0) {
      place[static_cast<std::size_t>(model.supports.free_index[i])] =
          static_cast<Eigen::Index>(i);
    }
  }
  Eigen::VectorXd source = Eigen::VectorXd::Zero(body.displacement_m.size());
  for (std::size_t i = 0; i < result.near_dof.size(); ++i) {
    if (result.near_dof[i] >= 0) {
      source[place[static_cast<std::size_t>(result.near_dof[i])]] =
          result.state.source_n[static_cast<Eigen::Index>(i)];
    }
  }
  body.displacement_m = solved_m(model, source);
  for (const Eigen::Index tet : result.near_tet) {
    const auto region = static_cast<std::size_t>(region_of(model.mesh, tet));
    body.near[static_cast<std::size_t>(tet)] =
        is_linear(model.material[region]) ? 0 : 1;
  }
  return body;
}

// Internal forces (3 n_nodes) of every tet, and the moment that those of far ones have
// about where their nodes went.
struct Internal {
  Eigen::VectorXd force_n;
  Eigen::Vector3d far_moment_nm = Eigen::Vector3d::Zero();
};

Internal internal_forces(const BodyModel& model, const DeformedBody& body) {
  Internal all{.force_n = Eigen::VectorXd::Zero(body.displacement_m.size())};
  for (Eigen::Index t = 0; t < model.mesh.tet.rows(); ++t) {
    const ElementVector u = nodal_values(model.mesh, t, body.displacement_m);
    const auto geometry = element_geometry(tet_corners(model.mesh, t), t);
    const Material& law =
        model.material[static_cast<std::size_t>(region_of(model.mesh, t))];
    const bool near = body.near[static_cast<std::size_t>(t)] != 0;
    // Near tets dW/du, far tets K_e u at rest. Far forces balance about rest positions;
    // about deformed ones they leave the moment sum u x f.
    const ElementVector f =
        near
            ? element_response(geometry, law, u).force_n
            : ElementVector(
                  element_response(geometry, law, ElementVector::Zero()).stiffness * u);
    for (Eigen::Index j = 0; j < 10; ++j) {
      all.force_n.segment<3>(3 * Eigen::Index{model.mesh.tet(t, j)}) +=
          f.segment<3>(3 * j);
      if (!near) {
        all.far_moment_nm += u.segment<3>(3 * j).cross(f.segment<3>(3 * j));
      }
    }
  }
  return all;
}

Eigen::VectorXd foundation_force_n(const Scene& scene, const BodyModel& model,
                                   const Eigen::VectorXd& u_m) {
  Stiffness springs(u_m.size(), u_m.size());
  for (const SceneSupport& support : scene.support) {
    if (!support.is_fixed()) {
      add_foundation(springs, model.mesh, support.stiffness_pa_per_m,
                     [&](const Eigen::Vector3d& p) {
                       return holds(support, p);
                     });
    }
  }
  return springs.selfadjointView<Eigen::Lower>() * u_m;
}

double work_relative(const PressedNode& pressed) {
  const auto& sample = pressed.indentation.sample;
  std::vector<double> depth_m;
  std::vector<double> force_n;
  for (const IndentationSample& s : sample) {
    depth_m.push_back(s.penetration_m - sample.front().penetration_m);
    force_n.push_back(s.force_n.dot(pressed.path.outward));
  }
  const double work_j = ResponseCurve(depth_m, force_n).at(depth_m.back()).energy_j;
  return std::abs(work_j - sample.back().energy_j) / std::abs(sample.back().energy_j);
}

// What the contact exerts on the tool, about the vertex.
Resultant contact_of(const BodyModel& model, const PressedNode& pressed) {
  Resultant contact;
  if (pressed.nonlinear) {
    const NonlinearSample& last = pressed.nonlinear->sample.back();
    contact.force_n = last.force_n;
    contact.moment_nm = last.moment_nm - pressed.path.vertex_m.cross(last.force_n);
    return contact;
  }
  const Eigen::VectorXd load = pressed_load_n(model, pressed, last_pressure_n(pressed));
  for (Eigen::Index node = 0; node < model.mesh.position_m.rows(); ++node) {
    contact.add(model.mesh.position_m.row(node).transpose() - pressed.path.vertex_m,
                -load.segment<3>(3 * node));
  }
  return contact;
}

bool loads_held_nodes(const BodyModel& model, const PressedNode& pressed) {
  const Eigen::VectorXd load = pressed_load_n(model, pressed, last_pressure_n(pressed));
  for (Eigen::Index node = 0; node < model.mesh.position_m.rows(); ++node) {
    if (is_held_node(model, node) && !load.segment<3>(3 * node).isZero(0.0)) {
      return true;
    }
  }
  return false;
}

std::vector<DepthDetail> depths_of(const BodyModel& model, const PressedNode& pressed) {
  std::vector<DepthDetail> depth(pressed.indentation.sample.size());
  for (std::size_t k = 1; k < depth.size(); ++k) {
    if (pressed.nonlinear) {
      for (const NonlinearSample& solved : pressed.nonlinear->sample) {
        if (solved.penetration_m == pressed.indentation.sample[k].penetration_m) {
          depth[k] = {solved.newton, solved.gradients, solved.smallest_jacobian};
        }
      }
      continue;
    }
    const Eigen::VectorXd u = solved_m(
        model,
        pressed_load_n(model, pressed, pressed.indentation.sample[k].pressure_n));
    for (Eigen::Index t = 0; t < model.mesh.tet.rows(); ++t) {
      depth[k].smallest_jacobian =
          std::min(depth[k].smallest_jacobian,
                   smallest_jacobian(element_geometry(tet_corners(model.mesh, t), t),
                                     nodal_values(model.mesh, t, u)));
    }
  }
  return depth;
}

std::int32_t checked_vertex(const Scene& scene, const BodySource& body,
                            std::int64_t vertex) {
  if (vertex < 0 || vertex >= body.surface.position_m.rows()) {
    throw InputError(
        fmt::format("vertex {} does not exist: the body has vertices 0 to {}", vertex,
                    body.surface.position_m.rows() - 1));
  }
  if (is_held(scene, body.surface.position_m.row(vertex).transpose())) {
    throw InputError(
        fmt::format("vertex {} is held by a support: nothing yields there", vertex));
  }
  return static_cast<std::int32_t>(vertex);
}

}  // namespace

BalanceChecks check_balance(const Scene& scene, const BodyModel& model,
                            const PressedNode& pressed, const DeformedBody& body) {
  BalanceChecks checks;
  if (last_pressure_n(pressed).size() == 0) {
    return checks;
  }
  checks.work = work_relative(pressed);
  if (loads_held_nodes(model, pressed)) {
    return checks;
  }
  const Internal internal = internal_forces(model, body);
  const Eigen::VectorXd spring_n =
      foundation_force_n(scene, model, body.displacement_m);
  // Forces of the supports on the body, about the vertex: internal forces of held nodes
  // and -k u of foundations. In equilibrium they equal the force of the body on the
  // tool.
  Resultant supports;
  for (Eigen::Index node = 0; node < model.mesh.position_m.rows(); ++node) {
    Eigen::Vector3d at =
        model.mesh.position_m.row(node).transpose() - pressed.path.vertex_m;
    if (pressed.nonlinear) {
      at += body.displacement_m.segment<3>(3 * node);
    }
    supports.add(at, -spring_n.segment<3>(3 * node));
    if (is_held_node(model, node)) {
      supports.add(at, internal.force_n.segment<3>(3 * node));
    }
  }
  const Resultant contact = contact_of(model, pressed);
  const double force_n = contact.force_n.norm();
  const Eigen::Vector3d low = model.mesh.position_m.colwise().minCoeff();
  const Eigen::Vector3d high = model.mesh.position_m.colwise().maxCoeff();
  // Moments are measured by the force times the diagonal of the body's box.
  const double moment_nm = force_n * (high - low).norm();
  const Eigen::Vector3d far_nm =
      pressed.nonlinear ? internal.far_moment_nm : Eigen::Vector3d::Zero();
  checks.force = (supports.force_n - contact.force_n).norm() / force_n;
  checks.moment = (supports.moment_nm - contact.moment_nm - far_nm).norm() / moment_nm;
  checks.theory_moment = internal.far_moment_nm.norm() / moment_nm;
  if (!pressed.nonlinear) {
    const Eigen::Vector3d& tool_n = pressed.indentation.sample.back().force_n;
    checks.theory_force = (tool_n - contact.force_n).norm() / tool_n.norm();
  }
  return checks;
}

namespace {

// The vertices that a build presses on one mesh with this one.
std::vector<std::int32_t> group_of(const Scene& scene, const BodySource& body,
                                   const PressStrategy& strategy,
                                   std::span<const std::int32_t> reachable,
                                   std::int32_t vertex) {
  const auto has_it = [&](const std::vector<std::int32_t>& vertices) {
    return std::find(vertices.begin(), vertices.end(), vertex) != vertices.end();
  };
  for (const WorkUnit& unit : units_of(scene, body, reachable)) {
    if (unit.is_check || !has_it(unit.vertex)) {
      continue;
    }
    for (auto& group :
         group_presses(body.surface, unit.vertex, strategy.focus, strategy.nonlinear)) {
      if (has_it(group)) {
        return std::move(group);
      }
    }
  }
  return {vertex};
}

// The press, and the mesh that it was made on.
void press_on_its_mesh(const Scene& scene, const BodySource& body,
                       const SharedTool& tool, const PressStrategy& strategy,
                       const std::vector<std::int32_t>& group, std::int32_t vertex,
                       const PressMode& mode, NodeDetail& detail) {
  for (PressedNode& node :
       press_on_own_mesh(scene, body, tool, group, strategy.focus, mode)) {
    if (node.vertex == vertex) {
      detail.pressed = std::move(node);
    }
  }
  const std::vector<Attempt>& tried = detail.pressed.tried;
  detail.model =
      is_alone(tried)
          ? make_own_model(
                scene, body, {&vertex, 1},
                finer(strategy.focus, tried[last_taken(tried)].recipe.times_finer))
          : make_own_model(scene, body, group, strategy.focus);
}

}  // namespace

NodeDetail press_in_detail(const Scene& scene, const BodySource& body,
                           const SharedTool& tool, std::int64_t vertex,
                           const std::optional<NonlinearOptions>& options,
                           Progress& progress) {
  require_whole_body(scene, "indent");
  const std::int32_t v = checked_vertex(scene, body, vertex);
  progress.stage("indentation");
  std::vector<std::int32_t> reachable = reachable_vertices(scene, body);
  if (!std::binary_search(reachable.begin(), reachable.end(), v)) {
    reachable = {v};  // a build leaves it out
  }
  const PressStrategy strategy = choose_strategy(scene, body, reachable);
  const PressMode mode{.nonlinear = strategy.nonlinear,
                       .recipe = {.depths = options.has_value() ? SolvedDepths::kEvery
                                                                : SolvedDepths::kFew},
                       .options = options.value_or(nonlinear_options(scene, tool)),
                       .keep_states = true};
  NodeDetail detail;
  if (strategy.shared_mesh && (strategy.linear_is_full || !strategy.graded)) {
    detail.model = make_shared_model(scene, body, strategy);
    detail.pressed = std::move(
        press_on_model(scene, body, detail.model, tool, {&v, 1}, mode).front());
  } else {
    press_on_its_mesh(scene, body, tool, strategy,
                      group_of(scene, body, strategy, reachable, v), v, mode, detail);
  }
  if (detail.pressed.indentation.sample.empty() && !detail.pressed.failure.empty()) {
    throw NumericalError(fmt::format("vertex {}: {}", v, detail.pressed.failure));
  }
  detail.depth = depths_of(detail.model, detail.pressed);
  detail.body = deformed(detail.model, detail.pressed);
  detail.checks = check_balance(scene, detail.model, detail.pressed, detail.body);
  progress.finish();
  return detail;
}

std::int64_t nearest_vertex(const SurfaceMesh& surface,
                            const Eigen::Vector3d& point_m) {
  Eigen::Index nearest = 0;
  (surface.position_m.rowwise() - point_m.transpose())
      .rowwise()
      .squaredNorm()
      .minCoeff(&nearest);
  return nearest;
}

}  // namespace palpate
