#include "runtime/slow/memory_elements.h"

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/press_inversion.h"
#include "formats/response/tool_support.h"
#include "formats/response/yielding.h"
#include "runtime/slow/node_memory.h"

namespace palpate {
namespace {

std::optional<ResponseTable> rendered_copy(const ResponseTable& table) {
  const Viscoelasticity& relaxation = table.viscoelasticity;
  const bool pressed = !relaxation.empty() && !relaxation.instantaneous;
  if (!pressed && relaxation.yielding.largest.empty()) {
    return std::nullopt;
  }
  std::optional<ResponseTable> copy = table;
  make_instantaneous(*copy);
  make_undamaged(*copy);
  return copy;
}

// Of a table that has directions by sample and no tilts.
std::vector<TiltLine> tilts_by_sample(const ResponseDatabase& database,
                                      const ResponseTable& table) {
  std::vector<TiltLine> tilt;
  if (table.tilt.rows() == 0 && table.sample_direction.rows() > 0) {
    const std::vector<double> edge_m = longest_edges_m(database.body);
    for (std::int64_t i = 0; i < table.nodes(); ++i) {
      tilt.push_back(tilt_line(table, i, database.normal.row(i).transpose(),
                               edge_m[static_cast<std::size_t>(i)]));
    }
  }
  return tilt;
}

}  // namespace

ElementStream::ElementStream(const ResponseDatabase& database,
                             const ResponseTable& table, double force_scale)
    : database_(database),
      instantaneous_(rendered_copy(table)),
      tilt_(tilts_by_sample(database, table)),
      rows_{database.body.position_m, database.normal,
            instantaneous_ ? *instantaneous_ : table, force_scale, tilt_},
      search_(database.body) {
  if (!(force_scale > 0.0 && force_scale <= 1.0)) {
    throw InputError(fmt::format("force scale is {}, must lie in (0, 1]", force_scale));
  }
  thinned_ = thinned_messages(rows_, loss_);
}

Element ElementStream::element(std::int32_t triangle) const {
  Element message;
  message.triangle = triangle;
  message.touch_height_m = nominal_height_m(rows_.table.tool);
  const Viscoelasticity& relaxation = rows_.table.viscoelasticity;
  message.memory = tool_memory(relaxation);
  for (std::size_t j = 0; j < 3; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const std::int32_t node = database_.body.triangle(triangle, column);
    const auto thinned = thinned_.find(node);
    message.node[j] =
        thinned != thinned_.end() ? thinned->second : node_message(rows_, node);
    message.node[j].node = node;
    if (relaxation.remembers()) {
      message.memory.node[j] = node_memory(relaxation, node, message.node[j]);
    }
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
  if (!tool.position_m.allFinite()) {
    return 0;
  }
  const bool walk = tool.in_contact && tool.triangle >= 0 &&
                    tool.triangle < database_.body.triangle.rows();
  const std::int32_t active = (walk ? search_.walk(tool.position_m, tool.triangle)
                                    : search_.nearest(tool.position_m))
                                  .triangle;
  if (active < 0) {
    return 0;
  }
  const WantedTriangles wanted =
      wanted_triangles(search_, active, walk ? tool.triangle : -1);
  std::size_t sent = 0;
  for (std::size_t i = 0; i < wanted.count; ++i) {
    sent += send(wanted.triangle[i], i == 0, now_ns, fifo) ? 1 : 0;
  }
  return sent;
}

}  // namespace palpate
