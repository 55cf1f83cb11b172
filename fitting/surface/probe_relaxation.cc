#include "fitting/surface/probe_relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "fitting/curve/time_effects.h"
#include "fitting/numerics/robust_statistics.h"
#include "formats/database/table_memory.h"

namespace palpate {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kShortShare = 0.5;  // [-] of the median hold
constexpr int kHoldTimes = 96;       // from a thousandth of the hold, evenly in its log

void append(PronyTerms& terms, const Relaxation* r) {
  terms.g_1.push_back(r != nullptr ? r->g[0] : kUnknown);
  terms.g_2.push_back(r != nullptr ? r->g[1] : kUnknown);
  terms.tau_1_s.push_back(r != nullptr ? r->tau_s[0] : kUnknown);
  terms.tau_2_s.push_back(r != nullptr ? r->tau_s[1] : kUnknown);
}

std::vector<double> member_of(const std::vector<const Relaxation*>& holds,
                              double Relaxation::*member) {
  std::vector<double> values;
  for (const Relaxation* hold : holds) {
    values.push_back(hold->*member);
  }
  return values;
}

// What is left of the force after a press at a speed [m/s]. The hold's own terms hold
// for its own press; where press and hold were fitted together, what another speed
// makes of them is known.
double share_left(const Relaxation& r, const PronyTerms& own, std::size_t row,
                  double speed_m_per_s, double time_s) {
  const double share = relaxed_share(own, row, time_s);
  return r.joint.refused.empty() ? share * held_share(r.joint, speed_m_per_s, time_s) /
                                       held_share(r.joint, r.speed_m_per_s, time_s)
                                 : share;
}

// Two terms of the median over several holds at equal times, from 0 to the end.
// @param share of hold i at a time. @param last the holds' shares at the end.
template <typename Share>
Relaxation median_relaxation(std::size_t holds, double seconds, const Share& share_of,
                             std::vector<double>& last) {
  std::vector<double> time_s{0.0}, share{1.0};
  last.assign(holds, 1.0);
  for (int k = 0; k <= kHoldTimes; ++k) {
    time_s.push_back(seconds *
                     std::pow(1e-3, 1.0 - static_cast<double>(k) / kHoldTimes));
    for (std::size_t i = 0; i < holds; ++i) {
      last[i] = share_of(i, time_s.back());
    }
    share.push_back(median(last));
  }
  return fit_relaxation(time_s, share);
}

std::vector<const Relaxation*> holds_of(
    const std::vector<const SurfaceProbe*>& probes) {
  std::vector<const Relaxation*> holds;
  for (const SurfaceProbe* probe : probes) {
    holds.push_back(&*probe->relaxation);
  }
  return holds;
}

double shortest_s(const std::vector<const Relaxation*>& holds) {
  const std::vector<double> lengths_s = member_of(holds, &Relaxation::seconds);
  return *std::min_element(lengths_s.begin(), lengths_s.end());
}

// Probes whose holds can be compared.
std::vector<const SurfaceProbe*> comparable(
    const std::vector<const SurfaceProbe*>& probes) {
  std::vector<const SurfaceProbe*> held;
  for (const SurfaceProbe* probe : probes) {
    if (probe->relaxation && probe->relaxation->speed_m_per_s > 0.0) {
      held.push_back(probe);
    }
  }
  if (!held.empty()) {
    const double shortest =
        kShortShare * median(member_of(holds_of(held), &Relaxation::seconds));
    std::erase_if(held, [&](const SurfaceProbe* probe) {
      return probe->relaxation->seconds < shortest;
    });
  }
  return held;
}

}  // namespace

RunRelaxation run_relaxation(std::span<const SurfaceProbe> probes) {
  RunRelaxation runs;
  bool any = false;
  for (const SurfaceProbe& probe : probes) {
    const Relaxation* r = probe.relaxation && probe.relaxation->speed_m_per_s > 0.0
                              ? &*probe.relaxation
                              : nullptr;
    any = any || r != nullptr;
    append(runs.terms, r);
    runs.speed_m_per_s.push_back(r != nullptr ? r->speed_m_per_s : kUnknown);
    runs.seconds.push_back(r != nullptr ? r->seconds : kUnknown);
    runs.rms_relative.push_back(r != nullptr ? r->rms_relative : kUnknown);
  }
  return any ? runs : RunRelaxation{};
}

