// A flat body that a scripted device presses: what the tests of the render loop share.
#pragma once

#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/render/render_loop.h"
#include "runtime/slow/memory_elements.h"
#include "tests/support/fake_clock.h"
#include "tests/support/fake_device.h"
#include "tests/support/sample_bodies.h"

namespace palpate {

inline constexpr double kRadius = 0.005;
inline constexpr double kDepthMax = 0.01;

// A quadratic wall, the same at every node.
inline double wall(Eigen::Index /*node*/, double d) {
  return 2e4 * d * d;
}

// Along the normal, from 2 mm above the plate down by depth_m and back in period_s.
inline FakeDevice::Script press(double depth_m, double period_s) {
  return [=](double t) -> Eigen::Vector3d {
    const double turn = 2.0 * std::numbers::pi;
    const double depth = depth_m * 0.5 * (1.0 - std::cos(turn * t / period_s)) - 0.002;
    return {0.0031, 0.0017, kRadius - depth};
  };
}

inline RenderConfig config(LocalModel model) {
  RenderConfig c;
  c.fast.fast.model = model;
  c.fast.fast.tool_radius_m = kRadius;
  c.duration_s = 2.0;
  return c;
}

class PressedPlate : public testing::Test {
 protected:
  RenderReport render(FakeDevice& device, const RenderConfig& c) {
    ElementStream stream(database_, database_.tools[0]);
    trace_.reserve(10'000);
    return render_in_turns(
        c, {.device = device, .stream = &stream, .stop = stop_, .trace = &trace_},
        clock_);
  }

  ResponseDatabase database_ =
      sample_database(plate(0.1, 10), ball(kRadius, 0.3, 5e-4), wall, kDepthMax, 41);
  FakeClock clock_{1'000'000};
  std::atomic<bool> stop_ = false;
  std::vector<RenderTick> trace_;
};

}  // namespace palpate
