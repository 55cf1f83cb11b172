#include "fitting/curve/power_law_fit.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include <Eigen/Core>
#include <fmt/format.h>

#include "fitting/curve/free_travel.h"
#include "fitting/curve/power_law_once.h"
#include "fitting/curve/power_law_search.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kBeginnings[] = {0.4, 0.15, 0.05};  // [-] of the force's range
constexpr double kFreeDeviations = 3.0;

// The steepest drift of an approach [N/m].
double drift_max_n_per_m(const Approach& approach) {
  return kDriftShareMax * extent(running_median(approach.force_n, 2)) /
         extent(approach.displacement_m);
}

// Up to where the force has risen by a share of its range; with what is known of it.
Approach beginning_of(const Approach& approach, double share) {
  const std::vector<double> smooth = running_median(approach.force_n, 2);
  const auto [low, high] = std::minmax_element(smooth.begin(), smooth.end());
  const double limit = *low + share * (*high - *low);
  const auto end = std::find_if(smooth.begin(), smooth.end(),
                                [&](double force) {
                                  return force > limit;
                                }) -
                   smooth.begin();
  Approach part = approach;
  part.displacement_m.resize(static_cast<std::size_t>(end));
  part.force_n.resize(static_cast<std::size_t>(end));
  return part;
}

std::size_t samples_in_contact(const Approach& approach, const ContactFit& fit) {
  return static_cast<std::size_t>(std::count_if(
      approach.displacement_m.begin(), approach.displacement_m.end(), [&](double x) {
        return x > fit.contact_point_m;
      }));
}

// The law for the curve's beginning up to a share of the force, a drift within what the
// whole curve allows; none where that has no contact point.
std::optional<ContactFit> fit_share(const Approach& approach,
                                    const ContactFitOptions& options, double share) {
  const Approach part = beginning_of(approach, share);
  if (part.force_n.size() < 2 * kSamplesMin || !(extent(part.displacement_m) > 0.0)) {
    return std::nullopt;
  }
  ContactFit fit = fit_once(part, {.noise_relative = options.noise_relative},
                            drift_max_n_per_m(approach));
  const bool found = fit.converged && !fit.has(FitFlag::kEmptyRun) &&
                     !fit.has(FitFlag::kAlreadyInContact) &&
                     samples_in_contact(part, fit) >= kSamplesMin;
  return found ? std::optional(std::move(fit)) : std::nullopt;
}

// The longest beginning that the law does not miss; none where it misses them all. Its
// contact point is known no better than it agrees with those of the whole curve and of
// the next longer and shorter beginning.
std::shared_ptr<const ContactFit> fit_beginning(const Approach& approach,
                                                const ContactFitOptions& options,
                                                const ContactFit& whole) {
  std::vector<double> others_m{whole.contact_point_m};
  for (auto share = std::begin(kBeginnings); share != std::end(kBeginnings); ++share) {
    std::optional<ContactFit> fit = fit_share(approach, options, *share);
    if (!fit) {
      continue;
    }
    // A beginning that the law may miss is passed over; its contact point is kept to
    // compare.
    if (may_miss(fit->misfit, *share * extent(approach.force_n))) {
      others_m.assign({whole.contact_point_m, fit->contact_point_m});
      continue;
    }
    const auto next = std::next(share);
    if (next != std::end(kBeginnings)) {
      if (const auto shorter = fit_share(approach, options, *next)) {
        others_m.push_back(shorter->contact_point_m);
      }
    }
    double apart_m = 0.0;
    for (const double other_m : others_m) {
      apart_m = std::max(apart_m, std::abs(fit->contact_point_m - other_m));
    }
    fit->contact.sd_m = std::hypot(fit->contact_point_sd_m, apart_m);
    return std::make_shared<const ContactFit>(std::move(*fit));
  }
  return nullptr;
}

void take_beginning(ContactFit& fit) {
  std::erase(fit.flags, FitFlag::kContactPointNotIdentified);
  if (fit.beginning) {
    fit.contact = fit.beginning->contact;
  }
  if (!fit.beginning || !is_known(fit)) {
    fit.flags.push_back(FitFlag::kContactPointNotIdentified);
  }
}

// [m] Displacements that are surely free, where the whole law has found none.
std::optional<double> free_until_m(const Approach& approach,
                                   const std::shared_ptr<const ContactFit>& beginning) {
  return beginning ? std::optional(beginning->contact_point_m -
                                   kFreeDeviations * beginning->contact_point_sd_m)
                   : flat_until_m(approach);
}

ContactFit fit_as_is(const Approach& approach, const ContactFitOptions& options);

// Of what precedes the first fall, where the law takes that for free travel: a dome
// before its end stop, a break.
std::shared_ptr<const ContactFit> fit_before_fall(const Approach& approach,
                                                  const ContactFitOptions& options) {
  const auto part = before_fall(approach);
  if (!part) {
    return nullptr;
  }
  ContactFit fit = fit_as_is(*part, {.noise_relative = options.noise_relative});
  if (!fit.converged || fit.has(FitFlag::kEmptyRun)) {
    return nullptr;
  }
  if (fit.beginning) {
    return fit.beginning;
  }
  if (fit.has(FitFlag::kContactPointNotIdentified)) {
    fit.contact.sd_m = std::numeric_limits<double>::quiet_NaN();
  }
  return std::make_shared<const ContactFit>(std::move(fit));
}

