// A host that presses a soft plate through palpate.h.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "formats/database/response_database.h"
#include "runtime/c_api/palpate.h"
#include "tests/support/pause_between_ticks.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {

inline constexpr double kRadius = 0.005;
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// f = 2e4 d^2: 0.18 N at 3 mm, slope 120 N/m there.
inline double wall(Eigen::Index /*node*/, double d) {
  return 2e4 * d * d;
}

struct Answer {
  int status = 0;
  std::array<double, 3> force{};
};

class PressedPlateHost : public testing::Test {
 protected:
  void SetUp() override {
    write_database(file_, sample_database(plate(0.1, 10), ball(kRadius, 0.3, 5e-4),
                                          wall, 0.01, 41));
  }
  void TearDown() override { palpate_close(body_); }

  // All defaults but the slow thread.
  static palpate_options options() {
    palpate_options all{};
    all.struct_size = sizeof all;
    all.flags = PALPATE_OWN_SLOW_STEPS;
    return all;
  }
  palpate_tool* open(const palpate_options& options) {
    palpate_close(body_);
    body_ = palpate_open(file_.c_str(), &options, error_, sizeof error_);
    return body_ == nullptr ? nullptr : palpate_tool_add(body_);
  }
  static Answer force(palpate_tool* tool, double depth_m, double dt_s = 0.001) {
    const double at[3] = {0.0031, 0.0017, kRadius - depth_m};
    Answer answer;
    answer.status = palpate_force(tool, at, nullptr, dt_s, answer.force.data());
    return answer;
  }
  // From 1 mm above down to depth_m in 0.4 s, then half a second of rest.
  Answer press(palpate_tool* tool, double depth_m) {
    Answer answer;
    for (int tick = 0; tick < 900; ++tick) {
      const double part = std::min(1.0, tick / 400.0);
      answer = force(tool, -0.001 + part * (depth_m + 0.001));
      if (tick % 10 == 0) {
        EXPECT_GE(palpate_slow_step(body_), 0);
      }
    }
    return answer;
  }

  ScratchFolder folder_;
  std::string file_ = (folder_ / "plate.h5").string();
  palpate_body* body_ = nullptr;
  char error_[256] = {};
};

}  // namespace palpate
