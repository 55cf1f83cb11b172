#include "runtime/view/view_friction.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"

namespace palpate {
namespace {

// Part of the limit from which on a contact slips: a slip ends there but for rounding.
constexpr double kSlips = 1.0 - 1e-6;

bool rubs(const FrictionSpring& spring) {
  return spring.n_per_m > 0.0;
}

const char* word(const FrictionSpring& spring) {
  if (!rubs(spring)) {
    return "free";
  }
  return spring.force_n().norm() < kSlips * spring.limit_n ? "sticks" : "slips";
}

nlohmann::json vector_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

nlohmann::json anchor_json(const std::optional<ViewContact>& anchor) {
  if (!anchor) {
    return {};
  }
  return {{"point_m", vector_json(anchor->point_m)},
          {"normal", vector_json(anchor->normal)},
          {"nodes", anchor->node},
          {"shares", vector_json(anchor->share)}};
}

// Three numbers a tick.
std::string vectors_text(const std::vector<RubbedTick>& ticks,
                         Eigen::Vector3d RubbedTick::*of) {
  std::string text;
  for (const RubbedTick& tick : ticks) {
    const Eigen::Vector3d& v = tick.*of;
    fmt::format_to(std::back_inserter(text), "{}{:.6g},{:.6g},{:.6g}",
                   text.empty() ? "" : ",", v.x(), v.y(), v.z());
  }
  return text;
}

}  // namespace

void FrictionTrail::add(const FrictionSeen& seen) {
  if (rubs(seen.spring)) {
    const Eigen::Vector3d moved_m = seen.tool_m - last_.tool_m;
    if (rubs(last_.spring)) {
      slid_m_ += moved_m - moved_m.dot(last_.normal) * last_.normal;
    } else {
      slid_m_.setZero();
    }
    if (ticks_.size() == kTicksKept) {
      ticks_.erase(ticks_.begin());
    }
    ticks_.push_back({.slid_m = slid_m_,
                      .force_n = seen.spring.force_n(),
                      .limit_n = seen.spring.limit_n});
  }
  last_ = seen;
}

ViewFriction FrictionTrail::take() {
  return {.spring = last_.spring, .ticks = std::exchange(ticks_, {})};
}

bool shows_friction(const ResponseTable& table) {
  return table.tool.contact.empty() && table.puncture.empty() &&
         (table.tool.friction > 0.0 ||
          std::any_of(table.friction.begin(), table.friction.end(), [](double mu) {
            return mu > 0.0;
          }));
}

ViewFriction view_friction(FrictionTrail& trail, const ResponseDatabase& database,
                           const ToolShape& tool, const SurfaceSearch& search,
                           std::int32_t from) {
  ViewFriction friction = trail.take();
  if (rubs(friction.spring)) {
    friction.anchor = view_contact(database, tool, search,
                                   trail.tool_m() - friction.spring.stretch_m, from);
  }
  return friction;
}

std::string friction_text(const ViewFriction& friction) {
  const FrictionSpring& spring = friction.spring;
  const bool any = rubs(spring);
  std::string text = json_text(nlohmann::json{
      {"state", word(spring)},
      {"stretch_m", vector_json(any ? spring.stretch_m : Vector3::Zero())},
      {"force_n", vector_json(any ? spring.force_n() : Vector3::Zero())},
      {"limit_n", any ? spring.limit_n : 0.0},
      {"n_per_m", spring.n_per_m},
      {"anchor", anchor_json(friction.anchor)}});
  text.pop_back();
  text += ",\"trace\":{\"slid_m\":[" +
          vectors_text(friction.ticks, &RubbedTick::slid_m) + "],\"force_n\":[" +
          vectors_text(friction.ticks, &RubbedTick::force_n) + "],\"limit_n\":[";
  for (const RubbedTick& tick : friction.ticks) {
    fmt::format_to(std::back_inserter(text), "{}{:.6g}",
                   &tick == friction.ticks.data() ? "" : ",", tick.limit_n);
  }
  return text + "]}}";
}

}  // namespace palpate
