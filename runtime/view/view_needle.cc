#include "runtime/view/view_needle.h"

#include <algorithm>
#include <cstddef>

#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/response/tool_support.h"
#include "formats/response/turn_from_z.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

const Channel* along(const ViewNeedle& needle) {
  return needle.along < 0
             ? nullptr
             : &needle.state.channel[static_cast<std::size_t>(needle.along)];
}

Json numbers(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

Json channel_json(const Channel& channel, double tip_below_m) {
  Json begins = Json::array(), materials = Json::array();
  Json broke_m = Json::array(), broke_n = Json::array();
  for (std::int32_t k = 0; k < channel.layers.layers; ++k) {
    const auto i = static_cast<std::size_t>(k);
    begins.push_back(channel.layers.depth_m[i]);
    materials.push_back(channel.layers.material[i]);
    if (k <= channel.layer) {
      const bool known = channel.broke[i].force_n > 0.0;
      broke_m.push_back(known ? Json(channel.broke[i].tip_m) : Json());
      broke_n.push_back(known ? Json(channel.broke[i].force_n) : Json());
    }
  }
  return {{"entry_m", numbers(channel.entry_m - tip_below_m * channel.axis)},
          {"axis", numbers(channel.axis)},
          {"depth_m", channel.depth_m},
          {"layers_m", begins},
          {"materials", materials},
          {"broke_m", broke_m},
          {"broke_n", broke_n}};
}

}  // namespace

ViewNeedle view_needle(const NeedleState& state, const ToolShape& tool,
                       const std::optional<ViewNeedle>& before) {
  const std::int32_t last = before ? before->state.active : -1;
  return {.state = state,
          .along = state.active >= 0 ? state.active : last,
          .tip_below_m = nominal_height_m(tool)};
}

double tip_m(const ViewNeedle& needle, const TickRecord& tick) {
  const Channel* channel = along(needle);
  return channel == nullptr
             ? tick.depth_m
             : channel->tip_m(Eigen::Map<const Vector3>(tick.position_m.data()));
}

double axial_n(const ViewNeedle& needle, const TickRecord& tick) {
  const Eigen::Map<const Vector3> force_n(tick.force_n.data());
  const Channel* channel = along(needle);
  return channel == nullptr ? force_n.norm() : channel->axis.dot(force_n);
}

ViewContact tool_contact(const ResponseDatabase& database, const ToolShape& tool,
                         const SurfaceSearch& search, const Eigen::Vector3d& x_m,
                         std::int32_t from, const std::optional<ViewNeedle>& needle) {
  const Channel* in = needle ? channel_of(needle->state) : nullptr;
  if (in == nullptr) {
    return view_contact(database, tool, search, x_m, from);
  }
  ViewContact at = view_contact(database, tool, search, in->entry_m, from);
  at.turn = turn_from_z(in->axis);
  return at;
}

std::string needle_text(const ViewNeedle& needle, const TickRecord& now) {
  const NeedleState& state = needle.state;
  const Channel* in = channel_of(state);
  Json channels = Json::array();
  for (std::int32_t i = 0; i < state.channels; ++i) {
    channels.push_back(
        channel_json(state.channel[static_cast<std::size_t>(i)], needle.tip_below_m));
  }
  return json_text(Json{{"in", state.active},
                        {"axial_n", axial_n(needle, now)},
                        {"inserted_m", in == nullptr ? 0.0 : in->inserted_m},
                        {"membranes", state.broken},
                        {"refused", state.refused},
                        {"crack_j", state.crack_j},
                        {"released_j", state.released_j},
                        {"shaft_j", state.shaft_j},
                        {"channels", channels}});
}

std::string puncture_text(const ResponseTable& table) {
  const Puncture& puncture = table.puncture;
  if (puncture.empty()) {
    return "null";
  }
  double deepest_m = 0.0;
  for (std::int64_t node = 0; node < table.nodes(); ++node) {
    if (!table.curve(node).depth_m.empty()) {
      deepest_m = std::max(deepest_m, last_layer_m(puncture, node));
    }
  }
  return json_text(Json{{"materials", puncture.material},
                        {"deepest_m", deepest_m},
                        {"mouth_m", puncture.mouth_m}});
}

}  // namespace palpate
