#include "tests/bench/runtime/field_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <Eigen/Geometry>

#include "formats/response/tool_support.h"
#include "runtime/fast/fast_step.h"
#include "runtime/slow/memory_elements.h"

namespace palpate {
namespace {

Eigen::Vector3d vector(const std::array<double, 3>& values) {
  return Eigen::Map<const Eigen::Vector3d>(values.data());
}

// The interpolated curve at the model's own depth, and the stored direction.
struct Reference {
  double normal_n = 0.0;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
};

Reference reference(const FastState& state, double depth_m) {
  const bool field = is_field(state.config.model);
  const int slot = field ? state.potential.place.slot : state.element.slot;
  Reference at;
  if (slot < 0) {
    return at;
  }
  const Eigen::Vector3d& weight =
      field ? state.potential.place.weight : state.element.area;
  const Element& element = state.cache.element[static_cast<std::size_t>(slot)];
  for (std::size_t j = 0; j < 3; ++j) {
    const ElementNode& node = element.node[j];
    const Eigen::Vector3d u = vector(node.direction);
    const double w = std::max(0.0, weight(static_cast<Eigen::Index>(j)));
    const double c = std::abs(vector(node.normal).dot(u));
    at.direction += w * u;
    at.normal_n +=
        field ? w * c * node.curve().at(c * (depth_m - node.touch_offset_m)).force_n
              : w * node.curve().at(depth_m - c * node.touch_offset_m).force_n;
  }
  return at;
}

Eigen::Vector3d friction_n(const FastState& state, const Eigen::Vector3d& x) {
  if (is_field(state.config.model)) {
    return state.potential.spring.force_n();
  }
  return -state.element.friction_n_per_m *
         respond(state.element, state.cache, x).presliding_m;
}

void compare(FieldAccount& account, const FastState& state, const Eigen::Vector3d& x,
             const FastCommand& command) {
  const Reference at = reference(state, command.depth_m);
  const Eigen::Vector3d normal_part = command.force_n - friction_n(state, x);
  const double given = is_field(state.config.model)
                           ? state.potential.response.normal_n
                           : normal_part.dot(state.element.direction);
  const double error = given - at.normal_n;
  account.normal_max_n = std::max(account.normal_max_n, at.normal_n);
  account.error_max_n = std::max(account.error_max_n, std::abs(error));
  account.normal_square_n2 += at.normal_n * at.normal_n;
  account.error_square_n2 += error * error;
  const double lengths = normal_part.norm() * at.direction.norm();
  if (lengths > 0.0) {
    account.angle_rad.push_back(std::atan2(normal_part.cross(at.direction).norm(),
                                           normal_part.dot(at.direction)));
  }
}

}  // namespace

FieldWalk walk_over(const BenchBody& body, const BenchWalkOptions& options,
                    int ticks_per_slow) {
  FieldWalk walk;
  walk.tool_radius_m = options.tool_radius_m;
  walk.tick_s = options.tick_s;
  walk.ticks_per_slow = static_cast<std::size_t>(ticks_per_slow);
  walk.position_m = make_bench_walk(body, options);
  for (std::size_t tick = 0; tick < walk.position_m.size();
       tick += walk.ticks_per_slow) {
    walk.messages.push_back(body.around(walk.position_m[tick]));
  }
  return walk;
}

FieldWalk walk_over(const ResponseDatabase& database, const ResponseTable& table,
                    const DatabaseWalkOptions& options) {
  FieldWalk walk;
  walk.tool_radius_m = nominal_height_m(table.tool);
  walk.ticks_per_slow = static_cast<std::size_t>(options.ticks_per_slow);
  Wanderer tool(database, table, options);
  ElementStream stream(database, table);
  auto fifo = std::make_unique<ElementFifo>();
  std::int32_t triangle = -1;
  for (int tick = 0; tick < options.ticks; ++tick) {
    walk.position_m.push_back(tool.step(walk.tick_s));
    if (tick % options.ticks_per_slow == 0) {
      (void)stream.update({.sequence = static_cast<std::uint64_t>(tick + 1),
                           .time_ns = 0,
                           .position_m = walk.position_m.back(),
                           .triangle = triangle,
                           .in_contact = triangle >= 0},
                          0, *fifo);
      walk.messages.emplace_back();
      while (const Element* element = fifo->front()) {
        triangle = element->active ? element->triangle : triangle;
        walk.messages.back().push_back(*element);
        fifo->pop();
      }
    }
  }
  return walk;
}

void set_friction(FieldWalk& walk, double coefficient, double presliding_m) {
  for (std::vector<Element>& sent : walk.messages) {
    for (Element& element : sent) {
      for (ElementNode& node : element.node) {
        node.friction = coefficient;
        node.presliding_m = presliding_m;
      }
    }
  }
}

FieldAccount render(const FieldWalk& walk, LocalModel model) {
  const auto state = std::make_unique<FastState>();
  state->config.model = model;
  state->config.tool_radius_m = walk.tool_radius_m;
  state->config.force_max_n = std::numeric_limits<double>::infinity();
  state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  FieldAccount account;
  double work = 0.0;
  double felt = 0.0;
  Eigen::Vector3d last = walk.position_m.front();
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (std::size_t tick = 0; tick < walk.position_m.size(); ++tick) {
    const Eigen::Vector3d& x = walk.position_m[tick];
    if (tick % walk.ticks_per_slow == 0) {
      for (const Element& element : walk.messages[tick / walk.ticks_per_slow]) {
        accept(*state, element);
      }
    }
    work += potential_j(*state, x) - potential_j(*state, last);
    const FastCommand command = step(*state, {x, 0}, walk.tick_s);
    felt -= 0.5 * (force + command.force_n).dot(x - last);
    force = command.force_n;
    last = x;
    account.lowest_work_j = std::min(account.lowest_work_j, work);
    account.lowest_felt_j = std::min(account.lowest_felt_j, felt);
    account.contact_ticks += command.in_contact ? 1 : 0;
    account.starved_ticks += command.starved ? 1 : 0;
    account.shift_max_m = std::max(account.shift_max_m, command.rest_offset_m);
    if (command.in_contact) {
      compare(account, *state, x, command);
    }
  }
  account.work_j = work;
  account.interventions = state->ledger.interventions;
  return account;
}

}  // namespace palpate
