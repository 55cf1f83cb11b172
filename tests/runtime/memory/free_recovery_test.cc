#include "runtime/memory/free_recovery.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

struct Spectrum {
  std::vector<double> g;
  std::vector<double> tau_s;
};

// Of pork; shorter than a few ticks; the most terms; a term that carries nothing; one
// that never goes back.
const std::vector<Spectrum>& spectra() {
  static const std::vector<Spectrum> all{
      {{0.258, 0.303}, {0.42, 4.5}},
      {{0.45, 0.35}, {0.004, 0.06}},
      {{0.1, 0.2, 0.3, 0.15}, {0.01, 0.1, 1.0, 10.0}},
      {{0.3, 0.0, 0.4}, {0.05, 0.5, 5.0}},
      {{0.4, 0.6}, {0.1, 2.0}},
      {{1e-7, 0.5, 1e-12}, {0.02, 0.3, 3.0}},
  };
  return all;
}

RelaxationTimes times_of(const Spectrum& spectrum) {
  RelaxationTimes times;
  times.terms = static_cast<Eigen::Index>(spectrum.g.size());
  for (Eigen::Index k = 0; k < times.terms; ++k) {
    times.tau_s(k) = spectrum.tau_s[static_cast<std::size_t>(k)];
    times.rate_hz(k) = 1.0 / times.tau_s(k);
  }
  return times;
}

TermValues values(const std::vector<double>& list) {
  TermValues all = TermValues::Zero();
  std::copy(list.begin(), list.end(), all.begin());
  return all;
}

TermValues start_n(const Spectrum& spectrum) {
  TermValues q = TermValues::Zero();
  for (std::size_t k = 0; k < spectrum.g.size(); ++k) {
    q(static_cast<Eigen::Index>(k)) = 2.0 / (1.0 + static_cast<double>(k));
  }
  return q;
}

TermValues recovered(const Spectrum& spectrum, const TermValues& q, double time_s) {
  return recovered_freely(times_of(spectrum), q, values(spectrum.g), time_s);
}

// Runge and Kutta's method, of fourth order.
TermValues stepped(const Spectrum& spectrum, TermValues q, double time_s, int steps) {
  const RelaxationTimes times = times_of(spectrum);
  const TermValues g = values(spectrum.g);
  const auto rate = [&](const TermValues& at) {
    return TermValues(((g * at).sum() - at) * times.rate_hz);
  };
  const double h = time_s / steps;
  for (int i = 0; i < steps; ++i) {
    const TermValues a = rate(q);
    const TermValues b = rate(q + 0.5 * h * a);
    const TermValues c = rate(q + 0.5 * h * b);
    const TermValues d = rate(q + h * c);
    q += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
  return q;
}

TEST(FreeRecovery, IsWhatSmallStepsGive) {
  for (const Spectrum& spectrum : spectra()) {
    for (const double time_s : {1e-5, 1e-3, 0.01, 0.1, 1.0, 10.0}) {
      const TermValues q = start_n(spectrum);
      const double step_s = 0.01 * spectrum.tau_s.front();
      const int steps = 10 + static_cast<int>(time_s / step_s);
      const TermValues exact = recovered(spectrum, q, time_s);
      // (h / tau)^4 / 120 a time constant, of 2 N.
      EXPECT_NEAR((exact - stepped(spectrum, q, time_s, steps)).abs().maxCoeff(), 0.0,
                  2e-9)
          << spectrum.tau_s.front() << " " << time_s;
    }
  }
}

TEST(FreeRecovery, TwoTimesOneAfterTheOtherAreTheirSum) {
  for (const Spectrum& spectrum : spectra()) {
    for (const double first_s : {1e-5, 2e-3, 0.3, 7.0}) {
      for (const double second_s : {3e-6, 4e-3, 0.9, 40.0}) {
        const TermValues q = start_n(spectrum);
        const TermValues twice =
            recovered(spectrum, recovered(spectrum, q, first_s), second_s);
        const TermValues once = recovered(spectrum, q, first_s + second_s);
        EXPECT_NEAR((twice - once).abs().maxCoeff(), 0.0, 2e-12)
            << spectrum.tau_s.front() << " " << first_s << " " << second_s;
      }
    }
  }
}

TEST(FreeRecovery, OneTermIsAnExponential) {
  const Spectrum one{{0.4}, {0.3}};
  for (const double time_s : {1e-7, 1e-3, 0.5, 3.0, 1e3}) {
    const double wanted = 2.0 * std::exp(-0.6 * time_s / 0.3);
    EXPECT_NEAR(recovered(one, start_n(one), time_s)(0), wanted, 1e-14) << time_s;
  }
}

TEST(FreeRecovery, StaysBetweenZeroAndTheStartAtAnyTime) {
  for (const Spectrum& spectrum : spectra()) {
    for (const double time_s : {0.0, 1e-300, 1e-12, 1.0, 1e6, 1e300}) {
      const TermValues q = recovered(spectrum, start_n(spectrum), time_s);
      EXPECT_TRUE(q.allFinite()) << time_s;
      EXPECT_GE(q.minCoeff(), 0.0) << time_s;
      EXPECT_LE(q.maxCoeff(), 2.0) << time_s;
    }
  }
}

TEST(FreeRecovery, SharesThatSumToOneLeaveADentForEver) {
  const Spectrum fluid{{0.4, 0.6}, {0.1, 2.0}};
  const TermValues q = recovered(fluid, start_n(fluid), 1e4);
  // sum g_k tau_k q_k does not change, and all become equal: (0.08 + 1.2) / 1.24.
  EXPECT_NEAR(q(0), 1.28 / 1.24, 1e-12);
  EXPECT_NEAR(q(1), 1.28 / 1.24, 1e-12);
}

TEST(FreeRecovery, AnythingElseIsForgotten) {
  const Spectrum pork{{0.258, 0.303}, {0.42, 4.5}};
  EXPECT_LT(recovered(pork, start_n(pork), 500.0).maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace palpate
