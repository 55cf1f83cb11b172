#include "fitting/curve/segments.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kStill = 2e-3;    // [-] of the travel
constexpr double kTurn = 1e-2;     // [-] of the travel
constexpr double kShallow = 5e-2;  // [-] of the travel
constexpr std::size_t kStillMin = 5;
constexpr double kStillShare = 0.02;  // of the samples in motion

// First sample after `begin` that is farther than `reach` from it.
std::size_t still_until(std::span<const double> x, std::size_t begin, double reach) {
  std::size_t end = begin + 1;
  while (end < x.size() && std::abs(x[end] - x[begin]) <= reach) {
    ++end;
  }
  return end;
}

// The fewest samples in a row that are still, of so many.
std::size_t least_of(double samples) {
  return std::max(kStillMin, static_cast<std::size_t>(kStillShare * samples));
}

std::size_t still_samples(std::span<const double> x, double reach, std::size_t least) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < x.size();) {
    const std::size_t end = still_until(x, i, reach);
    sum += end - i < least ? 0 : end - i;
    i = end - i < least ? i + 1 : end;
  }
  return sum;
}

// Splits [begin, end) where the motion turns.
void append_moves(std::span<const double> x, std::size_t begin, std::size_t end,
                  double turn, std::vector<Segment>& segments) {
  if (begin >= end) {
    return;
  }
  // A turn counts where the motion has come back by `turn` from its last extreme; the
  // segment ends at that extreme. direction 0 means that no turn has been seen.
  const std::size_t before = begin > 0 ? begin - 1 : begin;
  std::size_t low = before, high = before, start = begin;
  int direction = 0;
  const auto append = [&](std::size_t until, int sign) {
    if (until > start) {
      segments.push_back(
          {sign >= 0 ? SegmentKind::kApproach : SegmentKind::kRetract, start, until});
      start = until;
    }
  };
  for (std::size_t i = begin; i < end; ++i) {
    low = x[i] < x[low] ? i : low;
    high = x[i] > x[high] ? i : high;
    if (direction >= 0 && x[i] < x[high] - turn) {
      append(std::max(high + 1, start), 1);
      direction = -1;
      low = i;
    } else if (direction <= 0 && x[i] > x[low] + turn) {
      append(std::max(low + 1, start), direction == 0 ? 1 : -1);
      direction = 1;
      high = i;
    }
  }
  const double net = x[end - 1] - x[start > 0 ? start - 1 : start];
  append(end, direction != 0 ? direction : net >= 0.0 ? 1 : -1);
}

void merge_equal_neighbours(std::vector<Segment>& segments) {
  std::vector<Segment> merged;
  for (const Segment& segment : segments) {
    if (!merged.empty() && merged.back().kind == segment.kind) {
      merged.back().end = segment.end;
    } else {
      merged.push_back(segment);
    }
  }
  segments = std::move(merged);
}

}  // namespace

std::string_view segment_name(SegmentKind kind) noexcept {
  switch (kind) {
    case SegmentKind::kDwell:
      return "dwell";
    case SegmentKind::kApproach:
      return "approach";
    case SegmentKind::kHold:
      return "hold";
    case SegmentKind::kRetract:
      return "retract";
  }
  return {};
}

std::vector<Segment> find_segments(std::span<const double> x) {
  std::vector<Segment> segments;
  if (x.empty()) {
    return segments;
  }
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const double shallowest = *low, travel = *high - *low;
  // The fewest samples of a hold are a share of those in motion. Those are known only
  // after a first count of what stands.
  const std::size_t still =
      still_samples(x, kStill * travel, least_of(static_cast<double>(x.size())));
  const std::size_t least = least_of(static_cast<double>(x.size() - still));
  std::size_t moving = 0;
  for (std::size_t i = 0; i < x.size();) {
    const std::size_t end = still_until(x, i, kStill * travel);
    if (end - i < least) {
      ++i;
      continue;
    }
    append_moves(x, moving, i, kTurn * travel, segments);
    segments.push_back({x[i] - shallowest <= kShallow * travel ? SegmentKind::kDwell
                                                               : SegmentKind::kHold,
                        i, end});
    i = moving = end;
  }
  append_moves(x, moving, x.size(), kTurn * travel, segments);
  merge_equal_neighbours(segments);
  return segments;
}

}  // namespace palpate
