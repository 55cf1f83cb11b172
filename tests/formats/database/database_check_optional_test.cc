// The rules for optional parts, broken one at a time.
#include "formats/database/database_check_optional.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/formats/database/violation.h"
#include "tests/support/small_database.h"

namespace palpate {
namespace {

class BrokenOptionalRule : public testing::TestWithParam<Violation<ResponseDatabase>> {
};

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

const std::vector<Violation<ResponseDatabase>> kOptionalViolations = {
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
    {"HistoryWithoutText",
     [](ResponseDatabase& d) {
       tip(d).history = {-1, 0, -1, -1, -1, -1};
     },
     "/tools/tip/history: element 1 is 0, must lie in [-1, -1]"},
    {"HistoryTooShort",
     [](ResponseDatabase& d) {
       tip(d).history = {0};
       tip(d).history_text = {"failed: mesh 2 times coarser"};
     },
     "/tools/tip/history has 1 rows, must have 6"},
    {"HistoryOfWhatWasNotSolved",
     [](ResponseDatabase& d) {
       tip(d).origin[1] = static_cast<std::uint8_t>(ResponseOrigin::kMeasured);
       tip(d).history = {-1, 0, -1, -1, -1, -1};
       tip(d).history_text = {"failed: mesh 2 times coarser"};
     },
     "/tools/tip/history: node 1 has row 0, but was interpolated or measured"},
    {"HistoryOfTwoLines",
     [](ResponseDatabase& d) {
       tip(d).history_text = {""};
     },
     "/tools/tip/history_text: line 0 is \"\""},
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
       tip(d).accuracy = {0.05, 1.2, 0.0, 0.5, 0.0, 1, 0, {1.5}, {0.1}};
     },
     "/tools/tip/accuracy/quantile_level: element 0 is 1.5"},
    {"MorePlacesBetweenNodesThanChecks",
     [](ResponseDatabase& d) {
       tip(d).accuracy = {0.05, 1.2, 0.0, 0.5, 0.0, 1, 2, {0.5}, {0.1}};
     },
     "/tools/tip/accuracy@between_nodes: element 0 is 2"},
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
    {"RelaxationOfTwoRows",
     [](ResponseDatabase& d) {
       tip(d).relaxation = relaxing();
       tip(d).relaxation.terms = {{0.1, 0.1}, {0.1, 0.1}, {1.0, 1.0}, {2.0, 2.0}};
     },
     "/tools/tip/relaxation/g_1 has 2 rows, must have 6"},
    {"RelaxationRowsDiffer",
     [](ResponseDatabase& d) {
       tip(d).relaxation = relaxing();
       tip(d).relaxation.terms.tau_2_s.clear();
     },
     "/tools/tip/relaxation/tau_2_s has 0 rows, must have 1"},
    {"MoreRelaxesThanThereIs",
     [](ResponseDatabase& d) {
       tip(d).relaxation = relaxing();
       tip(d).relaxation.terms.g_1 = {0.8};
     },
     "/tools/tip/relaxation: row 0 has g_1 0.8 and g_2 0.3, must be at least 0 and "
     "together at most 1"},
    {"RelaxationNotANumber",
     [](ResponseDatabase& d) {
       tip(d).relaxation = relaxing();
       tip(d).relaxation.terms = {{kNaN}, {kNaN}, {kNaN}, {kNaN}};
     },
     "/tools/tip/relaxation: row 0 has g_1 nan"},
    {"TimesFall",
     [](ResponseDatabase& d) {
       tip(d).relaxation = relaxing();
       tip(d).relaxation.terms.tau_1_s = {5.0};
     },
     "/tools/tip/relaxation: row 0 has tau_1_s 5 and tau_2_s 4.5, must be positive"},
    {"RelaxationWithoutRule",
     [](ResponseDatabase& d) {
       tip(d).relaxation = relaxing();
       tip(d).relaxation.rule.clear();
     },
     "/tools/tip/relaxation@rule: line 0 is \"\""},
    {"RelaxationWithoutSpeed",
     [](ResponseDatabase& d) {
       tip(d).relaxation = relaxing();
       tip(d).relaxation.speed_m_per_s = 0.0;
     },
     "/tools/tip/relaxation@speed_m_per_s is 0, must be positive"},
    {"RelaxationOfNobody",
     [](ResponseDatabase& d) {
       tip(d).relaxation = relaxing();
       tip(d).relaxation.probes = 0;
     },
     "/tools/tip/relaxation@probes is 0, must be positive"},
    {"RelaxationOfMoreRuns",
     [](ResponseDatabase& d) {
       d.measurement = held();
       d.measurement.relaxation.terms = {{0.1}, {0.1}, {1.0}, {2.0}};
     },
     "/measurement/relaxation/g_1 has 1 rows, must have 2"},
    {"UnknownRunWithASpeed",
     [](ResponseDatabase& d) {
       d.measurement = held();
       d.measurement.relaxation.speed_m_per_s[1] = 1e-3;
     },
     "/measurement/relaxation/speed_m_per_s: run 1 has 0.001, must be not a number"},
    {"KnownRunWithoutHold",
     [](ResponseDatabase& d) {
       d.measurement = held();
       d.measurement.relaxation.seconds[0] = kNaN;
     },
     "/measurement/relaxation/seconds: run 0 has nan, must be finite"},
    {"RunsDoNotEnd",
     [](ResponseDatabase& d) {
       d.measurement = {{0.0, 0.1}, {0.0, 1.0}};
       d.measurement.run_begin = {0, 1};
     },
     "/measurement/run_begin runs from 0 to 1, must rise from 0 to 2"},
};
INSTANTIATE_TEST_SUITE_P(Optional, BrokenOptionalRule,
                         testing::ValuesIn(kOptionalViolations));

}  // namespace
}  // namespace palpate
