#include "runtime/view/view_dents.h"

#include <algorithm>
#include <map>

#include "formats/response/press_inversion.h"

namespace palpate {
namespace {

constexpr double kShallow = 0.01;  // of the largest depth

// Depth of a force, which curves that fall have at several: the shallowest. The last
// one where the curve does not reach it.
double depth_of(const CurveView& curve, double force_n) {
  const auto above =
      std::find_if(curve.force_n.begin(), curve.force_n.end(), [&](double f) {
        return f >= force_n;
      });
  if (above == curve.force_n.end()) {
    return curve.depth_max_m();
  }
  const auto i = static_cast<std::size_t>(above - curve.force_n.begin());
  double low = i > 0 ? curve.depth_m[i - 1] : 0.0;
  double high = curve.depth_m[i];
  for (int step = 0; step < 20; ++step) {
    const double middle = 0.5 * (low + high);
    (curve.at(middle).force_n < force_n ? low : high) = middle;
  }
  return high;
}

}  // namespace

ViewDents::ViewDents(const ResponseTable& table) {
  if (!table.viscoelasticity.remembers()) {
    return;
  }
  table_ = table;
  make_instantaneous(table_);
  const MemorySites& sites = table_.viscoelasticity.sites;
  readers_.resize(sites.empty() ? static_cast<std::size_t>(table.nodes())
                                : sites.node.size());
  for (std::int32_t node = 0; node < table.nodes(); ++node) {
    if (sites.empty()) {
      readers_[static_cast<std::size_t>(node)] = {node};
      continue;
    }
    for (const std::int32_t site : sites.site.row(node)) {
      if (site >= 0) {
        readers_[static_cast<std::size_t>(site)].push_back(node);
      }
    }
  }
}

std::vector<NodeDent> ViewDents::at(const std::vector<SurfaceDent>& dents,
                                    double stiffness_scale) const {
  struct Blend {
    double carried_n = 0.0;
    double stays_m = 0.0;
  };
  std::map<std::int32_t, Blend> blend;  // by node
  const MemorySites& sites = table_.viscoelasticity.sites;
  for (const SurfaceDent& dent : dents) {
    if (static_cast<std::size_t>(dent.site) >= readers_.size()) {
      continue;  // of a file that somebody has written by hand
    }
    for (const std::int32_t node : readers_[static_cast<std::size_t>(dent.site)]) {
      double weight = sites.empty() ? 1.0 : 0.0;
      for (Eigen::Index k = 0; !sites.empty() && k < kMostNodeSites; ++k) {
        weight += sites.site(node, k) == dent.site
                      ? static_cast<double>(sites.weight(node, k))
                      : 0.0;
      }
      blend[node].carried_n += weight * dent.carried_n;
      blend[node].stays_m += weight * dent.stays_m;
    }
  }
  std::vector<NodeDent> all;
  for (const auto& [node, at] : blend) {
    const CurveView curve = table_.curve(node);
    if (!curve.depth_m.empty()) {
      const double depth_m =
          at.stays_m +
          (at.carried_n > 0.0 ? depth_of(curve, at.carried_n / stiffness_scale) : 0.0);
      if (depth_m > kShallow * table_.depth_max_m()) {
        all.push_back({node, depth_m});
      }
    }
  }
  return all;
}

}  // namespace palpate
