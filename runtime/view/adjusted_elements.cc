#include "runtime/view/adjusted_elements.h"

#include <array>

namespace palpate {
namespace {

void multiply(std::array<double, kElementSamples>& values, double scale) {
  for (double& value : values) {
    value *= scale;
  }
}

}  // namespace

void adjust_node(ElementNode& node, double scale, std::optional<double> friction) {
  multiply(node.force_n, scale);
  multiply(node.stiffness_n_per_m, scale);
  multiply(node.energy_j, scale);
  node.friction = friction.value_or(node.friction);
}

std::size_t AdjustedStream::update(const ToolState& tool, std::int64_t now_ns,
                                   ElementFifo& fifo) {
  static_cast<void>(stream_.update(tool, now_ns, *unchanged_));
  std::size_t sent = 0;
  while (const Element* front = unchanged_->front()) {
    Element element = *front;
    unchanged_->pop();
    for (ElementNode& node : element.node) {
      adjust_node(node, scale_, friction_);
    }
    sent += fifo.push(element) ? 1 : 0;
  }
  return sent;
}

}  // namespace palpate
