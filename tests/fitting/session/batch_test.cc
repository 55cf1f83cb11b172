// Every trap that real files hold, as a small file of our own, and what becomes of it.
#include "fitting/session/batch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/batch_folder.h"

namespace palpate {
namespace {

class BatchTest : public BatchFolder {};

bool has(const RunResult& run, FitFlag flag) {
  return std::find(run.flags.begin(), run.flags.end(), flag) != run.flags.end();
}

bool has_gate(const RunResult& run, const std::string& gate) {
  const auto& gates = run.rating.gates;
  return std::find(gates.begin(), gates.end(), gate) != gates.end();
}

std::string units(const std::string& depth, const std::string& force) {
  return fmt::format(
      "[read]\ndepth_column = 1\ndepth_unit = \"{}\"\nforce_column = 2\n"
      "force_unit = \"{}\"\n",
      depth, force);
}

TEST_F(BatchTest, APlainCurveIsToBeUsed) {
  const RunResult run = fit(synthetic({}, 1));
  EXPECT_EQ(run.bad, "");
  EXPECT_TRUE(run.flags.empty());
  EXPECT_EQ(run.rating.verdict, Verdict::kUse);
  EXPECT_GT(run.rating.score, 0.7);
  ASSERT_NE(run.best(), nullptr);
  EXPECT_NEAR(run.best()->contact_point_m, 2e-3, 1e-4);
}

TEST_F(BatchTest, UnitsOfInstrumentsGiveTheSameCurve) {
  const Measurement m = synthetic({}, 1);
  struct {
    const char *depth, *force;
    double per_m, per_n;
  } const cases[] = {{"um", "mN", 1e6, 1e3},
                     {"nm", "uN", 1e9, 1e6},
                     {"cm", "gf", 1e2, 1.0 / 9.80665e-3},
                     {"m", "nN", 1.0, 1e9}};
  for (const auto& c : cases) {
    write("a.csv", m, c.per_m, c.per_n);
    const Session s = session(units(c.depth, c.force));
    const RunResult run = fit_run(s, s.run.at(0)).at(0);
    ASSERT_NE(run.best(), nullptr) << run.bad;
    EXPECT_NEAR(run.best()->contact_point_m, fit(m).best()->contact_point_m, 1e-9);
    EXPECT_NEAR(family_point(*run.best(), 4e-3).force, std::pow(0.8, 1.5), 0.02);
  }
}

TEST_F(BatchTest, DecimalCommasAreRead) {
  std::string text = "x;f\n";
  const Measurement m = synthetic({}, 1);
  for (std::size_t i = 0; i < m.depth_m.size(); ++i) {
    std::string row = fmt::format("{:.9f};{:.9f}\n", 1e3 * m.depth_m[i], m.force_n[i]);
    std::replace(row.begin(), row.end(), '.', ',');
    text += row;
  }
  write("a.csv", text);
  const Session s = session(kRead);
  EXPECT_NEAR(fit_run(s, s.run.at(0)).at(0).best()->contact_point_m, 2e-3, 1e-4);
}

TEST_F(BatchTest, AUnitThatTheHeaderContradictsIsABadFile) {
  write("a.csv", synthetic({}, 1), 1e3, 1.0, "x [um],f\n");
  const Session s = session(kRead);
  const RunResult run = fit_run(s, s.run.at(0)).at(0);
  EXPECT_NE(run.bad.find("states the unit um"), std::string::npos);
  EXPECT_EQ(run.rating.verdict, Verdict::kSkip);
}

const std::vector<SegmentKind> kDwellPressHoldRelease{
    SegmentKind::kDwell, SegmentKind::kApproach, SegmentKind::kHold,
    SegmentKind::kRetract};

Measurement dwell_press_hold_release() {
  Measurement m;
  const Measurement press = synthetic({}, 1);
  const auto add = [&](double x, double f) {
    m.depth_m.push_back(x);
    m.force_n.push_back(f);
  };
  for (int i = 0; i < 30; ++i) {
    add(0.0, press.force_n[static_cast<std::size_t>(i)]);
  }
  for (std::size_t i = 0; i < press.depth_m.size(); ++i) {
    add(press.depth_m[i], press.force_n[i]);
  }
  for (int i = 0; i < 60; ++i) {
    add(7e-3, 0.6 + 0.4 * std::exp(-0.1 * i) + 0.004 * (i % 2));
  }
  for (std::size_t i = press.depth_m.size(); i-- > 0;) {
    add(press.depth_m[i], 0.6 * press.force_n[i]);
  }
  return m;
}

std::vector<SegmentKind> kinds_of(const RunResult& run) {
  std::vector<SegmentKind> kinds;
  for (const Segment& segment : run.segments) {
    kinds.push_back(segment.kind);
  }
  return kinds;
}

// A displacement that falls under compression is turned before it is cut up.
TEST_F(BatchTest, SegmentsDoNotKnowTheSignOfTheDisplacement) {
  write("a.csv", dwell_press_hold_release(), -1e3);
  const Session s = session(kRead);
  const RunResult run = fit_run(s, s.run.at(0)).at(0);
  EXPECT_TRUE(has(run, FitFlag::kDepthSignTurned));
  EXPECT_EQ(kinds_of(run), kDwellPressHoldRelease);
}

TEST_F(BatchTest, DwellHoldAndRetractAreSegmentsAndNotFitted) {
  const RunResult run = fit(dwell_press_hold_release());
  EXPECT_TRUE(has(run, FitFlag::kHoldCutOff));
  EXPECT_TRUE(has(run, FitFlag::kRetractCutOff));
  EXPECT_NEAR(run.best()->contact_point_m, 2e-3, 1.5e-4);
  EXPECT_EQ(kinds_of(run), kDwellPressHoldRelease);
  // The release gives back 0.6 of the press: (1 - 0.6) / (pi (1 + 0.6)).
  EXPECT_NEAR(run.loop.loss_factor, 0.4 / (1.6 * std::numbers::pi), 1e-3);
}

// Twice pressed, the second time deeper and a fifth stiffer.
TEST_F(BatchTest, EveryPressOfAFileIsARowOfItsOwn) {
  Measurement m = synthetic({}, 1);
  const Measurement second = synthetic({}, 2);
  for (std::size_t i = m.depth_m.size(); i-- > 0;) {
    m.depth_m.push_back(m.depth_m[i]);
    m.force_n.push_back(0.8 * m.force_n[i]);
  }
  for (std::size_t i = 0; i < second.depth_m.size(); ++i) {
    m.depth_m.push_back(1.1 * second.depth_m[i]);
    m.force_n.push_back(1.2 * second.force_n[i]);
  }
  write("a.csv", m);
  write("b.csv", synthetic({}, 3));
  const Session s = session(kRead);
  const BatchReport report = fit_session(s, 1, [](std::size_t) {});
  ASSERT_EQ(report.runs.size(), 3U);
  const RunResult& deep = report.runs[1];
  EXPECT_EQ(report.runs[0].name, "a.csv");
  EXPECT_EQ(deep.name, "a.csv press 2");
  EXPECT_EQ(deep.press, 2U);
  EXPECT_EQ(deep.presses, 2U);
  EXPECT_EQ(report.runs[2].presses, 1U);
  EXPECT_NEAR(report.runs[0].best()->contact_point_m, 2e-3, 1e-4);
  EXPECT_NEAR(deep.best()->contact_point_m, 2.2e-3, 1.1e-4);
  EXPECT_NEAR(family_point(*deep.best(), 5.5e-3).force, 1.2, 0.02);
  EXPECT_FALSE(has_gate(deep, "non_monotone_depth"));
  // Presses of one file are repeats at one point: at 80 % of the shallower depth, 4 mm,
  // the forces are 0.8^1.5 and 1.2 (0.8 / 1.1)^1.5.
  const double a = std::pow(0.8, 1.5), b = 1.2 * std::pow(0.8 / 1.1, 1.5);
  EXPECT_NEAR(deep.rating.features.repeat_scatter,
              std::abs(a - b) / std::sqrt(2.0) / (0.5 * (a + b)), 0.01);
  const std::string csv = batch_csv(s, report);
  EXPECT_NE(csv.find("\na.csv press 2,a.csv,2,use"), std::string::npos) << csv;
}

TEST_F(BatchTest, RepeatedDepthsAndBacklashDoNotStopTheFit) {
  Measurement m = synthetic({}, 1);
  for (std::size_t i = 0; i + 1 < m.depth_m.size(); i += 3) {
    m.depth_m[i + 1] = m.depth_m[i];
  }
  EXPECT_NEAR(fit(m).best()->contact_point_m, 2e-3, 1.5e-4);
  for (std::size_t i = 100; i < 110; ++i) {
    m.depth_m[i] -= 0.2e-3;
  }
  const RunResult back = fit(m);
  EXPECT_TRUE(has_gate(back, "non_monotone_depth"));
  EXPECT_EQ(back.rating.verdict, Verdict::kCheck);
}

TEST_F(BatchTest, NegativeStrainIsTurned) {
  write("a.csv", synthetic({}, 1), -1e3, -1.0);
  const Session s = session(kRead);
  const RunResult run = fit_run(s, s.run.at(0)).at(0);
  EXPECT_TRUE(has(run, FitFlag::kDepthSignTurned));
  EXPECT_TRUE(has(run, FitFlag::kForceSignTurned));
  EXPECT_EQ(run.rating.verdict, Verdict::kUse);
}

TEST_F(BatchTest, AnEmptyRunIsSkipped) {
  Measurement m = synthetic({}, 7);
  for (double& force : m.force_n) {
    force = 0.01 * std::sin(1e4 * force);
  }
  const RunResult run = fit(m);
  EXPECT_TRUE(has_gate(run, "empty_run"));
  EXPECT_EQ(run.rating.verdict, Verdict::kSkip);
  EXPECT_EQ(run.best(), nullptr);
}

TEST_F(BatchTest, AHugeSpikeIsLeftOut) {
  Measurement m = synthetic({}, 1);
  m.force_n[100] += 500.0;
  const RunResult run = fit(m);
  EXPECT_TRUE(has(run, FitFlag::kSpikes));
  EXPECT_NEAR(run.best()->contact_point_m, 2e-3, 1e-4);
}

TEST_F(BatchTest, ContactFromTheStartIsToBeChecked) {
  const RunResult run = fit(synthetic({.exponent = 1.2, .free_m = 0.0}, 9));
  EXPECT_TRUE(has_gate(run, "already_in_contact"));
  EXPECT_EQ(run.rating.verdict, Verdict::kCheck);
}

TEST_F(BatchTest, UnitsThatCannotBeAreSkipped) {
  write("a.csv", synthetic({}, 1));
  const Session s = session(units("m", "N"));  // 7 m of travel
  EXPECT_TRUE(has_gate(fit_run(s, s.run.at(0)).at(0), "implausible_units"));
}

// The session's baseline and relative noise reach both fits of a run.
TEST_F(BatchTest, TheSessionsBaselineKeepsEveryContactPointBeyondIt) {
  write("a.csv", synthetic({}, 1));
  Session s = session(kRead);
  const RunResult untold = fit_run(s, s.run.at(0)).at(0);
  s.fit.noise_relative = 0.5;
  const RunResult weighed = fit_run(s, s.run.at(0)).at(0);
  EXPECT_NE(weighed.contact.contact_point_m, untold.contact.contact_point_m);
  EXPECT_NE(weighed.best()->contact_point_m, untold.best()->contact_point_m);
  s.fit.baseline = FitRange{0.0, 2.5e-3};
  const RunResult told = fit_run(s, s.run.at(0)).at(0);
  EXPECT_NEAR(told.contact.contact_point_m, 2.5e-3, 1e-9);
  EXPECT_GE(told.best()->contact_point_m, 2.5e-3 - 1e-9);
  EXPECT_TRUE(has(told, FitFlag::kParameterAtBound));
}

TEST_F(BatchTest, WithoutAGeometryThereIsNoModulus) {
  const RunResult run = fit(synthetic({}, 1));
  EXPECT_EQ(run.modulus.refused, "the indenter's geometry is not known");
  EXPECT_TRUE(std::isnan(run.modulus.youngs_modulus_pa));
}

TEST_F(BatchTest, ABadFileIsListedAndStopsNothing) {
  write("a.csv", synthetic({}, 1));
  write("b.csv", "x,f\n1,2\n3,broken\n");
  write("c.csv", synthetic({}, 2));
  write("d.csv", "");
  const Session s = session(kRead);
  std::size_t told = 0;
  const BatchReport report = fit_session(s, 2, [&](std::size_t) {
    ++told;
  });
  EXPECT_EQ(told, 4U);
  EXPECT_EQ(report.runs[0].bad, "");
  EXPECT_NE(report.runs[1].bad.find("line 3, column 2 \"f\""), std::string::npos);
  EXPECT_EQ(report.runs[2].bad, "");
  EXPECT_NE(report.runs[3].bad, "");
  const std::string csv = batch_csv(s, report);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  EXPECT_NE(csv.find("bad_file"), std::string::npos);
  EXPECT_NE(batch_json(s, report).find("\"bad\":2"), std::string::npos);
  const std::string page = batch_page(s, report);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("http"), page.find("http-equiv"));  // nothing from elsewhere
}

TEST_F(BatchTest, WhatProgressThrowsEndsTheWorkAndComesOut) {
  for (const char* name : {"a.csv", "b.csv", "c.csv", "d.csv", "e.csv"}) {
    write(name, synthetic({}, 1));
  }
  const Session s = session(kRead);
  for (const unsigned threads : {1U, 2U}) {
    std::size_t told = 0;
    EXPECT_THROW(static_cast<void>(fit_session(s, threads,
                                               [&](std::size_t) {
                                                 ++told;
                                                 throw InputError("enough");
                                               })),
                 InputError);
    EXPECT_LE(told, threads);  // those that were under way
    EXPECT_GE(told, 1U);
  }
}

TEST_F(BatchTest, EveryRowHasACellForEveryColumn) {
  write("a.csv", synthetic({}, 1));
  write("b.csv", "nothing");
  write("=1+2.csv", "nothing");  // a spreadsheet would run it
  const Session s = session(kRead);
  const std::string csv = batch_csv(s, fit_session(s, 1, [](std::size_t) {}));
  std::size_t begin = 0, columns = 0;
  while (begin < csv.size()) {
    const std::size_t end = csv.find('\n', begin);
    std::size_t commas = 0;
    bool in_quotes = false;
    for (std::size_t i = begin; i < end; ++i) {
      in_quotes = in_quotes != (csv[i] == '"');
      commas += csv[i] == ',' && !in_quotes ? 1 : 0;
    }
    columns = columns == 0 ? commas : columns;
    EXPECT_EQ(commas, columns) << csv.substr(begin, end - begin);
    begin = end + 1;
  }
  EXPECT_NE(csv.find("\n'=1+2.csv,"), std::string::npos) << csv;
}

TEST_F(BatchTest, RepeatsTellTheirScatter) {
  write("a.csv", synthetic({}, 1));
  write("b.csv", synthetic({}, 2), 1e3, 1.1);
  write("session.toml", fmt::format("{}{}[[run]]\nfiles = \"*.csv\"\npoint = \"P\"\n",
                                    kRead, kFamilies));
  const Session s = read_session(folder_ / "session.toml");
  const BatchReport report = fit_session(s, 1, [](std::size_t) {});
  // Two forces that differ by 10 %: their deviation over their mean is 0.1 / 1.05 /
  // root 2.
  EXPECT_NEAR(report.runs[0].rating.features.repeat_scatter, 0.0673, 0.02);
}

}  // namespace
}  // namespace palpate
