#include "precompute/press/compliance_sample.h"

#include <algorithm>

namespace palpate {

ColumnSample column_sample(const BodyModel& model, std::span<const PressedNode> placed,
                           std::span<const std::int32_t> vertices) {
  ColumnSample sample;
  sample.wanted.assign(model.contact.node.size(), 0);
  std::vector<char> any(model.contact.node.size(), 0);
  for (const PressedNode& node : placed) {
    const bool is_sample =
        std::binary_search(vertices.begin(), vertices.end(), node.vertex);
    for (const std::int32_t c : node.patch) {
      any[static_cast<std::size_t>(c)] = 1;
      if (is_sample) {
        sample.wanted[static_cast<std::size_t>(c)] = 1;
      }
    }
  }
  sample.all = static_cast<std::size_t>(std::count(any.begin(), any.end(), 1));
  // A block of kBlock columns is solved as a whole if one of its columns is wanted.
  // Blocks are counted here in the order of contact nodes.
  const std::size_t block = SurfaceCompliance::kBlock;
  std::size_t seen = 0;
  bool needed = false;
  for (std::size_t c = 0; c < any.size(); ++c) {
    if (any[c] != 0) {
      needed = needed || sample.wanted[c] != 0;
      if (++seen % block == 0 || seen == sample.all) {
        sample.solved += needed ? (seen - 1) % block + 1 : 0;
        needed = false;
      }
    }
  }
  return sample;
}

std::vector<std::int32_t> spread_over(std::span<const std::int32_t> vertices,
                                      std::size_t count) {
  std::vector<std::int32_t> chosen;
  count = std::min(count, vertices.size());
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(vertices[(2 * i + 1) * vertices.size() / (2 * count)]);
  }
  return chosen;
}

}  // namespace palpate
