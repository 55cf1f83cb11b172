#include "formats/response/response_rules.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

NodeResponse sound() {
  return {.direction = Eigen::Vector3d(0.6, 0.0, 0.8),
          .direction_spread_rad = 0.1,
          .touch_offset_m = -0.001,
          .depth_m = {0.0, 0.001, 0.003},
          .force_n = {0.0, 0.0, 0.2},
          .sample_direction = {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ(),
                               Eigen::Vector3d::UnitX()},
          .error_relative = 0.0,
          .origin = ResponseOrigin::kSimulated,
          .flags = 0};
}

TEST(ResponseRules, ASoundResponseBreaksNone) {
  EXPECT_EQ(broken_rule(sound()), "");
  NodeResponse one_direction = sound();
  one_direction.sample_direction.clear();
  EXPECT_EQ(broken_rule(one_direction), "");
  EXPECT_EQ(broken_rule(NodeResponse{}), "");  // none was computed
}

struct Break {
  const char* said;
  std::function<void(NodeResponse&)> make;
};

TEST(ResponseRules, EachIsSaidWithTheValueThatBreaksIt) {
  const Break breaks[] = {
      {"direction has length nan",
       [](auto& r) {
         r.direction[0] = kNaN;
       }},
      {"direction has length 0",
       [](auto& r) {
         r.direction.setZero();
       }},
      {"direction has length 1.00001",
       [](auto& r) {
         r.direction *= 1.00001;
       }},
      {"turns by nan rad",
       [](auto& r) {
         r.direction_spread_rad = kNaN;
       }},
      {"turns by -0.1 rad",
       [](auto& r) {
         r.direction_spread_rad = -0.1;
       }},
      {"turns by 4 rad",
       [](auto& r) {
         r.direction_spread_rad = 4.0;
       }},
      {"touch offset is nan",
       [](auto& r) {
         r.touch_offset_m = kNaN;
       }},
      {"touch offset is inf",
       [](auto& r) {
         r.touch_offset_m = kInfinity;
       }},
      {"error is nan",
       [](auto& r) {
         r.error_relative = kNaN;
       }},
      {"error is inf",
       [](auto& r) {
         r.error_relative = kInfinity;
       }},
      {"error is -0.1",
       [](auto& r) {
         r.error_relative = -0.1;
       }},
      {"1 depths and 3 forces",
       [](auto& r) {
         r.depth_m.resize(1);
       }},
      {"3 depths and 2 forces",
       [](auto& r) {
         r.force_n.pop_back();
       }},
      {"begins at 0.0001 m",
       [](auto& r) {
         r.depth_m[0] = 0.0001;
       }},
      {"and 0.5 N",
       [](auto& r) {
         r.force_n[0] = 0.5;
       }},
      {"depth at sample 2 is 0.001 m after 0.001",
       [](auto& r) {
         r.depth_m[2] = 0.001;
       }},
      {"depth at sample 1 is nan",
       [](auto& r) {
         r.depth_m[1] = kNaN;
       }},
      {"depth at sample 2 is inf",
       [](auto& r) {
         r.depth_m[2] = kInfinity;
       }},
      {"force at sample 2 is nan",
       [](auto& r) {
         r.force_n[2] = kNaN;
       }},
      {"force at sample 2 is inf",
       [](auto& r) {
         r.force_n[2] = kInfinity;
       }},
      {"force at sample 1 is -1e-09",
       [](auto& r) {
         r.force_n[1] = -1e-9;
       }},
      {"2 directions for 3 samples",
       [](auto& r) {
         r.sample_direction.pop_back();
       }},
      {"direction at sample 1 has length 2",
       [](auto& r) {
         r.sample_direction[1] *= 2;
       }},
      {"direction at sample 2 has length nan",
       [](auto& r) {
         r.sample_direction[2][0] = kNaN;
       }},
      {"samples, but no origin",
       [](auto& r) {
         r.origin = ResponseOrigin::kNone;
       }},
  };
  for (const Break& one : breaks) {
    NodeResponse response = sound();
    one.make(response);
    EXPECT_NE(broken_rule(response).find(one.said), std::string::npos)
        << one.said << ": " << broken_rule(response);
  }
}

}  // namespace
}  // namespace palpate
