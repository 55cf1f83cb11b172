#include "runtime/bench/bench_fidelity.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"

namespace palpate {
namespace {

// Rounding of the account: 8 s at 2 kHz, energies of 0.01 J.
constexpr double kRoundingJ = 1e-14;

const std::vector<FidelityRow>& fidelity_rows() {
  static const std::vector<FidelityRow> kRows = run_fidelity({});
  return kRows;
}

TEST(Fidelity, EnergyTankIsWithinHalfAPercent) {
  for (const FidelityRow& row : fidelity_rows()) {
    if (row.model == LocalModel::kEnergyTank) {
      EXPECT_LE(row.rms_relative_error, 0.005)
          << row.exponent << ' ' << row.frequency_hz;
    }
  }
}

TEST(Fidelity, ModelsOfTheSurfaceAreTheCurveItself) {
  // Left is the cubic through 33 samples against a x^p near zero, p = 1.5.
  for (const FidelityRow& row : fidelity_rows()) {
    if (follows_surface(row.model)) {
      EXPECT_LE(row.rms_relative_error, 2e-4)
          << row.exponent << ' ' << row.frequency_hz;
    }
  }
}

TEST(Fidelity, EqualEnergyIsExactForALineOnly) {
  for (const FidelityRow& row : fidelity_rows()) {
    if (row.model == LocalModel::kEqualEnergy) {
      const bool line = row.exponent == 1.0;
      EXPECT_EQ(row.rms_relative_error < 0.01, line) << row.exponent;
    }
  }
}

TEST(Fidelity, PassiveModelsNeverGiveEnergyAway) {
  for (const FidelityRow& row : fidelity_rows()) {
    if (passive(row.model)) {
      EXPECT_GE(row.lowest_energy_j, -kRoundingJ) << name(row.model);
      EXPECT_GE(row.net_energy_j, -kRoundingJ) << name(row.model);
    }
  }
}

TEST(Fidelity, HoldsDoGiveEnergyAway) {
  for (const FidelityRow& row : fidelity_rows()) {
    if (!passive(row.model)) {
      EXPECT_LT(row.net_energy_j, -1e-3 * row.stored_energy_j) << name(row.model);
    }
  }
}

TEST(Fidelity, ReportHasItsKeys) {
  const auto json = parse_json(to_json(fidelity_rows()));
  ASSERT_EQ(json["rows"].size(), 56U);
  for (const char* key : {"exponent", "frequency_hz", "model", "rms_relative_error",
                          "net_energy_j", "stored_energy_j"}) {
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  }
}

TEST(Fidelity, RefusesASlowRateThatDoesNotDivideTheFastOne) {
  EXPECT_THROW((void)run_fidelity({.slow_hz = 300.0}), InputError);
}

}  // namespace
}  // namespace palpate
