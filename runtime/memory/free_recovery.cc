#include "runtime/memory/free_recovery.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

// Up to this many of the shortest time the series below ends by itself soon.
constexpr Real kShort = 0.02;
constexpr int kSeriesMax = 12;
constexpr int kRootMax = 80;
// Terms with less than this take no part: their force counts for less than rounding.
constexpr Real kNoShare = rounding(1e-9, 1e-5);

// The exponential's series, for a time short against every tau_k.
TermValues recovered_soon(const RelaxationTimes& times, const TermValues& relaxed,
                          const TermValues& g, Real t) {
  constexpr Real kEnough = std::numeric_limits<Real>::epsilon() / 8;
  TermValues q = relaxed;
  TermValues part = relaxed;
  const TermValues x = t * times.rate_hz;
  const Real enough = kEnough * relaxed.maxCoeff();
  for (int n = 1; n <= kSeriesMax; ++n) {
    part = ((g * part).sum() - part) * (x * (Real(1.0) / static_cast<Real>(n)));
    q += part;
    if (!(part.abs().maxCoeff() > enough)) {
      break;
    }
  }
  return q;
}

// zeta_k where zeta_r = zeta.
Real zeta_of(const TermValues& tau, Eigen::Index r, Eigen::Index k, Real zeta) {
  return k == r ? zeta : 1.0 - (1.0 - zeta) * (tau(k) / tau(r));
}

// zeta_r of the root above the pole of term r: 1 - sum g_k / zeta_k rises from
// -infinity there to +infinity at the pole of the next term that takes part, or to
// 1 - sum g >= 0 at zeta_r = 1.
Real root(const RelaxationTimes& times, const TermValues& g, Eigen::Index r) {
  const TermValues& tau = times.tau_s;
  Eigen::Index next = r + 1;
  while (next < times.terms && !(g(next) > kNoShare)) {
    ++next;
  }
  // lambda_r = (zeta_r - 1) / tau_r, so that zeta_k = 1 - (1 - zeta_r) tau_k / tau_r.
  // The pole of the next term, zeta_next = 0, is at zeta_r = 1 - tau_r / tau_next.
  Real low = 0.0;
  Real high = next < times.terms ? 1.0 - tau(r) / tau(next) : Real(1.0);
  Real zeta = 0.5 * high;
  for (int i = 0; i < kRootMax; ++i) {
    Real value = 1.0;
    Real slope = 0.0;
    for (Eigen::Index k = 0; k < times.terms; ++k) {
      if (g(k) > kNoShare) {
        const Real z = zeta_of(tau, r, k, zeta);
        value -= g(k) / z;
        slope += g(k) * (tau(k) / tau(r)) / (z * z);
      }
    }
    // Newton's method where it stays in the bracket, else its middle.
    (value < 0.0 ? low : high) = zeta;
    const Real newton = zeta - value / slope;
    const Real now = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (now == zeta || !(now > low && now < high)) {
      break;
    }
    zeta = now;
  }
  return zeta;
}

// (e^(lambda_r t) - e^(-x)) / zeta, x = t / tau_k, zeta = 1 + lambda_r tau_k.
Real mode(Real lambda_t, Real zeta, Real x) {
  const Real grown = zeta * x;
  if (grown == 0.0) {
    return x * std::exp(-x);
  }
  const Real difference = std::abs(grown) < 1.0 ? std::exp(-x) * std::expm1(grown)
                                                : std::exp(lambda_t) - std::exp(-x);
  return difference / zeta;
}

}  // namespace

TermValues recovered_freely(const RelaxationTimes& times, const TermValues& relaxed_n,
                            const TermValues& relaxing, Real time_s) noexcept {
  const Real most = relaxed_n.maxCoeff();
  if (!(most > 0.0) || !(time_s > 0.0)) {
    return relaxed_n;
  }
  // For short times sums of nearly equal exponentials lose digits; the series does not.
  if (time_s * times.rate_hz(0) <= kShort) {
    return recovered_soon(times, relaxed_n, relaxing, time_s);
  }
  const TermValues x = time_s * times.rate_hz;
  // q_k(t) = q_k(0) e^(-t/tau_k) + sum_r c_r (e^(lambda_r t) - e^(-t/tau_k)) / zeta_rk.
  TermValues after = relaxed_n * (-x).exp();
  for (Eigen::Index r = 0; r < times.terms; ++r) {
    if (!(relaxing(r) > kNoShare)) {
      continue;
    }
    const Real zeta_r = root(times, relaxing, r);
    // c_r = along / length, left = g_k tau_k / zeta_rk the left eigenvector's entry.
    Real along = 0.0;
    Real length = 0.0;
    for (Eigen::Index k = 0; k < times.terms; ++k) {
      if (relaxing(k) > kNoShare) {
        const Real z = zeta_of(times.tau_s, r, k, zeta_r);
        const Real left = relaxing(k) * times.tau_s(k) / z;
        along += left * relaxed_n(k);
        length += left / z;
      }
    }
    for (Eigen::Index k = 0; k < times.terms; ++k) {
      const Real z = zeta_of(times.tau_s, r, k, zeta_r);
      after(k) += along / length * mode((zeta_r - 1.0) * x(r), z, x(k));
    }
  }
  // Every q_k stays in [0, largest q], for s = sum g_k q_k with sum g_k <= 1 does.
  return after.max(Real(0.0)).min(most);
}

}  // namespace palpate
