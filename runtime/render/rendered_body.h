// What a fast and a slow process render together: a seam, because a tool may touch its
// body at one place or at several.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "formats/recording/kept_surface.h"
#include "formats/recording/tick_record.h"
#include "runtime/account/safety.h"
#include "runtime/contacts/coupled_step.h"
#include "runtime/device/device.h"
#include "runtime/render/contacts_seen.h"
#include "runtime/render/friction_seen.h"
#include "runtime/render/needle_seen.h"
#include "runtime/render/render_report.h"
#include "runtime/render/surface_dents.h"

namespace palpate {

/// What the hands' devices measured, by hand.
using HandReadings = std::array<DeviceReading, kPortsMax>;

/// The fast thread calls what is noexcept, once it has begun; none of that allocates or
/// waits. The slow thread calls serve().
class RenderedBody {
 public:
  RenderedBody() = default;
  virtual ~RenderedBody() = default;
  RenderedBody(const RenderedBody&) = delete;
  RenderedBody& operator=(const RenderedBody&) = delete;

  /// Of the devices that hold its tools, [1, kPortsMax].
  [[nodiscard]] virtual std::size_t hands() const noexcept { return 1; }
  /// Whether turning the tools changes what they touch.
  [[nodiscard]] virtual bool turns() const noexcept { return false; }
  /// Whether who turns the tools feels their torques, so that turning them is work.
  [[nodiscard]] virtual bool torque_felt() const noexcept { return false; }
  /// From the next tick on, of tools that turn and that no coupling holds.
  virtual void feel_torque(bool felt) noexcept { static_cast<void>(felt); }

  /// Takes in the next element that has arrived, and says which. False: there is none.
  virtual bool take_in(ArrivalRecord& arrival) noexcept = 0;
  /// One tick at the readings. @param dt_s [s] since the last one, [0, 1].
  virtual WrenchCommand step(const HandReadings& reading, double dt_s) noexcept = 0;
  /// What the devices made of the latest wrenches.
  virtual void delivered(const PortWrenches& made) noexcept = 0;
  virtual void raise(Fault fault) noexcept = 0;
  /// Says where the tools are, for serve(). @param ticks that are done; 0: before the
  /// first.
  virtual void publish(const HandReadings& reading, std::int64_t ticks) noexcept = 0;

  /// Forgets fault, account, places and what relaxes. Not in a tick.
  virtual void restart() noexcept = 0;

  /// The contact that carries most, as the latest step left it.
  [[nodiscard]] virtual FastContact contact() const noexcept = 0;
  /// All contacts, whether they touch or not, as the latest step left them: not in a
  /// tick. @param i [0, contacts())
  [[nodiscard]] virtual int contacts() const noexcept { return 1; }
  [[nodiscard]] virtual BodyContact contact_at(int i) const noexcept = 0;
  /// Of a tool that punctures, as the latest step left it: not in a tick.
  [[nodiscard]] virtual NeedleSeen needle() const noexcept { return {}; }
  /// Of a tool that touches at one place, likewise.
  [[nodiscard]] virtual FrictionSeen friction() const noexcept { return {}; }
  [[nodiscard]] virtual Fault fault() const noexcept = 0;  ///< latched
  [[nodiscard]] virtual bool in_contact() const noexcept = 0;
  [[nodiscard]] virtual double work_j() const noexcept = 0;  ///< [J] by the ledger
  [[nodiscard]] virtual std::int32_t triangle() const noexcept = 0;  ///< -1: none
  [[nodiscard]] virtual std::uint64_t dropped() const noexcept = 0;  ///< elements
  /// What of the account is this body's alone.
  virtual void account(const WrenchCommand& command,
                       RenderReport& report) const noexcept {
    static_cast<void>(command);
    static_cast<void>(report);
  }

  /// The element that a recording says arrived, as if it had come by take_in(); not in
  /// a tick. @throws FormatError for one that the body does not have.
  virtual void accept(const ArrivalRecord& arrival) = 0;
  /// One turn of the slow process. @returns elements that it sent; none where the fast
  /// one had not said anything new.
  virtual std::optional<std::size_t> serve(std::int64_t now_ns) = 0;

  /// Begins with what had stayed; before the first tick. @throws as begin_kept().
  virtual void begin_with(const KeptSurface& kept) = 0;
  /// What stays for good, and memory sites that have not recovered yet. Not in a tick.
  [[nodiscard]] virtual KeptSurface kept() const { return {}; }
  [[nodiscard]] virtual std::vector<SurfaceDent> dents() const { return {}; }
};

/// @throws FormatError naming an element of a recording that a body does not have.
[[noreturn]] void throw_no_element(const ArrivalRecord& arrival);

}  // namespace palpate
