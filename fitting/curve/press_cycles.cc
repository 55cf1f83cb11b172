#include "fitting/curve/press_cycles.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "fitting/curve/power_law_fit.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

// The samples with the approach's signs, their force counted from the fit's baseline.
Measurement above_baseline(const Measurement& press, const Approach& approach,
                           const ContactFit& fit) {
  Measurement m = turned(press, approach);
  for (std::size_t i = 0; i < m.force_n.size(); ++i) {
    m.force_n[i] -= fit.parameters[0].value + fit.parameters[1].value * m.depth_m[i];
  }
  return m;
}

double work_j(const Approach& approach) {
  double work = 0.0;
  for (std::size_t i = 1; i < approach.force_n.size(); ++i) {
    work += 0.5 * (approach.force_n[i] + approach.force_n[i - 1]) *
            (approach.displacement_m[i] - approach.displacement_m[i - 1]);
  }
  return work;
}

CycleSummary summarise(const Measurement& press, const FrameCompliance* frame) {
  CycleSummary cycle;
  const Approach raw = select_approach(press, {}, {}, frame);
  const ContactFit fit = fit_contact(raw);
  if (fit.has(FitFlag::kEmptyRun)) {
    cycle.bad = "empty run";
    return cycle;
  }
  cycle.contact_point_m = fit.contact.m;
  cycle.contact_point_sd_m = fit.contact.sd_m;
  // Forces from the fitted baseline, so that the loop's works are those of contact
  // alone.
  const Approach approach =
      select_approach(above_baseline(press, raw, fit), {}, {}, frame);
  cycle.peak_force_n =
      *std::max_element(approach.force_n.begin(), approach.force_n.end());
  if (approach.release_work_j == 0.0) {
    cycle.press_work_j = work_j(approach);
    return cycle;
  }
  // Loss factor: (W_press - W_release) / (pi (W_press + W_release)).
  cycle.press_work_j = approach.press_work_j;
  cycle.loss_j = approach.press_work_j - approach.release_work_j;
  cycle.loss_factor =
      cycle.loss_j /
      (std::numbers::pi * (approach.press_work_j + approach.release_work_j));
  return cycle;
}

}  // namespace

CycleChoice parse_cycle(std::string_view text) {
  if (text == "first") {
    return {CycleChoice::Kind::kFirst};
  }
  if (text == "last") {
    return {CycleChoice::Kind::kLast};
  }
  if (text == "all") {
    return {CycleChoice::Kind::kAll};
  }
  CycleChoice choice{CycleChoice::Kind::kNumber, 0};
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), choice.number);
  if (error != std::errc() || end != text.data() + text.size() || choice.number < 1) {
    throw InputError(fmt::format(
        "cycle is \"{}\", must be first, last, all, or a number from 1 on", text));
  }
  return choice;
}

std::string cycle_text(const CycleChoice& choice) {
  switch (choice.kind) {
    case CycleChoice::Kind::kFirst:
      return "first";
    case CycleChoice::Kind::kLast:
      return "last";
    case CycleChoice::Kind::kAll:
      return "all";
    case CycleChoice::Kind::kNumber:
      break;
  }
  return std::to_string(choice.number);
}

std::vector<std::size_t> chosen_cycles(const CycleChoice& choice, std::size_t presses) {
  if (choice.kind == CycleChoice::Kind::kFirst) {
    return {1};
  }
  if (choice.kind == CycleChoice::Kind::kLast) {
    return {presses};
  }
  if (choice.kind == CycleChoice::Kind::kNumber) {
    if (choice.number > presses) {
      throw InputError(fmt::format("cycle {} is wanted, the file has {} press{}",
                                   choice.number, presses, presses == 1 ? "" : "es"));
    }
    return {choice.number};
  }
  std::vector<std::size_t> all;
  for (std::size_t k = 1; k <= presses; ++k) {
    all.push_back(k);
  }
  return all;
}

std::vector<CycleSummary> summarise_cycles(const std::vector<Measurement>& presses,
                                           const FrameCompliance* frame) {
  std::vector<CycleSummary> cycles;
  for (const Measurement& press : presses) {
    if (presses.size() < 2) {
      break;
    }
    try {
      cycles.push_back(summarise(press, frame));
    } catch (const Error& error) {
      cycles.emplace_back().bad = error.what();
    }
  }
  for (CycleSummary& cycle : cycles) {
    cycle.contact_shift_m = cycle.contact_point_m - cycles.back().contact_point_m;
    cycle.contact_shift_sd_m =
        &cycle == &cycles.back()
            ? 0.0
            : std::hypot(cycle.contact_point_sd_m, cycles.back().contact_point_sd_m);
  }
  return cycles;
}

}  // namespace palpate
