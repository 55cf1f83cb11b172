#include "runtime/slow/memory_elements.h"

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/press_inversion.h"
#include "formats/response/tool_support.h"
#include "formats/response/yielding.h"
#include "runtime/slow/node_memory.h"
#include "runtime/slow/node_puncture.h"

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
                             const ResponseTable& table, double force_scale,
                             const ComplianceTable* coupling)
    : database_(database),
      coupling_(coupling),
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
    message.puncture[j] = node_puncture(rows_.table.puncture, node, rows_.force_scale);
    message.neighbour[j] = search_.neighbours()(triangle, column);
  }
  return message;
}

ElementRows ElementStream::rows(std::int32_t triangle) const {
  ElementRows rows;
  for (std::size_t j = 0; j < 3 && coupling_ != nullptr; ++j) {
    const std::int32_t node =
        database_.body.triangle(triangle, static_cast<Eigen::Index>(j));
    rows[j] = contact_row(*coupling_, node, rows_.force_scale);
  }
  return rows;
}

WantedTriangles ElementStream::wanted(const ToolState& contact) {
  const bool walk = is_in_use(contact, database_.body.triangle.rows());
  const std::int32_t active = (walk ? search_.walk(contact.position_m, contact.triangle)
                                    : search_.nearest(contact.position_m))
                                  .triangle;
  return active < 0 ? WantedTriangles{}
                    : wanted_triangles(search_, active, walk ? contact.triangle : -1);
}

}  // namespace palpate
