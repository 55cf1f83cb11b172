#include "precompute/press/recipe.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace palpate {
namespace {

constexpr int kFinerForTouch = 3;  // meshes, each twice as fine
constexpr int kCoarserToEnd = 2;   // meshes, each twice as coarse

// Near fields that are too small.
constexpr int kWidenings = 2;
constexpr double kWiderShare = 0.3;

// All depths of a path that is hard to follow cost as much as many presses. They are
// solved only where so many times the usual error would be stated otherwise.
constexpr double kHardErrorTimes = 2.0;

int count(std::span<const Attempt> tried, Reason reason) {
  return static_cast<int>(
      std::count_if(tried.begin(), tried.end(), [&](const Attempt& attempt) {
        return attempt.reason == reason;
      }));
}

std::optional<Attempt> wider_near_field(std::span<const Attempt> tried,
                                        const PressPolicy& policy) {
  const Attempt& last = tried.back();
  if (last.outcome.failed ||
      !(last.outcome.far_excess_relative > policy.far_excess_max) ||
      count(tried, Reason::kFarExcess) == kWidenings) {
    return std::nullopt;
  }
  Attempt wider{.recipe = last.recipe, .reason = Reason::kFarExcess};
  wider.recipe.near_gradient = kWiderShare * last.outcome.near_gradient;
  return wider;
}

std::optional<Attempt> every_depth(std::span<const Attempt> tried,
                                   const PressPolicy& policy) {
  const Attempt& best = tried[last_taken(tried)];
  const double error_max =
      (best.outcome.near_singular ? kHardErrorTimes : 1.0) * policy.depth_error_max;
  if (best.recipe.depths == SolvedDepths::kEvery ||
      count(tried, Reason::kBetweenDepths) > 0 ||
      !(best.outcome.between_error > error_max)) {
    return std::nullopt;
  }
  Attempt every{.recipe = best.recipe, .reason = Reason::kBetweenDepths};
  every.recipe.depths = SolvedDepths::kEvery;
  every.recipe.stiff = every.recipe.stiff || best.outcome.near_singular;
  return every;
}

std::optional<Attempt> finer_mesh(std::span<const Attempt> tried,
                                  const PressPolicy& policy) {
  const int finer = count(tried, Reason::kTouchesLate);
  const bool in_vain = std::any_of(tried.begin(), tried.end(), [](const Attempt& one) {
    return one.reason == Reason::kTouchesLate && !one.taken;
  });
  const Outcome& best = tried[last_taken(tried)].outcome;
  if (best.failed || !best.late || finer == kFinerForTouch || in_vain ||
      count(tried, Reason::kFailed) > 0) {
    return std::nullopt;
  }
  Attempt attempt{.recipe = policy.first, .reason = Reason::kTouchesLate};
  attempt.recipe.times_finer *= std::ldexp(1.0, finer + 1);
  return attempt;
}

std::optional<Attempt> coarser_mesh(std::span<const Attempt> tried,
                                    const PressPolicy& policy) {
  const int coarser = count(tried, Reason::kFailed);
  if (!policy.nonlinear || !tried[last_taken(tried)].outcome.failed ||
      coarser == kCoarserToEnd) {
    return std::nullopt;
  }
  Attempt attempt{.recipe = policy.first, .reason = Reason::kFailed};
  attempt.recipe.times_finer *= std::ldexp(1.0, -(coarser + 1));
  attempt.recipe.depths = SolvedDepths::kEvery;
  attempt.recipe.stiff = true;
  return attempt;
}

// Attempts on the mesh of the last.
std::span<const Attempt> on_last_mesh(std::span<const Attempt> tried) {
  std::size_t first = tried.size() - 1;
  while (first > 0 && keeps_mesh(tried[first].reason)) {
    --first;
  }
  return tried.subspan(first);
}

const char* text_of(Reason reason) {
  switch (reason) {
    case Reason::kFirst:
      return "";
    case Reason::kNoMesh:
      return "the mesh cannot be made";
    case Reason::kTouchesLate:
      return "touches late";
    case Reason::kFailed:
      return "failed";
    case Reason::kFarExcess:
      return "nonlinear beyond the near field";
    case Reason::kBetweenDepths:
      return "solved depths do not tell those between them";
    case Reason::kOutsideBudget:
      return "outside the budget";
  }
  return "";
}

std::string mesh_text(double times_finer) {
  if (times_finer == 1.0) {
    return "mesh as fine as usual";
  }
  return times_finer < 1.0 ? fmt::format("mesh {:.3g} times coarser", 1.0 / times_finer)
                           : fmt::format("mesh {:.3g} times finer", times_finer);
}

// What the recipe changes.
std::string text_of(const Attempt& attempt) {
  if (attempt.reason == Reason::kFarExcess) {
    return fmt::format("near field from a gradient of {:.3g} on",
                       attempt.recipe.near_gradient);
  }
  std::string text = attempt.reason == Reason::kBetweenDepths
                         ? ""
                         : mesh_text(attempt.recipe.times_finer);
  if (attempt.recipe.depths == SolvedDepths::kEvery) {
    text += text.empty() ? "every depth" : ", every depth";
  }
  return text + (attempt.recipe.stiff ? ", stiff contact" : "");
}

}  // namespace

bool keeps_mesh(Reason reason) {
  return reason != Reason::kTouchesLate && reason != Reason::kFailed &&
         reason != Reason::kOutsideBudget;
}

std::optional<Attempt> next(std::span<const Attempt> tried, const PressPolicy& policy) {
  const std::span<const Attempt> here = on_last_mesh(tried);
  // A mesh that was not taken is left.
  if (policy.nonlinear && here[last_taken(here)].taken) {
    if (auto wider = wider_near_field(here, policy)) {
      return wider;
    }
    if (auto every = every_depth(here, policy)) {
      return every;
    }
  }
  auto finer = finer_mesh(tried, policy);
  return finer ? finer : coarser_mesh(tried, policy);
}

bool is_better(const Outcome& before, Reason reason, const Outcome& again) {
  const bool farther = again.samples > before.samples;
  switch (reason) {
    case Reason::kFirst:
    case Reason::kNoMesh:
      return true;
    case Reason::kFarExcess:
    case Reason::kBetweenDepths:
      return before.failed || !again.failed;
    case Reason::kTouchesLate:
      return again.samples > 1 && (!again.failed || farther);
    case Reason::kFailed:
      // A coarser mesh on which the tool meets nothing is no answer.
      return again.samples > 1 && ((!again.failed && !again.late) || farther);
    case Reason::kOutsideBudget:
      return again.samples > 1 && !again.failed &&
             (before.late || again.error_relative < before.error_relative);
  }
  return false;
}

std::size_t last_taken(std::span<const Attempt> tried) {
  std::size_t last = tried.size() - 1;
  while (last > 0 && !tried[last].taken) {
    --last;
  }
  return last;
}

bool is_alone(std::span<const Attempt> tried) {
  return std::any_of(tried.begin(), tried.end(), [](const Attempt& attempt) {
    return attempt.taken && !keeps_mesh(attempt.reason);
  });
}

std::string history_text(std::span<const Attempt> tried) {
  std::string text;
  for (const Attempt& attempt : tried) {
    if (attempt.reason != Reason::kFirst) {
      text +=
          fmt::format("{}{}: {}{}", text.empty() ? "" : "; ", text_of(attempt.reason),
                      text_of(attempt), attempt.taken ? "" : ", not taken");
    }
  }
  return text;
}

}  // namespace palpate
