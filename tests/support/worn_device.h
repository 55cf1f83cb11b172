// A page's own device against an emulated service, in simulated time: what the page's
// workers carry takes as long as here is said.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "runtime/attach/placed_device.h"
#include "runtime/hand/press_site.h"
#include "runtime/inverse/inverse_emulation.h"
#include "runtime/view/page_body.h"
#include "tests/support/sample_bodies.h"

namespace palpate {

inline constexpr std::int64_t kDrawNs = 16'666'667;
inline constexpr std::int64_t kLookNs =
    5'000'000;                    // of the page's workers for what is missing
inline constexpr int kNode = 60;  // the middle of the plate

inline constexpr double kTestedS = 3.0;  // the motors

inline ResponseDatabase plate_of(double n_per_m, double friction = 0.05) {
  return sample_database(
      plate(0.1, 10), ball(0.005, friction, 5e-4),
      [=](Eigen::Index, double d) {
        return n_per_m * d;
      },
      0.01);
}

// The hand that presses the node, as the device lies over it.
inline HandScript hand_over(const ResponseDatabase& database) {
  const HandScript script =
      script_at(database, database.tools[0], kNode, 5.0, 1.0, 300.0);
  return in_device_frame(
      script, placement_over(script, inverse_rest_m(), Eigen::Vector3d::UnitX()));
}

/// A page with its workers, a service and the hand on its device, in simulated time.
class Worn {
 public:
  explicit Worn(const ResponseDatabase& database, EmulatedInverseConfig wanted = {})
      : page(database, "plate.h5", {}),
        service_(with_hand(wanted, database), clock_, [this](const std::string& event) {
          page.device().hear_event(event);
        }) {}

  std::int64_t way_ns = 350'000;  // of a message
  bool page_speaks = true;
  double leap_m = 0.0;  // of what the positions say
  PageBody page;

  void ask(bool limit = false) {
    page.receive(fmt::format(
        R"({{"type":"device","do":"on","node":{},"right":[1,0,0],"limit":{}}})", kNode,
        limit));
    look();
  }
  void say(const std::string& message) {
    page.receive(message);
    look();
  }

  // Time passes; the page draws sixty frames a second.
  void pass(double seconds) {
    const std::int64_t until_ns = clock_.now_ns() + nanoseconds_in(seconds);
    while (clock_.now_ns() < until_ns) {
      clock_.sleep_until_ns(std::min({until_ns, arrives_ns_, frame_ns_, look_ns_}));
      const std::int64_t now_ns = clock_.now_ns();
      if (now_ns >= arrives_ns_) {
        arrive(now_ns);
      }
      if (now_ns >= look_ns_) {
        look_ns_ = now_ns + kLookNs;
        page.device().watch(now_ns);
      }
      if (now_ns >= frame_ns_) {
        frame_ns_ = now_ns + kDrawNs;
        if (page_speaks && page.device().active()) {
          page.receive(R"({"type":"device","do":"keep"})");
        }
        page.frame(now_ns);
        take();
      }
      if (service_.idle_due_ns() <= now_ns) {
        service_.release();
      }
      look();
    }
  }

  // The runtime stands still. Its worker puts the force to zero meanwhile, and the
  // command that comes then is for a place long left.
  void stand_still(double seconds) {
    service_.release();
    clock_.sleep_until_ns(clock_.now_ns() + nanoseconds_in(seconds));
    late_ = true;
  }

  [[nodiscard]] const nlohmann::json& state() const { return state_; }
  [[nodiscard]] std::string phase() const { return state_["device"]["phase"]; }
  [[nodiscard]] std::string detail() const { return state_["device"]["detail"]; }
  [[nodiscard]] const std::string& refused() const { return refused_; }
  [[nodiscard]] const InverseEmulation& service() const { return service_; }
  /// [N] on the tool, in the device's axes: with the latest frame, and most of them.
  [[nodiscard]] const Eigen::Vector3d& acting_n() const { return acting_n_; }
  [[nodiscard]] double most_n() const { return most_n_; }

 private:
  static EmulatedInverseConfig with_hand(EmulatedInverseConfig config,
                                         const ResponseDatabase& database) {
    const double still_s = std::max(kTestedS, config.hand.still_s);
    config.hand = hand_over(database);
    config.hand.still_s = still_s;
    config.dynamics.resolution_m = 5e-5;
    return config;
  }

  // As the workers follow the runtime.
  void look() {
    const std::string command = page.device().take_command();
    if (!command.empty() && connected_) {
      leaves_ = late_ ? zero_of(command) : command;
      withheld_ = std::exchange(late_, false);
      arrives_ns_ = clock_.now_ns() + way_ns;
    }
    if (page.device().active() && !connected_) {
      connected_ = true;
      comes_ = service_.first_message();
      arrives_ns_ = clock_.now_ns() + way_ns;
    } else if (!page.device().active() && connected_ && leaves_.empty()) {
      connected_ = false;
      comes_.clear();
      service_.release();
    }
  }

  static std::string zero_of(const std::string& command) {
    nlohmann::json zero = parse_json(command);
    zero["inverse3"][0]["commands"]["set_cursor_force"]["vector"] = {
        {"x", 0.0}, {"y", 0.0}, {"z", 0.0}};
    return zero.dump();
  }

  void arrive(std::int64_t now_ns) {
    const std::int64_t received_ns = arrives_ns_;
    arrives_ns_ = std::numeric_limits<std::int64_t>::max();
    if (!leaves_.empty()) {
      service_.obey(std::exchange(leaves_, {}));
      if (!service_.is_faulty(InverseFault::kMissing)) {
        comes_ = faulty_answer();
        arrives_ns_ = now_ns + way_ns;
      }
    } else if (!comes_.empty()) {
      bool asked = true;
      for (int i = service_.is_faulty(InverseFault::kUnasked) ? 100 : 1; i > 0; --i) {
        page.device().hear(comes_, {.now_ns = now_ns,
                                    .received_ns = received_ns,
                                    .withheld = std::exchange(withheld_, false),
                                    .asked = asked});
        asked = false;
      }
    }
  }

  std::string faulty_answer() {
    if (leap_m == 0.0) {
      return service_.answer();
    }
    nlohmann::json answer = parse_json(service_.answer());
    nlohmann::json& x = answer["inverse3"][0]["state"]["cursor_position"]["x"];
    x = x.get<double>() + leap_m;
    return answer.dump();
  }

  void take() {
    while (const std::optional<std::string> text = page.take()) {
      nlohmann::json message = parse_json(*text);
      if (message["type"] == "state") {
        state_ = std::move(message);
        acting_n_ = service_.tool().acting_force_n();
        most_n_ = std::max(most_n_, acting_n_.norm());
      } else if (message["type"] == "refused") {
        refused_ = message["why"];
      }
    }
  }

  SimulatedClock clock_;
  InverseEmulation service_;
  bool connected_ = false;
  bool late_ = false;
  bool withheld_ = false;
  std::string leaves_;
  std::string comes_;
  std::int64_t arrives_ns_ = std::numeric_limits<std::int64_t>::max();
  std::int64_t frame_ns_ = 0;
  std::int64_t look_ns_ = 0;
  nlohmann::json state_;
  std::string refused_;
  Eigen::Vector3d acting_n_ = Eigen::Vector3d::Zero();
  double most_n_ = 0.0;
};

}  // namespace palpate
