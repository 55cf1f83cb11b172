#include "runtime/view/view_friction.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"

namespace palpate {
namespace {

// Part of the limit from which on a contact slips: a slip ends there but for rounding.
constexpr double kSlips = 1.0 - 1e-6;

Eigen::Vector3d vector(const std::array<double, 3>& v) {
  return Eigen::Vector3d(v.data());
}

bool rubs(const FrictionSeen& seen) {
  return seen.n_per_m > 0.0;
}

const char* word(const FrictionSeen& seen) {
  if (!rubs(seen)) {
    return "free";
  }
  return vector(seen.force_n).norm() < kSlips * seen.limit_n ? "sticks" : "slips";
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
  if (rubs(seen)) {
    const Eigen::Vector3d moved_m = vector(seen.tool_m) - vector(last_.tool_m);
    const Eigen::Vector3d normal = vector(last_.normal);
    if (rubs(last_)) {
      slid_m_ += moved_m - moved_m.dot(normal) * normal;
    } else {
      slid_m_.setZero();
    }
    if (ticks_.size() == kTicksKept) {
      ticks_.erase(ticks_.begin());
    }
    ticks_.push_back(
        {.slid_m = slid_m_, .force_n = vector(seen.force_n), .limit_n = seen.limit_n});
  }
  last_ = seen;
}

ViewFriction FrictionTrail::take() {
  return {.now = last_, .anchor = {}, .ticks = std::exchange(ticks_, {})};
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
  const FrictionSeen& now = friction.now;
  if (rubs(now)) {
    friction.anchor = view_contact(database, tool, search,
                                   vector(now.tool_m) - vector(now.stretch_m), from);
  }
  return friction;
}

std::string friction_text(const ViewFriction& friction) {
  const FrictionSeen& now = friction.now;
  std::string text =
      json_text(nlohmann::json{{"state", word(now)},
                               {"stretch_m", now.stretch_m},
                               {"force_n", now.force_n},
                               {"limit_n", now.limit_n},
                               {"n_per_m", now.n_per_m},
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
