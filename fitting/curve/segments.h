// What a machine did, from the displacement alone: presses, holds, releases.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace palpate {

enum class SegmentKind {
  kDwell,     ///< still, in the shallowest 5 % of the travel
  kApproach,  ///< displacement rises
  kHold,      ///< still, deeper
  kRetract,   ///< displacement falls
};

[[nodiscard]] std::string_view segment_name(SegmentKind kind) noexcept;

struct Segment {
  SegmentKind kind = SegmentKind::kApproach;
  std::size_t begin = 0, end = 0;  ///< samples [begin, end)
};

/// Segments of all samples in order, any number. A stretch is still where it stays
/// within 0.2 % of the travel for enough samples. Enough are at least 5, and at least
/// 2 % of the samples in motion. In motion are samples that are not in a still stretch
/// of 2 % of all samples. The motion turns where it goes back by more than 1 % of the
/// travel. Compression is positive.
[[nodiscard]] std::vector<Segment> find_segments(
    std::span<const double> displacement_m);

}  // namespace palpate
