// What the fast process tells of a tick, for recordings and for who looks on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate {

/// Bits of TickRecord::flags.
enum class TickFlag : std::uint8_t {
  kContact = 1,       ///< the body acts on the tool
  kStarved = 2,       ///< the contact point left the elements that had arrived
  kExtrapolated = 4,  ///< deeper than a curve was computed
  kLateRead = 8,      ///< the device had no answer in time
  kSkipped = 16,      ///< deadlines passed without a tick before this one
};

/// A hand's pose in a tick, and what the device had for it. Orientations are unit
/// quaternions x y z w from the tool's frame to the body's.
struct RecordedHand {
  std::array<double, 3> position_m{};  ///< [m] tool reference point, as measured
  std::array<double, 4> turn{0.0, 0.0, 0.0, 1.0};
  std::array<double, 3> force_n{};     ///< [N] commanded
  std::array<double, 3> torque_n_m{};  ///< [N m] about the reference point
};

/// One tick of the fast process, as it went to the device. Faults are numbers of the
/// runtime's Fault; 0 none.
struct TickRecord {
  std::int64_t tick = 0;               ///< counts from 0; a gap: records were dropped
  std::int64_t time_ns = 0;            ///< [ns] of the sample, monotonic clock
  std::int64_t arrivals = 0;           ///< elements taken in since the start
  std::array<double, 3> position_m{};  ///< [m] tool reference point, as measured
  std::array<double, 3> force_n{};     ///< [N] commanded
  double depth_m = 0.0;                ///< [m] along the response direction
  double work_j = 0.0;                 ///< [J] put into the local model since the start
  double stored_j = 0.0;               ///< [J] potential of the local model
  double tank_j = 0.0;                 ///< [J]
  double dissipated_j = 0.0;           ///< [J] since the start
  double rest_offset_m = 0.0;          ///< [m] delta_0 that the ledger had to take
  std::int32_t triangle = -1;          ///< that holds the contact point; -1 none
  std::uint8_t flags = 0;              ///< TickFlag bits
  std::uint8_t raised = 0;             ///< fault found outside the step, before it
  std::uint8_t fault = 0;              ///< latched, after the step
  // Where the header says so (RecordingHeader::poses); of the first hand ...
  std::array<double, 4> turn{0.0, 0.0, 0.0, 1.0};
  std::array<double, 3> torque_n_m{};
  std::int32_t contacts = 0;  ///< that carry something
  RecordedHand second = {};   ///< ... and of the second, where there is one
};

/// A hand's part of a tick. @param hand 0 or 1
[[nodiscard]] inline RecordedHand hand_in(const TickRecord& tick, std::size_t hand) {
  return hand == 0 ? RecordedHand{.position_m = tick.position_m,
                                  .turn = tick.turn,
                                  .force_n = tick.force_n,
                                  .torque_n_m = tick.torque_n_m}
                   : tick.second;
}

/// A surface element that the fast process took in before the step of a tick. Its
/// content is the database's.
struct ArrivalRecord {
  std::int64_t tick = 0;
  std::int64_t sequence = 0;  ///< counts what the slow process sent, from 1
  std::int64_t sent_ns = 0;   ///< [ns] monotonic clock
  std::int32_t triangle = -1;
  std::uint8_t active = 0;   ///< nearest to the tool when sent
  std::int32_t contact = 0;  ///< of the tool's that it is for
};

}  // namespace palpate
