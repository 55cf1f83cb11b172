#include "runtime/account/safety.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {
namespace {

// Largest part of the energies that ever went through the account that may be missing
// for rounding, and the same in absolute terms.
constexpr double kMissingShare = rounding(1e-9, 1e-6);
constexpr double kMissingJ = rounding(1e-9, 1e-6);

// Each wrench, or the force, to a length.
template <int kSize>
Eigen::Matrix<Real, kSize, 1> clamp_length(const Eigen::Matrix<Real, kSize, 1>& v,
                                           Real length_max) {
  constexpr int kPart = std::min(kSize, 6);
  Eigen::Matrix<Real, kSize, 1> clamped = v;
  for (int i = 0; i < kSize; i += kPart) {
    const auto part = v.template segment<kPart>(i);
    if (part.squaredNorm() > length_max * length_max) {
      clamped.template segment<kPart>(i) = part * (length_max / part.norm());
    }
  }
  return clamped;
}

// Largest force that may leave [N]: all of it after the start-up ramp.
Real force_allowed_n(const SafetyLimits& limits, Real age_s) {
  return age_s < limits.ramp_s ? limits.force_max_n * (age_s / limits.ramp_s)
                               : limits.force_max_n;
}

bool account_holds(const PassivityLedger& ledger, double owed_j, double floor_j) {
  const double tolerance =
      kMissingJ + kMissingShare * (ledger.stored_j + ledger.dissipated_j);
  return std::abs(imbalance_j(ledger)) <= tolerance && ledger.created_j <= tolerance &&
         ledger.tank_j >= 0 && allowance_j(ledger) - owed_j >= -floor_j;
}

template <int kSize>
Eigen::Matrix<Real, kSize, 1> made_safe(BasicSafetyState<kSize>& state,
                                        const SafetyLimits& limits,
                                        const PassivityLedger& ledger,
                                        const Eigen::Matrix<Real, kSize, 1>& wanted_n,
                                        const Eigen::Matrix<Real, kSize, 1>& moved_m,
                                        Real dt_s) {
  const Real gain_j = (state.delivered_n - state.model_n).dot(moved_m);
  const double dissipated_j = ledger.dissipated_j - state.dissipated_seen_j;
  state.dissipated_seen_j = ledger.dissipated_j;
  if (!wanted_n.allFinite() || !std::isfinite(gain_j)) {
    raise_fault(state, Fault::kNotFinite);
  } else {
    state.owed_j = std::max<double>(0.0, state.owed_j + double(gain_j) - dissipated_j);
  }
  if (state.fault == Fault::kNone && std::isfinite(limits.energy_floor_j) &&
      !account_holds(ledger, state.owed_j, limits.energy_floor_j)) {
    raise_fault(state, Fault::kEnergy);
  }
  if (state.fault != Fault::kNone) {
    state.force_n.setZero();
    state.delivered_n.setZero();
    state.model_n.setZero();
    return state.force_n;
  }
  state.model_n = wanted_n;
  state.age_s += dt_s;
  const Eigen::Matrix<Real, kSize, 1> clamped =
      clamp_length<kSize>(wanted_n, force_allowed_n(limits, state.age_s));
  // An infinite slew limit and dt 0 would be NaN; no time, no change.
  const Real change_max = dt_s > 0.0 ? limits.slew_max_n_per_s * dt_s : 0.0;
  state.force_n += clamp_length<kSize>(clamped - state.force_n, change_max);
  state.delivered_n = state.force_n;
  return state.force_n;
}

}  // namespace

std::string_view name(Fault fault) noexcept {
  constexpr std::array<std::string_view, 10> kNames{
      "none",        "not-finite", "time-step",     "energy", "slow-stalled",
      "device-lost", "deadlines",  "device-silent", "jump",   "slow-wire"};
  const auto i = static_cast<std::size_t>(fault);
  return i < kNames.size() ? kNames[i] : "unknown";
}

Vector3 make_safe(SafetyState& state, const SafetyLimits& limits,
                  const PassivityLedger& ledger, const Vector3& wanted_n,
                  const Vector3& moved_m, Real dt_s) noexcept {
  return made_safe<3>(state, limits, ledger, wanted_n, moved_m, dt_s);
}

WrenchSafety::Vector make_safe(WrenchSafety& state, const SafetyLimits& limits,
                               const PassivityLedger& ledger,
                               const WrenchSafety::Vector& wanted_n,
                               const WrenchSafety::Vector& moved_m,
                               Real dt_s) noexcept {
  return made_safe<12>(state, limits, ledger, wanted_n, moved_m, dt_s);
}

}  // namespace palpate
