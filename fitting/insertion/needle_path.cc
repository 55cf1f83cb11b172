#include "fitting/insertion/needle_path.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include <fmt/format.h>

#include "fitting/curve/sample_clock.h"
#include "fitting/curve/segments.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

void check_file(const Measurement& m, std::size_t number) {
  const std::size_t n = m.depth_m.size();
  if (m.force_n.size() != n || (!m.time_s.empty() && m.time_s.size() != n) ||
      n < kNeedleSamplesMin) {
    throw InputError(fmt::format(
        "file {}: {} depths, {} forces and {} times: need as many of each "
        "and at least {}",
        number + 1, n, m.force_n.size(), m.time_s.size(), kNeedleSamplesMin));
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double time = m.time_s.empty() ? 0.0 : m.time_s[i];
    if (!std::isfinite(m.depth_m[i] + m.force_n[i] + time)) {
      throw InputError(
          fmt::format("file {}: sample {} is ({} m, {} N, {} s), must be "
                      "finite",
                      number + 1, i + 1, m.depth_m[i], m.force_n[i], time));
    }
  }
  if (!(extent(m.depth_m) > 0.0)) {
    throw InputError(fmt::format("file {}: the needle does not move", number + 1));
  }
}

double sign_of_insertion(const std::vector<double>& x) {
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  return x.front() - *low > *high - x.front() ? -1.0 : 1.0;
}

// Extends an insertion over a hold, begins a new one after an extraction.
void take_in(const Segment& s, std::size_t first, NeedlePath& path,
             std::size_t passes_before) {
  const bool goes_on = path.pass.size() > passes_before &&
                       path.pass.back().out_end == path.pass.back().out_begin;
  if (!goes_on) {
    path.pass.push_back({.in_begin = first + s.begin});
  }
  NeedlePass& pass = path.pass.back();
  pass.in_end = first + s.end;
  pass.out_begin = pass.out_end = pass.in_end;
  std::fill(path.motion.begin() + static_cast<std::ptrdiff_t>(first + s.begin),
            path.motion.begin() + static_cast<std::ptrdiff_t>(first + s.end),
            NeedleMotion::kIn);
}

void take_out(const Segment& s, std::size_t first, NeedlePath& path) {
  NeedlePass& pass = path.pass.back();
  if (pass.out_end == pass.out_begin) {
    pass.out_begin = first + s.begin;
  }
  pass.out_end = first + s.end;
  std::fill(path.motion.begin() + static_cast<std::ptrdiff_t>(first + s.begin),
            path.motion.begin() + static_cast<std::ptrdiff_t>(first + s.end),
            NeedleMotion::kOut);
}

void append_needle_file(const Measurement& m, double sign, NeedlePath& path) {
  const std::size_t first = path.depth_m.size(), passes = path.pass.size();
  std::vector<double> depth = m.depth_m;
  for (double& x : depth) {
    x *= sign;
  }
  const double least_move = kPassShareMin * extent(depth);
  const std::vector<double> clock = sample_clock(m.time_s, m.depth_m.size());
  path.depth_m.insert(path.depth_m.end(), depth.begin(), depth.end());
  path.force_n.insert(path.force_n.end(), m.force_n.begin(), m.force_n.end());
  path.clock.insert(path.clock.end(), clock.begin(), clock.end());
  path.file.resize(path.depth_m.size(), path.files);
  path.motion.resize(path.depth_m.size(), NeedleMotion::kLeftOut);
  for (const Segment& s : find_segments(depth)) {
    const auto [low, high] =
        std::minmax_element(depth.begin() + static_cast<std::ptrdiff_t>(s.begin),
                            depth.begin() + static_cast<std::ptrdiff_t>(s.end));
    if (!(*high - *low >= least_move)) {
      continue;
    }
    if (s.kind == SegmentKind::kApproach) {
      take_in(s, first, path, passes);
    } else if (s.kind == SegmentKind::kRetract && path.pass.size() > passes) {
      take_out(s, first, path);
    }
  }
  if (path.pass.size() == passes ||
      path.pass[passes].in_end - path.pass[passes].in_begin < kNeedleSamplesMin) {
    throw InputError(fmt::format("file {}: has no insertion of at least {} samples",
                                 path.files + 1, kNeedleSamplesMin));
  }
  ++path.files;
}

void measure_passes(NeedlePath& path) {
  const auto at = [&](std::size_t i) {
    return path.depth_m.begin() + static_cast<std::ptrdiff_t>(i);
  };
  for (NeedlePass& pass : path.pass) {
    pass.first_m = *std::min_element(at(pass.in_begin), at(pass.in_end));
    pass.turn_m =
        *std::max_element(at(pass.in_begin), at(std::max(pass.in_end, pass.out_end)));
    pass.last_m = pass.out_end > pass.out_begin
                      ? *std::min_element(at(pass.out_begin), at(pass.out_end))
                      : pass.turn_m;
  }
}

// Work of the first insertion over the force at its beginning.
double sign_of_force(const NeedlePath& path) {
  const NeedlePass& pass = path.pass.front();
  const auto forces = std::span(path.force_n).subspan(pass.in_begin, 8);
  const double before = median({forces.begin(), forces.end()});
  double work = 0.0;
  for (std::size_t i = pass.in_begin + 1; i < pass.in_end; ++i) {
    work += (path.force_n[i] - before) * (path.depth_m[i] - path.depth_m[i - 1]);
  }
  return work < 0.0 ? -1.0 : 1.0;
}

// Deflections are of the force above that at the beginning of each file's insertion.
void take_off_frame(const FrameCompliance& frame, NeedlePath& path) {
  double before = 0.0;
  int file = -1;
  for (const NeedlePass& pass : path.pass) {
    if (path.file[pass.in_begin] == file) {
      continue;
    }
    file = path.file[pass.in_begin];
    const auto forces = std::span(path.force_n).subspan(pass.in_begin, 8);
    before = median({forces.begin(), forces.end()});
    for (std::size_t i = 0; i < path.depth_m.size(); ++i) {
      path.depth_m[i] -=
          path.file[i] == file ? deflection_m(frame, path.force_n[i] - before) : 0.0;
    }
  }
}

}  // namespace

NeedlePath find_needle_path(const std::vector<Measurement>& files,
                            const FrameCompliance* frame) {
  if (files.empty()) {
    throw InputError("no measurement of an insertion");
  }
  NeedlePath path;
  path.timed = std::all_of(files.begin(), files.end(), [](const Measurement& m) {
    return !m.time_s.empty();
  });
  check_file(files.front(), 0);
  const double sign = sign_of_insertion(files.front().depth_m);
  path.depth_turned = sign < 0.0;
  for (std::size_t k = 0; k < files.size(); ++k) {
    check_file(files[k], k);
    append_needle_file(files[k], sign, path);
  }
  if (sign_of_force(path) < 0.0) {
    path.force_turned = true;
    std::transform(path.force_n.begin(), path.force_n.end(), path.force_n.begin(),
                   std::negate<>());
  }
  if (frame != nullptr) {
    take_off_frame(*frame, path);
  }
  measure_passes(path);
  path.held = static_cast<std::size_t>(
      std::count(path.motion.begin(), path.motion.end(), NeedleMotion::kLeftOut));
  return path;
}

}  // namespace palpate