ResponseRelaxation common_relaxation(const std::vector<const SurfaceProbe*>& probes) {
  const std::vector<const Relaxation*> holds = holds_of(comparable(probes));
  if (holds.empty()) {
    return {};
  }
  PronyTerms own;
  for (const Relaxation* hold : holds) {
    append(own, hold);
  }
  // Only times that every hold has are compared.
  const double seconds = shortest_s(holds);
  const double speed = median(member_of(holds, &Relaxation::speed_m_per_s));
  std::vector<double> shares;
  const Relaxation fit = median_relaxation(
      holds.size(), seconds,
      [&](std::size_t i, double time_s) {
        return share_left(*holds[i], own, i, speed, time_s);
      },
      shares);
  ResponseRelaxation common;
  common.rule = fmt::format(
      "two terms fitted to the median over the probes, at equal times, of what each "
      "one's own let stay after a press at the common speed; the same at every node; "
      "after {:.3g} s the probes' shares "
      "have a robust standard deviation of {:.2g}",
      seconds, shares.size() > 1 ? robust_standard_deviation(shares) : 0.0);
  common.probes = std::ssize(holds);
  common.speed_m_per_s = speed;
  common.seconds = seconds;
  append(common.terms, &fit);
  return common;
}

std::vector<const SurfaceProbe*> held_with_press(
    const std::vector<const SurfaceProbe*>& probes) {
  std::vector<const SurfaceProbe*> held = comparable(probes);
  const std::size_t all = held.size();
  std::erase_if(held, [](const SurfaceProbe* probe) {
    return !probe->relaxation->joint.refused.empty();
  });
  return 2 * held.size() < all ? std::vector<const SurfaceProbe*>{} : held;
}

Viscoelasticity common_viscoelasticity(const std::vector<const SurfaceProbe*>& probes) {
  const std::vector<const Relaxation*> holds = holds_of(held_with_press(probes));
  if (holds.empty()) {
    return {};
  }
  // The share that stays: 1 - sum g_k (1 - exp(-t / tau_k)) of each probe's joint fit.
  const double seconds = shortest_s(holds);
  std::vector<double> shares;
  const Relaxation fit = median_relaxation(
      holds.size(), seconds,
      [&](std::size_t i, double time_s) {
        return 1.0 - relaxed_within(holds[i]->joint, time_s).value;
      },
      shares);
  Viscoelasticity common;
  common.rule = fmt::format(
      "two terms fitted to the median over the probes of the relaxation that each "
      "one's "
      "press and hold showed together, up to {:.3g} s; the same at every node; the "
      "probes' shares then have a robust standard deviation of {:.2g}",
      seconds, shares.size() > 1 ? robust_standard_deviation(shares) : 0.0);
  common.probes = std::ssize(holds);
  common.speed_m_per_s = median(member_of(holds, &Relaxation::speed_m_per_s));
  common.error_relative = {static_cast<float>(fit.rms_relative)};
  // Two equal times are one term with both shares.
  const bool alike = !(fit.tau_s[1] > fit.tau_s[0]) || fit.g[1] == 0.0;
  const Eigen::Index terms = alike ? 1 : 2;
  common.tau_s.assign(fit.tau_s.begin(), fit.tau_s.begin() + terms);
  common.g.resize(1, terms);
  for (Eigen::Index k = 0; k < terms; ++k) {
    common.g(0, k) = static_cast<float>(fit.g[static_cast<std::size_t>(k)]);
  }
  if (fit.tau_s[1] == fit.tau_s[0]) {
    common.g(0, 0) += static_cast<float>(fit.g[1]);
  }
  return common;
}

RelaxationFieldReport keep_relaxation(const std::vector<const SurfaceProbe*>& probes,
                                      ResponseDatabase& database) {
  ResponseTable& table = database.tools.front();
  const RelaxationField found = relaxation_field(database.body, held_with_press(probes),
                                                 common_viscoelasticity(probes));
  give_memory(database.body, database.normal, found.relaxation, 1, table);
  if (table.viscoelasticity.empty()) {
    table.relaxation = common_relaxation(probes);
  }
  return found.report;
}

std::string relaxation_text(const ResponseRelaxation& shown,
                            const Viscoelasticity& rendered,
                            const RelaxationFieldReport& field) {
  std::string text = fmt::format(
      "relaxation: {}\n",
      shown.empty() ? "no probe was held with its time known" : describe(shown));
  if (!rendered.empty()) {
    text += fmt::format("rendered: {}\n", describe(rendered, share_extent(rendered)));
  }
  return text + describe(field);
}

}  // namespace palpate
