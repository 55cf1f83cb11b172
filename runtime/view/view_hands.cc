#include "runtime/view/view_hands.h"

#include <cstddef>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/response/tool_shape.h"
#include "formats/response/tool_support.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

Json xyz(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json item_json(const ViewHand& hand) {
  const Eigen::Quaterniond& q = hand.turn;
  return {{"tool_m", xyz(hand.tool_m)},
          {"turn", std::array<double, 4>{q.x(), q.y(), q.z(), q.w()}},
          {"hand_m", xyz(hand.hand_m)},
          {"pointer_m", xyz(hand.pointer_m)},
          {"holding", hand.holding},
          {"force_n", xyz(hand.force_n)},
          {"torque_n_m", xyz(hand.torque_n_m)},
          {"coupled_n", xyz(hand.coupled_n)},
          {"added_up_n", xyz(hand.added_up_n)}};
}

Json item_json(const ViewTouch& touch) {
  return {{"hand", touch.hand},
          {"radius_m", touch.radius_m},
          {"centre_m", xyz(touch.centre_m)},
          {"point_m", xyz(touch.point_m)},
          {"normal", xyz(touch.normal)},
          {"force_n", xyz(touch.force_n)},
          {"depth_m", touch.depth_m},
          {"own_m", touch.own_m},
          {"nodes", touch.node},
          {"shares", xyz(touch.share)}};
}

template <typename Items>
Json as_list(const Items& items) {
  Json all = Json::array();
  for (const auto& item : items) {
    all.push_back(item_json(item));
  }
  return all;
}

using ThreeOfHand = std::array<double, 3> RecordedHand::*;

// Lengths by tick.
std::string column(const std::vector<TickRecord>& ticks, const char* key,
                   std::size_t hand, ThreeOfHand of) {
  std::string text = fmt::format("\"{}\":[", key);
  for (const TickRecord& tick : ticks) {
    const RecordedHand at = hand_in(tick, hand);
    fmt::format_to(std::back_inserter(text), "{}{:.6g}",
                   &tick == ticks.data() ? "" : ",",
                   Eigen::Map<const Eigen::Vector3d>((at.*of).data()).norm());
  }
  return text + "]";
}

// A tool without a contact set is one sphere of its nominal height.
Json spheres(const ToolShape& tool) {
  if (tool.contact.empty()) {
    return {{{"centre_m", {0.0, 0.0, 0.0}}, {"radius_m", nominal_height_m(tool)}}};
  }
  Json all = Json::array();
  for (std::size_t i = 0; i < tool.contact.radius_m.size(); ++i) {
    const Eigen::Vector3d centre =
        tool.contact.point_m.row(static_cast<Eigen::Index>(i)).transpose();
    all.push_back({{"centre_m", xyz(centre)}, {"radius_m", tool.contact.radius_m[i]}});
  }
  return all;
}

}  // namespace

ViewTouch touch_at(const ResponseDatabase& database, const BodyContact& contact) {
  const ContactPlace& at = contact.at;
  ViewTouch touch{.hand = contact.hand,
                  .radius_m = contact.radius_m,
                  .centre_m = at.centre_m,
                  .point_m = at.point_m,
                  .normal = at.normal,
                  .force_n = at.force_n,
                  .depth_m = at.depth_m,
                  .own_m = at.depth_m - at.dimple_m,
                  .share = at.share};
  for (Eigen::Index j = 0; j < 3; ++j) {
    touch.node[static_cast<std::size_t>(j)] = database.body.triangle(at.triangle, j);
  }
  return touch;
}

std::string hands_text(const ViewHands& hands, const std::vector<TickRecord>& ticks) {
  const Json json{{"hands", as_list(hands.hand)},
                  {"contacts", as_list(hands.touch)},
                  {"coupled", hands.coupled},
                  {"compared", hands.compared},
                  {"scaled", hands.scaled}};
  std::string text = json_text(json);
  text = text.substr(1, text.size() - 2);
  return text + ",\"loads\":{" + column(ticks, "force1_n", 0, &RecordedHand::force_n) +
         "," + column(ticks, "force2_n", 1, &RecordedHand::force_n) + "," +
         column(ticks, "torque1_n_m", 0, &RecordedHand::torque_n_m) + "," +
         column(ticks, "torque2_n_m", 1, &RecordedHand::torque_n_m) + "}";
}

std::string tools_text(const std::vector<const ResponseTable*>& tables) {
  Json all = Json::array();
  for (const ResponseTable* table : tables) {
    all.push_back({{"name", table->tool.name},
                   {"description", describe_tool(table->tool, table->puncture)},
                   {"spheres", spheres(table->tool)},
                   {"coupling_error", table->compliance.error_relative}});
  }
  return json_text(all);
}

}  // namespace palpate
