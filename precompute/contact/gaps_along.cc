#include "precompute/contact/gaps_along.h"

#include "precompute/contact/contact_gap.h"

namespace palpate {
namespace {

// Beyond what a press can close, as a share of its largest depth.
constexpr double kOpen = 2.0;

// Where the body's surface and the tool's do not face each other, as on the far side of
// an edge that the tool has passed, the tool would have to pull the body out along its
// normal: no press closes that gap. Linear contact, which moves points along normals
// alone, would close it, and a thin lobe push back almost twice as hard as it can.
Gap facing_gap(const ContactNode& node, const PlacedTool& tool, double depth_max_m) {
  const Gap gap = average_gap(node, tool);
  return gap.by_tool.dot(node.normal) < 0.0 ? Gap{.distance_m = kOpen * depth_max_m,
                                                  .by_tool = Eigen::Vector3d::Zero()}
                                            : gap;
}

}  // namespace

Gaps gaps_at(const ContactSurface& surface, std::span<const std::int32_t> patch,
             const IndentationPath& path, double penetration_m) {
  const PlacedTool tool = tool_at(path, penetration_m);
  const auto n = static_cast<Eigen::Index>(patch.size());
  Gaps gaps{Eigen::VectorXd(n), Eigen::MatrixX3d(n, 3)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const Gap gap = facing_gap(node_of(surface, patch[static_cast<std::size_t>(i)]),
                               tool, path.depth_max_m);
    gaps.distance_m[i] = gap.distance_m;
    gaps.by_centre.row(i) = gap.by_tool.transpose();
  }
  return gaps;
}

GapsAlong::GapsAlong(const ContactSurface& surface, std::span<const std::int32_t> patch,
                     const IndentationPath& path, double first_m)
    : surface_(surface),
      patch_(patch),
      path_(path),
      last_(gaps_at(surface, patch, path, path.depth_max_m)),
      closing_(last_.by_centre * path.outward) {
  constexpr double kSameSlope = 1e-12;
  const Gaps first = gaps_at(surface, patch, path, first_m);
  for (Eigen::Index i = 0; i < closing_.size(); ++i) {
    if (!((first.by_centre.row(i) - last_.by_centre.row(i)).norm() < kSameSlope)) {
      bent_.push_back(i);
    }
  }
}

Gaps GapsAlong::at(double penetration_m) const {
  Gaps gaps = last_;
  gaps.distance_m += (path_.depth_max_m - penetration_m) * closing_;
  const PlacedTool tool = tool_at(path_, penetration_m);
  for (const Eigen::Index i : bent_) {
    const Gap gap = facing_gap(node_of(surface_, patch_[static_cast<std::size_t>(i)]),
                               tool, path_.depth_max_m);
    gaps.distance_m[i] = gap.distance_m;
    gaps.by_centre.row(i) = gap.by_tool.transpose();
  }
  return gaps;
}

}  // namespace palpate
