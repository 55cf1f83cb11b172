// No curve ends the program, however odd: it is fitted, or refused in words.
#include "tests/support/odd_curve.h"

#include <string>

#include <gtest/gtest.h>

#include "fitting/curve/fitted_response.h"
#include "fitting/session/press_fit.h"
#include "formats/base/error.h"
#include "tests/support/batch_folder.h"

namespace palpate {
namespace {

class OddCurveTest : public BatchFolder {};

// A load cell of 2 gf a step, which flickers before a soft specimen.
Measurement flicker() {
  Measurement m;
  for (const int at : {60, 66, 71, 75, 79, 82, 86, 89, 92, 95, 97, 99}) {
    m.depth_m.resize(static_cast<std::size_t>(at) + 1);
    m.force_n.resize(m.depth_m.size(), 0.0);
    m.force_n.back() = 0.0196;
  }
  for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
    m.depth_m[i] = 7.7e-4 + 3.4e-6 * static_cast<double>(i);
  }
  return m;
}

TEST_F(OddCurveTest, ALoadCellBelowItsResolutionIsAnswered) {
  const RunResult run = fit(flicker());
  if (run.bad.empty()) {
    EXPECT_FALSE(run.rating.gates.empty());
  }
  write("a.csv", flicker());
}

// The fit's own words: not what checks below it say of a table.
void expect_fitted_or_refused(unsigned seed, unsigned& fitted) {
  SCOPED_TRACE(seed);
  const Measurement m = OddCurve(seed).make();
  const Indenter sphere{.shape = "sphere", .radius_m = 5e-3};
  try {
    const PressFit press = fit_press(m, {.range = {}, .indenter = sphere, .frame = {}});
    (void)to_json(press, {}).dump();
    ++fitted;
    if (!press.choice.fits.empty()) {
      (void)sample_patch(best_of(press), m, *rendered_tool(sphere), "");
    }
  } catch (const Error& error) {
    const std::string said = error.what();
    EXPECT_FALSE(said.empty() || said.starts_with("response curve") ||
                 said.starts_with("node "))
        << said;
  }
}

TEST_F(OddCurveTest, EveryOddCurveIsFittedOrRefusedInWords) {
  unsigned fitted = 0;
  for (unsigned seed = 1; seed <= 250; ++seed) {
    expect_fitted_or_refused(seed, fitted);
  }
  EXPECT_GT(fitted, 60U);
}

// Flicker of which nothing but the outliers, or the deepest sample, is in contact.
TEST_F(OddCurveTest, ALawThatLeavesNothingInContactIsAnswered) {
  unsigned fitted = 0;
  for (const unsigned seed : {5000138U, 5000338U, 5000405U, 5000486U}) {
    expect_fitted_or_refused(seed, fitted);
  }
  EXPECT_EQ(fitted, 4U);
}

TEST_F(OddCurveTest, ADriftThatBendsAndLeavesNothingInContactIsAnswered) {
  unsigned fitted = 0;
  expect_fitted_or_refused(20'015'086, fitted);
  EXPECT_EQ(fitted, 1U);
}

TEST_F(OddCurveTest, ABatchOfOddCurvesListsEachOfThem) {
  constexpr unsigned kRuns = 60;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    write(fmt::format("{:03}.csv", seed), OddCurve(1000 + seed).make());
  }
  const Session s = session(kRead);
  const BatchReport report = fit_session(s, 2, [](std::size_t) {});
  EXPECT_GE(report.runs.size(), kRuns);
  EXPECT_FALSE(batch_csv(s, report).empty());
  EXPECT_FALSE(batch_json(s, report).empty());
  EXPECT_FALSE(batch_page(s, report).empty());
}

}  // namespace
}  // namespace palpate
