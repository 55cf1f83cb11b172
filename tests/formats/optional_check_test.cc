// The rules for optional parts, broken one at a time.
#include "formats/optional_check.h"

#include <functional>

#include "formats/error.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

struct Violation {
  const char* name;
  std::function<void(ResponseDatabase&)> make;
  const char* message;  // beginning of the error
};

void PrintTo(const Violation& violation, std::ostream* out) {
  *out << violation.name;
}

ResponseTable& tip(ResponseDatabase& database) {
  return database.tools[0];
}

class BrokenOptionalRule : public testing::TestWithParam<Violation> {};

TEST_P(BrokenOptionalRule, IsNamedWithElementAndValue) {
  ResponseDatabase database = small_database();
  GetParam().make(database);
  try {
    check(database);
    FAIL() << "passed";
  } catch (const FormatError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(GetParam().message, 0), 0u)
        << error.what();
  }
}

const std::vector<Violation> kViolations = {
    {"VerifiedErrorNegative",
     [](ResponseDatabase& d) {
       tip(d).verified_error_relative.assign(6, -0.5);
     },
     "/tools/tip/verified_error_relative: node 0 has -0.5, must be NaN or at least 0"},
    {"FailureWithoutReason",
     [](ResponseDatabase& d) {
       tip(d).failure = {-1, 0, -1, -1, -1, -1};
     },
     "/tools/tip/failure: element 1 is 0, must lie in [-1, -1]"},
    {"FailureWithoutFlag",
     [](ResponseDatabase& d) {
       tip(d).failure = {-1, 0, -1, -1, -1, -1};
       tip(d).failure_reason = {"folded"};
     },
     "/tools/tip/failure: node 1 has reason 0 but neither the flag failed"},
    {"ReasonOfTwoLines",
     [](ResponseDatabase& d) {
       tip(d).failure_reason = {"one\ntwo"};
     },
     "/tools/tip/failure_reason: line 0 is \"one\\ntwo\""},
    {"ErrorsTooShort",
     [](ResponseDatabase& d) {
       tip(d).force_errors_n = {0.1};
     },
     "/tools/tip/force_n_errors has 1 rows"},
    {"DirectionsNotOnePerSample",
     [](ResponseDatabase& d) {
       tip(d).direction_begin = {0, 1, 1, 1, 1, 1, 1};
       tip(d).sample_direction = Points::Ones(1, 3);
     },
     "/tools/tip/direction_begin: node 0 has 1 directions, must be none or one per "
     "sample: 4"},
    {"DirectionsNotUnit",
     [](ResponseDatabase& d) {
       tip(d).direction_begin = {0, 4, 4, 4, 4, 4, 4};
       tip(d).sample_direction = Points::Constant(4, 3, 2.0);
     },
     "/tools/tip/sample_direction: row 0 has length"},
    {"QuantileBeyondOne",
     [](ResponseDatabase& d) {
       tip(d).accuracy = {0.05, 1, {1.5}, {0.1}};
     },
     "/tools/tip/accuracy/quantile_level: element 0 is 1.5"},
    {"ModesDoNotFit",
     [](ResponseDatabase& d) {
       tip(d).displacement.basis.setZero(18, 2);
       tip(d).displacement.coefficient.setZero(1, 3);
     },
     "/tools/tip/displacement/coefficient_m has 3 columns, must have one per mode of "
     "the basis: 2"},
    {"DisplacementNodeOutside",
     [](ResponseDatabase& d) {
       tip(d).displacement.basis.setZero(18, 1);
       tip(d).displacement.coefficient.setZero(1, 1);
       tip(d).displacement.node = {6};
       tip(d).displacement.depth_m = {0.001};
       tip(d).displacement.error_relative = {0.0};
     },
     "/tools/tip/displacement/node: element 0 is 6, must lie in [0, 5]"},
    {"RunsDoNotEnd",
     [](ResponseDatabase& d) {
       d.measurement = {{0.0, 0.1}, {0.0, 1.0}};
       d.measurement.run_begin = {0, 1};
     },
     "/measurement/run_begin runs from 0 to 1, must rise from 0 to 2"},
};
INSTANTIATE_TEST_SUITE_P(Optional, BrokenOptionalRule, testing::ValuesIn(kViolations));

}  // namespace
}  // namespace palpate