// What a law that misses says of the drift and of where it begins is led by what it
// misses: the drift stays within its bound, and where that leaves no free travel but
// the beginning has some, contact is not before that.
ContactFit fit_led_astray(const Approach& approach, const ContactFitOptions& options,
                          ContactFit fit) {
  const double drift_max = drift_max_n_per_m(approach);
  if (fit.parameters[1].value > drift_max && fit.parameters[1].held.empty()) {
    fit = fit_once(approach, options, drift_max);
  }
  fit.beginning = fit_beginning(approach, options, fit);
  const auto free_m = fit.has(FitFlag::kAlreadyInContact)
                          ? free_until_m(approach, fit.beginning)
                          : std::nullopt;
  if (free_m) {
    Approach limited = approach;
    limited.contact_from_m = *free_m;
    fit = fit_once(limited, options, drift_max);
    fit.beginning = fit_beginning(limited, options, fit);
  }
  if (!fit.beginning && !options.exponent) {
    fit.beginning = fit_before_fall(approach, options);
  }
  if (!options.exponent && !fit.has(FitFlag::kAlreadyInContact)) {
    take_beginning(fit);
  }
  return fit;
}

bool is_fitted(const ContactFit& fit) {
  return fit.converged && !fit.has(FitFlag::kEmptyRun);
}

// A steeper one is the body: then nothing is known to be free.
bool may_be_drift(const Approach& approach, const ContactFit& fit) {
  return fit.parameters[kBaselineSlope].value <= drift_max_n_per_m(approach);
}

bool follows(const Approach& approach, ContactFit& fit) {
  if (!is_led_astray(approach, fit)) {
    return true;
  }
  if (!may_be_drift(approach, fit) || !explain_by_free_travel(approach, fit)) {
    return false;
  }
  std::erase(fit.flags, FitFlag::kMisfit);
  return true;
}

ContactFit fit_as_is(const Approach& approach, const ContactFitOptions& options) {
  ContactFit fit = fit_once(approach, options);
  return !is_fitted(fit) || follows(approach, fit)
             ? fit
             : fit_led_astray(approach, options, std::move(fit));
}

// A bend of the drift that the law has not moves its contact point; without the bend
// the law follows the curve.
bool explain_by_bend(const DriftBend& bend, const ContactFitOptions& options,
                     ContactFit& fit) {
  std::array<ContactFit, 2> other;
  std::array<double, 2> moved_m{};
  for (std::size_t k = 0; k < 2; ++k) {
    other[k] = fit_once(bend.straight[k], options);
    if (!is_fitted(other[k])) {
      return false;
    }
    // How far the contact point moves if the bend is taken off in either way.
    moved_m[k] = other[k].contact.m - fit.contact.m;
  }
  const auto best = static_cast<std::size_t>(other[1].rms_n < other[0].rms_n);
  if (!follows(bend.straight[best], other[best])) {
    return false;
  }
  fit.contact.sd_m = fit.contact_point_sd_m = fit.parameters[kContact].sd =
      std::hypot(fit.contact.sd_m, bend_sd(bend, fit, other, moved_m));
  if (!is_known(fit) && !fit.has(FitFlag::kContactPointNotIdentified)) {
    fit.flags.push_back(FitFlag::kContactPointNotIdentified);
  }
  // A sure bend replaces the misfit: without the bend the law follows.
  if (bend.is_sure()) {
    fit.misfit = other[best].misfit;
    fit.free_to_m = other[best].free_to_m;
    std::erase(fit.flags, FitFlag::kMisfit);
  }
  return true;
}

}  // namespace

bool ContactFit::has(FitFlag flag) const {
  return std::find(flags.begin(), flags.end(), flag) != flags.end();
}

ContactFit fit_contact(const Approach& approach, const ContactFitOptions& options) {
  if (options.exponent &&
      !(*options.exponent >= kExponentMin && *options.exponent <= kExponentMax)) {
    throw InputError(fmt::format("exponent {} is outside [{}, {}]", *options.exponent,
                                 kExponentMin, kExponentMax));
  }
  const auto begin = std::chrono::steady_clock::now();
  ContactFit fit = fit_once(approach, options);
  const auto bend = is_fitted(fit) && may_be_drift(approach, fit)
                        ? bend_of_drift(approach, fit)
                        : std::nullopt;
  const bool bent = bend && explain_by_bend(*bend, options, fit);
  const bool done =
      !is_fitted(fit) || (bent && bend->is_sure()) || follows(approach, fit);
  if (!done) {
    fit = fit_led_astray(approach, options, std::move(fit));
  }
  fit.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return fit;
}

double contact_force_n(const ContactFit& fit, double depth_m) {
  return depth_m > 0.0 ? fit.coefficient * std::pow(depth_m, fit.exponent) : 0.0;
}

}  // namespace palpate
