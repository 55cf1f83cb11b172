// Every rule of FORMAT.md, broken one at a time.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/response_database.h"
#include "tests/formats/database/violation.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

class BrokenRule : public testing::TestWithParam<Violation<ResponseDatabase>> {};

TEST_P(BrokenRule, IsNamedWithElementAndValue) {
  ResponseDatabase database = small_database();
  check(database);
  GetParam().make(database);
  try {
    check(database);
    FAIL() << "passed";
  } catch (const FormatError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(GetParam().message, 0), 0u)
        << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

const std::vector<Violation<ResponseDatabase>> kBody = {
    {"NoNodes",
     [](ResponseDatabase& d) {
       d.body.position_m.resize(0, 3);
     },
     "/body has 0 nodes and 8 triangles"},
    {"NanPosition",
     [](ResponseDatabase& d) {
       d.body.position_m(3, 1) = kNaN;
     },
     "/body/position_m: node 3 is at (0, nan, 0)"},
    {"IndexTooLarge",
     [](ResponseDatabase& d) {
       d.body.triangle(2, 0) = 6;
     },
     "/body/triangle: triangle 2 is (6, 3, 4), must be three different nodes in [0, "
     "5]"},
    {"IndexNegative",
     [](ResponseDatabase& d) {
       d.body.triangle(2, 0) = -1;
     },
     "/body/triangle: triangle 2 is (-1, 3, 4)"},
    {"NodeTwice",
     [](ResponseDatabase& d) {
       d.body.triangle(2, 0) = 3;
     },
     "/body/triangle: triangle 2 is (3, 3, 4)"},
    {"NormalsMissing",
     [](ResponseDatabase& d) {
       d.normal.conservativeResize(5, 3);
     },
     "/body/normal has 5 rows"},
    {"NormalNotUnit",
     [](ResponseDatabase& d) {
       d.normal.row(1) *= 1.1;
     },
     "/body/normal: node 1 has length 1.1"},
};
INSTANTIATE_TEST_SUITE_P(Body, BrokenRule, testing::ValuesIn(kBody));

const std::vector<Violation<ResponseDatabase>> kTool = {
    {"NoTools",
     [](ResponseDatabase& d) {
       d.tools.clear();
     },
     "/tools is empty"},
    {"SameName",
     [](ResponseDatabase& d) {
       d.tools[1].tool.name = "tip";
     },
     "/tools: the name \"tip\" occurs twice"},
    {"BadRadius",
     [](ResponseDatabase& d) {
       tip(d).tool.radius_m = 0.0;
     },
     "/tools: tool \"tip\": radius_m is 0"},
    {"ShortArray",
     [](ResponseDatabase& d) {
       tip(d).origin.pop_back();
     },
     "/tools/tip/origin has 5 rows, must have 6"},
    {"DirectionNotUnit",
     [](ResponseDatabase& d) {
       tip(d).direction.row(2) *= 0.5;
     },
     "/tools/tip/direction: node 2 has length 0.5, must be 1"},
    {"DirectionNan",
     [](ResponseDatabase& d) {
       tip(d).direction(2, 0) = kNaN;
     },
     "/tools/tip/direction: node 2 has length nan, must be 1"},
    {"FrictionRange",
     [](ResponseDatabase& d) {
       tip(d).friction[4] = 11.0;
     },
     "/tools/tip/friction: node 4 has 11, must lie in [0, 10]"},
    {"FrictionWithoutPresliding",
     [](ResponseDatabase& d) {
       tip(d).friction[4] = 1.0;
     },
     "/tools/tip/presliding_m: node 4 has 0, must be positive"},
    {"SpreadRange",
     [](ResponseDatabase& d) {
       tip(d).direction_spread_rad[0] = 4.0;
     },
     "/tools/tip/direction_spread_rad: node 0 has 4"},
    {"OriginUnknown",
     [](ResponseDatabase& d) {
       tip(d).origin[0] = 4;
     },
     "/tools/tip/origin: node 0 has 4"},
    {"OriginWithoutCurve",
     [](ResponseDatabase& d) {
       tip(d).origin[5] = 1;
     },
     "/tools/tip/origin: node 5 is 1 but has 0 samples"},
    {"OffsetInfinite",
     [](ResponseDatabase& d) {
       tip(d).touch_offset_m[1] = -std::numeric_limits<double>::infinity();
     },
     "/tools/tip/touch_offset_m: node 1 has -inf"},
};
INSTANTIATE_TEST_SUITE_P(Tool, BrokenRule, testing::ValuesIn(kTool));

// Node 0 owns samples 0 to 3, node 1 samples 4 to 8.
const std::vector<Violation<ResponseDatabase>> kCurve = {
    {"BeginNotZero",
     [](ResponseDatabase& d) {
       tip(d).sample_begin[0] = 1;
     },
     "/tools/tip/sample_begin: element 0 is 1"},
    {"BeginFalls",
     [](ResponseDatabase& d) {
       tip(d).sample_begin[2] = 3;
     },
     "/tools/tip/sample_begin: node 1 owns samples 4 to 3"},
    {"OneSample",
     [](ResponseDatabase& d) {
       tip(d).sample_begin[1] = 1;
     },
     "/tools/tip/sample_begin: node 0 owns samples 0 to 1"},
    {"EndWrong",
     [](ResponseDatabase& d) {
       tip(d).sample_begin[6] += 2;
     },
     "/tools/tip/sample_begin: the last element is 32, must be the number of samples "
     "30"},
    {"BeginHuge",
     [](ResponseDatabase& d) {
       tip(d).sample_begin[3] = std::numeric_limits<std::int64_t>::max();
     },
     "/tools/tip/sample_begin: node 3 owns samples"},
    {"StartNotZero",
     [](ResponseDatabase& d) {
       tip(d).force_n[4] = 0.1;
     },
     "/tools/tip: the curve of node 1 starts at (0 m, 0.1 N, 0 J)"},
    {"DepthFalls",
     [](ResponseDatabase& d) {
       tip(d).depth_m[6] = tip(d).depth_m[5];
     },
     "/tools/tip/depth_m: node 1 sample 2 is"},
    {"DepthNan",
     [](ResponseDatabase& d) {
       tip(d).depth_m[6] = kNaN;
     },
     "/tools/tip/depth_m: node 1 sample 2 is nan"},
    {"ForceNegative",
     [](ResponseDatabase& d) {
       tip(d).force_n[6] = -0.5;
     },
     "/tools/tip/force_n: node 1 sample 2 is -0.5"},
    {"Overshoot",
     [](ResponseDatabase& d) {
       tip(d).stiffness_n_per_m[6] *= 4.0;
     },
     "/tools/tip/stiffness_n_per_m: node 1 sample 2 is"},
    {"SlopeAgainstTheSamples",
     [](ResponseDatabase& d) {
       tip(d).stiffness_n_per_m[6] *= -0.1;
     },
     "/tools/tip/stiffness_n_per_m: node 1 sample 2 is -"},
    {"EnergyNotTheIntegral",
     [](ResponseDatabase& d) {
       tip(d).energy_j[6] *= 1.000001;
     },
     "/tools/tip/energy_j: node 1 sample 2 is"},
    {"LargestSlopeWrong",
     [](ResponseDatabase& d) {
       tip(d).stiffness_max_n_per_m[1] *= 0.999;
     },
     "/tools/tip/stiffness_max_n_per_m: node 1 has"},
    {"FallsUnflagged",
     [](ResponseDatabase& d) {
       tip(d).flags[4] = 0;
     },
     "/tools/tip/flags: node 4 is not flagged as falling, but its force falls"},
    {"FlaggedButRises",
     [](ResponseDatabase& d) {
       tip(d).flags[3] = kFallingCurve;
     },
     "/tools/tip/flags: node 3 is flagged as falling, but its force never falls"},
};
INSTANTIATE_TEST_SUITE_P(Curve, BrokenRule, testing::ValuesIn(kCurve));

const std::vector<Violation<ResponseDatabase>> kRest = {
    {"MeasurementLengths",
     [](ResponseDatabase& d) {
       d.measurement.depth_m = {0.0, 0.1};
       d.measurement.force_n = {0.0};
     },
     "/measurement/force_n has 1 rows"},
    {"MeasurementNan",
     [](ResponseDatabase& d) {
       d.measurement.depth_m = {0.0, 0.1};
       d.measurement.force_n = {0.0, kNaN};
     },
     "/measurement: sample 1 is (0.1 m, nan N)"},
    {"DigestShort",
     [](ResponseDatabase& d) {
       d.provenance.source_sha256 = "abc";
     },
     "/provenance@source_sha256 is \"abc\""},
    {"TextTooLong",
     [](ResponseDatabase& d) {
       d.provenance.left_out.assign(16385, 'x');
     },
     "/provenance holds a text of 16385 bytes"},
    {"TextWithNul",
     [](ResponseDatabase& d) {
       d.provenance.scene_toml.assign(3, '\0');
     },
     "/provenance/scene_toml holds a NUL byte"},
};
INSTANTIATE_TEST_SUITE_P(Rest, BrokenRule, testing::ValuesIn(kRest));

}  // namespace
}  // namespace palpate
