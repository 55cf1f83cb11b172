#include "runtime/slow/table_elements.h"

#include <cmath>

namespace palpate {

ContactRow contact_row(const ComplianceTable& table, std::int64_t node,
                       double force_scale) {
  ContactRow row;
  const auto softer = static_cast<float>(1.0 / force_scale);
  const auto root = static_cast<float>(1.0 / std::sqrt(force_scale));
  for (Eigen::Index k = 0; k < table.value.cols(); ++k) {
    row.value[static_cast<std::size_t>(k)] = softer * table.value(node, k);
  }
  for (Eigen::Index m = 0; m < table.mode.cols(); ++m) {
    row.mode[static_cast<std::size_t>(m)] = root * table.mode(node, m);
  }
  return row;
}

std::size_t TableElements::update(const ToolState& tool, std::int64_t now_ns,
                                  ElementFifo& fifo) {
  if (!tool.position_m.allFinite()) {
    return 0;
  }
  follow(std::span(&tool, 1));
  const WantedTriangles all = wanted(tool);
  std::size_t sent = 0;
  for (std::size_t i = 0; i < all.count; ++i) {
    Element message = element(all.triangle[i]);
    message.sequence = ++sequence_;
    message.sent_ns = now_ns;
    message.active = i == 0;
    sent += fifo.push(message) ? 1 : 0;
  }
  return sent;
}

}  // namespace palpate
