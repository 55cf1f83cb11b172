// Renders a recorded trajectory again: to the same bits, or with another local model or
// another body to see what differs.
#pragma once

#include <cstdint>
#include <string>

#include "formats/database/response_database.h"
#include "formats/recording/recording.h"
#include "runtime/account/local_model.h"
#include "runtime/run/recorded_setup.h"

namespace palpate {

struct ReplayReport {
  LocalModel model = LocalModel::kElement;
  std::int64_t ticks = 0;      ///< in the recording
  std::int64_t compared = 0;   ///< rendered again, up to the first gap
  std::int64_t identical = 0;  ///< of them, before the first that differs
  /// Of the first tick that differs: which, when [s] and in what; "" if none does.
  std::int64_t different_tick = -1;
  double different_s = 0.0;
  std::string different_in;
  std::int64_t gap_tick = -1;  ///< first tick that the recording lacks; -1: none
  bool from_start = true;      ///< false: it begins later, as a flight log may

  double force_rms_n = 0.0;         ///< [N] of the difference, over all ticks compared
  double force_difference_n = 0.0;  ///< [N] the largest
  double force_difference_s = 0.0;  ///< [s] where, from the start
  double torque_difference_n_m = 0.0;  ///< [N m] the largest, of several contacts
  double force_max_n = 0.0;            ///< [N] recorded
  double replayed_max_n = 0.0;         ///< [N]
  double net_energy_j = 0.0;           ///< [J] work of the tool on the recorded forces
  double replayed_net_j = 0.0;         ///< [J] the same of the forces rendered again
  double dissipated_j = 0.0;           ///< [J] recorded, at the end
  double replayed_dissipated_j = 0.0;
  Fault fault = Fault::kNone;  ///< of the replay

  /// Every tick of the recording was rendered again, to the same bits.
  [[nodiscard]] bool is_reproduced() const noexcept {
    return from_start && gap_tick < 0 && identical == ticks;
  }
};

/// The recorded run again: the same elements of `database` before the same ticks, the
/// same samples and steps of time. Bits are compared of force, energies, shift, depth,
/// triangle, contact and fault. @throws InputError if the database has not the tool,
/// FormatError for a triangle that it does not have.
[[nodiscard]] ReplayReport replay(const Recording& recording,
                                  const ResponseDatabase& database);

/// The recorded trajectory with another local model or another database. The slow
/// process answers anew at the ticks before which elements arrived in the recording.
/// The slow process takes the tool's place from the tick before.
[[nodiscard]] ReplayReport render_again(const Recording& recording,
                                        const ResponseDatabase& database,
                                        LocalModel model);

/// @throws InputError if the recording is of another database, saying which.
void check_same_database(const Recording& recording, const std::string& sha256,
                         const std::string& database);

/// The report for people. @param exact with the verdict of replay().
[[nodiscard]] std::string summary(const ReplayReport& report, bool exact);

}  // namespace palpate
