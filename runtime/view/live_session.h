// What a live view shows and steers: the runtime behind the pages, on simulated time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/recording/recording.h"
#include "runtime/fast/fast_step.h"
#include "runtime/hand/hand_tape.h"
#include "runtime/view/view_json.h"
#include "runtime/view/view_message.h"

namespace palpate {

/// Ticks that wait to be taken, at most: the latest.
constexpr std::size_t kTicksKept = 8191;

/// One thread. Time passes in advance() alone.
class LiveSession {
 public:
  virtual ~LiveSession() = default;

  /// What a page's hand wants: to hold its tool there, or to lift it off the body.
  /// @throws InputError for a hand that is not there, or a turn that nobody feels.
  virtual void heed(const HandWish& wish) = 0;

  /// All hands lift their tools.
  virtual void let_go() = 0;

  /// @throws InputError for a setting that this runtime does not have; then none is
  /// changed.
  virtual void set(const ViewRequest& request) = 0;

  /// Fast ticks pass, unless a fault has ended the run.
  virtual void advance(std::int64_t ticks) = 0;

  /// A new run: clear of the body, faults and accounts gone, settings kept.
  virtual void reset() = 0;

  [[nodiscard]] virtual bool holding() const = 0;   ///< some hand
  [[nodiscard]] virtual bool touching() const = 0;  ///< in the latest tick
  [[nodiscard]] virtual Fault fault() const = 0;
  [[nodiscard]] virtual std::int64_t ticks() const = 0;  ///< of this run
  [[nodiscard]] virtual double fast_hz() const = 0;      ///< [Hz]
  [[nodiscard]] virtual double slow_hz() const = 0;      ///< [Hz] at the moment
  [[nodiscard]] virtual const ResponseDatabase& database() const = 0;
  [[nodiscard]] virtual const ResponseTable& table() const = 0;  ///< of the first tool

  /// All that the session shows by itself, with what passed since the last frame.
  [[nodiscard]] virtual ViewFrame frame() = 0;

  /// All ticks since the last call, at most the kTicksKept latest.
  [[nodiscard]] virtual std::vector<TickRecord> take_ticks() = 0;
};

}  // namespace palpate
