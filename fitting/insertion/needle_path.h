// Path of a needle: its insertions and extractions, separated by direction of motion.
#pragma once

#include <cstddef>
#include <vector>

#include "fitting/curve/frame_compliance.h"
#include "formats/database/response_database.h"

namespace palpate {

enum class NeedleMotion { kLeftOut, kIn, kOut };

/// One insertion with the extraction that follows it.
struct NeedlePass {
  std::size_t in_begin = 0, in_end = 0;    ///< samples [begin, end) of the insertion
  std::size_t out_begin = 0, out_end = 0;  ///< of the extraction; equal: none
  double first_m = 0.0;                    ///< [m] depth where the insertion begins
  double turn_m = 0.0;                     ///< [m] largest depth
  double last_m = 0.0;                     ///< [m] least depth of the extraction
};

/// Samples of one or several files in a row, insertion depth and its force positive.
struct NeedlePath {
  std::vector<double> depth_m;       ///< (n) [m] as measured
  std::vector<double> force_n;       ///< (n) [N]
  std::vector<double> clock;         ///< (n) [-] 0 to 1 over each file
  std::vector<int> file;             ///< (n)
  std::vector<NeedleMotion> motion;  ///< (n) holds and backlash are left out
  std::vector<NeedlePass> pass;      ///< at least one
  int files = 0;
  std::size_t held = 0;  ///< samples left out
  bool timed = false;    ///< clock is time; else the number of the sample
  bool depth_turned = false, force_turned = false;
};

constexpr std::size_t kNeedleSamplesMin = 40;  ///< of an insertion
constexpr double kPassShareMin = 0.05;         ///< [-] of the travel

/// Approaches and retracts of find_segments() become insertions and extractions. A move
/// of less than kPassShareMin of the travel is backlash and is left out. What precedes
/// the first insertion of a file is left out.
/// @param files (1 or more) with the same origin of depth. Each file keeps its own
/// baseline. The sign of the depth is that of the larger excursion in the first file.
/// The sign of the force is that of the work of the first insertion.
/// @throws InputError for unequal counts, a value that is not finite, no travel, and a
/// file without an insertion of kNeedleSamplesMin samples.
/// @param frame whose deflection is taken off the depths, after motion was separated
/// by those that the machine reports; may be null.
[[nodiscard]] NeedlePath find_needle_path(const std::vector<Measurement>& files,
                                          const FrameCompliance* frame = nullptr);

}  // namespace palpate
