// A page's own device: an Inverse3, Inverse3x or Minverse through Haply's Inverse
// service. The page's browser carries the messages (page/device_worker.js).
//
// One fast tick is one exchange: a state comes, its position is rendered, and the force
// leaves as the next command. So a force begins to act one exchange after its position
// was measured, and acts for one exchange. Exchanges are timed while the motors are
// tested, and bound the stiffness.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "runtime/attach/placed_device.h"
#include "runtime/attach/sign_test.h"
#include "runtime/device/stability_margin.h"
#include "runtime/inverse/inverse_session.h"
#include "runtime/view/view_device.h"
#include "runtime/view/view_session.h"

namespace palpate {

/// When a message came [ns], by a clock that does not go back.
struct HeardAt {
  std::int64_t now_ns = 0;
  std::int64_t received_ns = 0;  ///< by who carries messages; at most now_ns
  bool withheld =
      false;          ///< it has put the force to zero before, for want of a command
  bool asked = true;  ///< a command was on its way
};

/// Presses with tools of one contact, by passive models. Before the first force its
/// motors are tested (sign_test.h). The test also finds a service that spells forces
/// as before version 3.5.
///
/// The force is zero after a state that does not come within InverseConfig::answer_s.
/// The device is let go of where InverseSession gives up, after a fault of the runtime,
/// and when the page says so. Then active() ends.
class PageDevice : public ViewDevice {
 public:
  /// Of a session that outlives it.
  PageDevice(ViewSession& session, InverseConfig config);

  void ask(const ViewRequest& request) override;
  [[nodiscard]] bool active() const override { return phase_ != Phase::kOff; }
  void let_go(std::string_view why) override;
  void set(const ViewRequest& request) override;
  void watch(std::int64_t now_ns) override;
  [[nodiscard]] ViewDeviceShown shown() const override;

  /// A message of states, the first of which is that of devices; one of events.
  void hear(std::string_view text, const HeardAt& at);
  void hear_event(std::string_view text);

  /// What is to be sent now, once; empty: nothing. The last one of a connection comes
  /// when active() has ended.
  [[nodiscard]] std::string take_command();

 private:
  enum class Phase : std::uint8_t { kOff, kConnecting, kTesting, kOn };
  class Fed;

  void greet(std::string_view text, std::int64_t now_ns);
  void go_on(const HeardAt& at);
  void test(const std::optional<Eigen::Vector3d>& position_m,
            const Eigen::Vector3d& acted_n, std::int64_t now_ns);
  void begin(std::int64_t now_ns);
  void tick(const HeardAt& at);
  [[nodiscard]] Eigen::Vector3d made_n(const HeardAt& at) const;
  void send(const Eigen::Vector3d& force_n, std::int64_t now_ns,
            std::string_view profile = {});
  void place(const ViewRequest& request);
  [[nodiscard]] bool soften(const DeviceLimits& limits);
  [[nodiscard]] std::string refusal(double stiffness_scale,
                                    const DeviceLimits& limits) const;
  [[nodiscard]] DeviceLimits measured() const;
  [[nodiscard]] WireLimits wire(double stiffness_scale) const;

  ViewSession& session_;
  InverseConfig config_;
  std::optional<InverseSession> service_;
  std::optional<SignTest> test_;
  std::unique_ptr<PlacedDevice> placed_;
  Fed* fed_ = nullptr;            // in placed_
  RenderedStiffness stiffness_;   // unscaled
  std::optional<double> before_;  // stiffness scale that was there before a limit
  bool limit_ = false;            // stiffness
  bool respelled_ = false;        // the other spelling is tried
  Phase phase_ = Phase::kOff;
  std::int64_t asked_ns_ = -1;  // -1: not seen by watch() yet
  std::int64_t sent_ns_ = 0;
  std::optional<HeardAt> late_;  // the latest state after commands without an answer
  // Of exchanges while the motors are tested.
  std::int64_t heard_ns_ = 0;
  struct Exchanges {
    int count = 0;
    double sum_s = 0.0;
    double squares_s2 = 0.0;
  } exchanges_;
  std::string detail_;
  std::string told_;  // what alters what is felt
  std::string command_;
};

}  // namespace palpate
