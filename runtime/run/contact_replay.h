// What a run of several contacts was, as a recording; and the same poses rendered
// again.
#pragma once

#include <cstdint>
#include <string>

#include "formats/database/response_database.h"
#include "formats/recording/contact_recording.h"
#include "runtime/run/contact_run.h"

namespace palpate {

/// Of a run that kept its ticks. @param database, sha256 as in the recording.
[[nodiscard]] ContactRecording contact_recording(const ContactRunReport& run,
                                                 const std::string& database,
                                                 const std::string& sha256);

struct ContactReplayReport {
  std::int64_t ticks = 0;
  std::int64_t identical = 0;        ///< in every wrench and energy, to the bit
  std::int64_t different_tick = -1;  ///< the first; -1: none
  double force_difference_n = 0.0;   ///< [N] largest, of any hand
  double torque_difference_n_m = 0.0;
  double net_energy_j = 0.0;  ///< [J] work at the end, as recorded ...
  double replayed_net_j = 0.0;
  Fault fault = Fault::kNone;

  [[nodiscard]] bool is_reproduced() const { return ticks > 0 && identical == ticks; }
};

/// Renders the recorded poses with the recorded rates, limits and scale.
/// @throws InputError as simulate_contacts(), and for a recording without ticks.
[[nodiscard]] ContactReplayReport replay_contacts(const ContactRecording& recording,
                                                  const ResponseDatabase& database);

[[nodiscard]] std::string summary(const ContactReplayReport& report);
[[nodiscard]] std::string to_json(const ContactReplayReport& report);

}  // namespace palpate
