// The dents that a body keeps, for a while or for good, at the nodes of its surface.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/response/response_table.h"
#include "runtime/render/surface_dents.h"

namespace palpate {

struct NodeDent {
  std::int32_t node = -1;
  double depth_m = 0.0;  ///< [m] > 0, inward along the normal
};

class ViewDents {
 public:
  /// @param table whose curves are copied as they are rendered; if neither relaxes nor
  /// yields: no dents.
  explicit ViewDents(const ResponseTable& table);

  /// Depth at which each node's response is what its sites carry, under the dent that
  /// stays. Depths below a hundredth of the largest depth are left out. By node.
  /// @param stiffness_scale [-] > 0 that forces are multiplied by.
  [[nodiscard]] std::vector<NodeDent> at(const std::vector<SurfaceDent>& dents,
                                         double stiffness_scale) const;

 private:
  ResponseTable table_;
  std::vector<std::vector<std::int32_t>> readers_;  // nodes by site
};

}  // namespace palpate
