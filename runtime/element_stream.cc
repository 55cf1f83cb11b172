#include "runtime/element_stream.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "formats/error.h"
#include "runtime/element_curve.h"

namespace palpate {
namespace {

std::array<double, 3> as_array(const Points& points, Eigen::Index row) {
  return {points(row, 0), points(row, 1), points(row, 2)};
}

}  // namespace

ElementStream::ElementStream(const ResponseDatabase& database,
                             const ResponseTable& table, double force_scale)
    : database_(database),
      table_(table),
      force_scale_(force_scale),
      search_(database.body) {
  if (!(force_scale > 0.0 && force_scale <= 1.0)) {
    throw InputError(fmt::format("force scale is {}, must lie in (0, 1]", force_scale));
  }
  for (std::int32_t i = 0; i < table.nodes(); ++i) {
    const CurveView curve = table.curve(i);
    if (curve.depth_m.size() <= kElementSamples) {
      continue;
    }
    double loss_n = 0.0;
    thinned_.emplace(i, make_node(i, &loss_n));
    const double force_max =
        std::abs(*std::max_element(curve.force_n.begin(), curve.force_n.end()));
    loss_.nodes += 1;
    loss_.force_n = std::max(loss_.force_n, loss_n);
    if (force_max > 0.0) {
      loss_.force_relative = std::max(loss_.force_relative, loss_n / force_max);
    }
  }
}

ElementNode ElementStream::make_node(std::int32_t node, double* loss_n) const {
  const auto i = static_cast<std::size_t>(node);
  ElementNode message;
  message.node = node;
  message.position_m = as_array(database_.body.position_m, node);
  message.normal = as_array(database_.normal, node);
  message.friction = table_.friction[i];
  message.presliding_m = table_.presliding_m[i];
  message.touch_offset_m = table_.touch_offset_m[i];
  const CurveView curve = table_.curve(node);
  if (curve.depth_m.empty()) {
    return message;
  }
  message.direction = as_array(table_.direction, node);
  *loss_n = set_curve(message, curve) * force_scale_;
  for (std::size_t k = 0; k < static_cast<std::size_t>(message.samples); ++k) {
    message.force_n[k] *= force_scale_;
    message.stiffness_n_per_m[k] *= force_scale_;
    message.energy_j[k] *= force_scale_;
  }
  return message;
}

Element ElementStream::element(std::int32_t triangle) const {
  Element message;
  message.triangle = triangle;
  for (std::size_t j = 0; j < 3; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const std::int32_t node = database_.body.triangle(triangle, column);
    const auto thinned = thinned_.find(node);
    double loss_n = 0.0;
    message.node[j] =
        thinned != thinned_.end() ? thinned->second : make_node(node, &loss_n);
    message.neighbour[j] = search_.neighbours()(triangle, column);
  }
  return message;
}

bool ElementStream::send(std::int32_t triangle, bool active, std::int64_t now_ns,
                         ElementFifo& fifo) {
  Element message = element(triangle);
  message.sequence = ++sequence_;
  message.sent_ns = now_ns;
  message.active = active;
  return fifo.push(message);
}

std::size_t ElementStream::update(const ToolState& tool, std::int64_t now_ns,
                                  ElementFifo& fifo) {
  const bool walk = tool.in_contact && tool.triangle >= 0 &&
                    tool.triangle < database_.body.triangle.rows() &&
                    tool.position_m.allFinite();
  const std::int32_t active = (walk ? search_.walk(tool.position_m, tool.triangle)
                                    : search_.nearest(tool.position_m))
                                  .triangle;
  if (active < 0) {
    return 0;
  }
  std::array<std::int32_t, 1 + kNeighboursMax> wanted{active};
  const std::span<std::int32_t> around = std::span(wanted).subspan(1);
  const std::size_t ring = search_.around(active, around);
  std::size_t count = 1 + ring;
  if (walk && tool.triangle != active &&
      std::find(around.begin(), around.end(), tool.triangle) == around.end()) {
    // The three edges of the other element take the places of the last of the ring.
    const std::size_t kept = std::min(ring, kNeighboursMax - 3);
    count = 1 + kept + search_.around(tool.triangle, around.subspan(kept, 3));
  }
  std::size_t sent = 0;
  for (std::size_t i = 0; i < count; ++i) {
    sent += send(wanted[i], i == 0, now_ns, fifo) ? 1 : 0;
  }
  return sent;
}

}  // namespace palpate
