#include "runtime/view/view_json.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/report/html_page.h"
#include "formats/report/surface_map.h"
#include "formats/response/tool_outline.h"
#include "runtime/realtime/clock.h"
#include "runtime/view/view_message.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little);  // as all browsers' arrays

template <typename T>
void append(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

Json list(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

// Text of a file may be no UTF-8; then its odd bytes are replaced, not thrown at.
std::string dumped(const Json& json) {
  return json_text(json);
}

// What dents hold, by the account.
double memory_j(const TickRecord& t) {
  return std::max(0.0, t.work_j - t.stored_j - t.tank_j - t.dissipated_j);
}

Json as_json(const std::vector<NodeDent>& dents) {
  Json nodes = Json::array();
  Json depths_m = Json::array();
  for (const NodeDent& dent : dents) {
    nodes.push_back(dent.node);
    depths_m.push_back(static_cast<float>(dent.depth_m));
  }
  return {{"node", nodes}, {"depth_m", depths_m}};
}

// Of the tool, of a needle that of its tip.
double depth_m(const ViewFrame& frame, const TickRecord& tick) {
  return frame.needle ? tip_m(*frame.needle, tick)
                      : tick.depth_m + frame.contact.over_nominal_m;
}

// Every tick, as numbers of as many digits as a plot or a table needs.
std::string trace_text(const ViewFrame& frame, const std::vector<TickRecord>& ticks) {
  const auto column = [&](const char* key, auto&& value) {
    std::string text = fmt::format("\"{}\":[", key);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      fmt::format_to(std::back_inserter(text), "{}{:.6g}", i == 0 ? "" : ",",
                     value(ticks[i]));
    }
    return text + "]";
  };
  const auto time_s = [](const TickRecord& t) {
    return static_cast<double>(t.time_ns) / kNanosecondsPerSecond;
  };
  std::string times = "\"time_s\":[";
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    fmt::format_to(std::back_inserter(times), "{}{:.4f}", i == 0 ? "" : ",",
                   time_s(ticks[i]));
  }
  return "{" + times + "]," +
         column("force_n",
                [](const TickRecord& t) {
                  return std::hypot(t.force_n[0], t.force_n[1], t.force_n[2]);
                }) +
         "," +
         column("depth_m",
                [&](const TickRecord& t) {
                  return depth_m(frame, t);
                }) +
         "," +
         column("stored_j",
                [](const TickRecord& t) {
                  return t.stored_j;
                }) +
         "," +
         column("tank_j",
                [](const TickRecord& t) {
                  return t.tank_j;
                }) +
         "," + column("memory_j", memory_j) +
         (frame.needle ? "," + column("axial_n",
                                      [&](const TickRecord& t) {
                                        return axial_n(*frame.needle, t);
                                      })
                       : "") +
         "}";
}

// Of any curve, or that breaks a membrane, as far as it is rendered; 1 N where there is
// none.
double largest_force_n(const ViewedBody& body) {
  double most_n = 0.0;
  for (const auto* all : {&body.table.force_n, &body.table.puncture.membrane_n}) {
    for (const double force_n : *all) {
      most_n = std::isfinite(force_n) ? std::max(most_n, force_n) : most_n;
    }
  }
  return most_n > 0.0 ? std::min(most_n, body.force_max_n) : 1.0;
}

// null for what there is not.
template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json or_null(const std::optional<Eigen::Vector3d>& v) {
  return v ? list(*v) : Json();
}

Json as_json(const ViewRun& run) {
  return {{"ticks", run.ticks},
          {"late_ticks", run.late_ticks},
          {"slow_updates", run.slow_updates},
          {"starved_ticks", run.starved_ticks},
          {"extrapolated_ticks", run.extrapolated_ticks},
          {"step_p50_ns", or_null(run.step_p50_ns)},
          {"step_p99_ns", or_null(run.step_p99_ns)},
          {"depth_max_m", run.depth_max_m},
          {"force_max_n", run.force_max_n}};
}

Json as_json(const ViewSettings& settings) {
  return {{"model", name(settings.model)},
          {"slow_hz", settings.slow_hz},
          {"fast_hz", settings.fast_hz},
          {"stiffness_scale", or_null(settings.stiffness_scale)},
          {"friction", or_null(settings.friction)}};
}

Json as_json(const ViewService& service) {
  return {{"state", service.state},       {"detail", service.detail},
          {"stage", service.stage},       {"nodes", service.nodes},
          {"answered", service.answered}, {"finished", service.finished},
          {"here", service.here},         {"ticks", service.ticks},
          {"changed", service.changed}};
}

Json as_json(const ViewDeviceShown& device) {
  return {{"phase", device.phase},
          {"detail", device.detail},
          {"force_max_n", device.force_max_n},
          {"hz", device.hz}};
}

template <typename Derived>
Json flat_list(const Eigen::MatrixBase<Derived>& rows) {
  Json values = Json::array();
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    for (Eigen::Index j = 0; j < rows.cols(); ++j) {
      values.push_back(rows(i, j));
    }
  }
  return values;
}

// Smooth pieces of an outline to turn about the axis, or a mesh; how far it reaches
// from the axis and along it.
Json shape_json(const ToolShape& tool, double handle_m) {
  double width_m = 0.0;
  double top_m = 0.0;
  Json pieces = Json::array();
  for (const OutlinePiece& piece : tool_outline_m(tool, handle_m)) {
    Json points = Json::array();
    for (const Eigen::Vector2d& p : piece) {
      points.push_back({p.x(), p.y()});
      width_m = std::max(width_m, p.x());
      top_m = std::max(top_m, p.y());
    }
    pieces.push_back(points);
  }
  Json shape{{"outline_m", pieces}};
  if (tool.kind == "mesh") {
    const Points& position = tool.mesh.position_m;
    width_m = position.leftCols<2>().rowwise().norm().maxCoeff();
    top_m = position.col(2).maxCoeff();
    shape["position_m"] = flat_list(position);
    shape["triangle"] = flat_list(tool.mesh.triangle);
  }
  shape["half_width_m"] = width_m;
  shape["top_m"] = top_m;
  return shape;
}

Json tool_json(const ViewedBody& body) {
  const ToolShape& tool = body.table.tool;
  constexpr double kHandle = 0.275;  // of the body's diagonal
  const double handle_m = kHandle * bounding_box(body.database.body).diagonal().norm();
  return {{"name", tool.name},
          {"description", describe_tool(tool, body.table.puncture)},
          {"kind", tool.kind},
          {"radius_m", tool.radius_m},
          {"half_angle_rad", tool.half_angle_rad},
          {"shape", shape_json(tool, handle_m)},
          {"handle_m", handle_m},
          {"friction", tool.friction},
          {"presliding_m", tool.presliding_m},
          {"force_max_n", body.force_max_n}};
}

// Several contacts are coupled by the potential, and a needle needs a field.
bool offers(const ViewedBody& body, LocalModel model) {
  return body.hands.empty() ? body.table.puncture.empty() || is_field(model)
                            : model == LocalModel::kPotential;
}

}  // namespace

std::string body_bytes(const ResponseDatabase& database, const ResponseTable& table) {
  const SurfaceMesh& body = database.body;
  const SurfaceMap map = stiffness_map(table);
  std::string bytes = "PLPB";
  append(bytes, static_cast<std::uint32_t>(body.position_m.rows()));
  append(bytes, static_cast<std::uint32_t>(body.triangle.rows()));
  for (const Points* points : {&body.position_m, &database.normal}) {
    for (Eigen::Index i = 0; i < points->size(); ++i) {
      append(bytes, static_cast<float>(points->data()[i]));
    }
  }
  for (const double stiffness : map.value) {
    append(bytes, static_cast<float>(stiffness));
  }
  for (Eigen::Index i = 0; i < database.normal.rows(); ++i) {
    append(bytes, static_cast<float>(
                      drawn_height_m(table.tool, database.normal.row(i).transpose())));
  }
  for (Eigen::Index i = 0; i < body.triangle.size(); ++i) {
    append(bytes, static_cast<std::uint32_t>(body.triangle.data()[i]));
  }
  return bytes;
}

std::string body_text(const ViewedBody& body) {
  SurfaceMap map = stiffness_map(body.table);
  if (body.coming_to_m > 0.0) {
    map.depth_m = map_depth_m(body.coming_to_m);
  }
  const Provenance& provenance = body.database.provenance;
  Json models = Json::array();
  for (const LocalModel model : kLocalModels) {
    if (offers(body, model)) {
      models.push_back(name(model));
    }
  }
  std::string text = dumped(
      {{"database", body.name},
       {"device", body.device},
       {"writer", provenance.writer},
       {"source", provenance.source_file},
       {"left_out", provenance.left_out},
       {"tool", tool_json(body)},
       {"relaxes", !body.table.viscoelasticity.empty()},
       {"yields", !body.table.viscoelasticity.yielding.empty()},
       {"rubs", body.hands.empty() && shows_friction(body.table)},
       {"displacement_fields", body.table.displacement.node.size()},
       {"models", models},
       {"served", body.coming_to_m > 0.0},
       {"depth_max_m", std::max(body.table.depth_max_m(), body.coming_to_m)},
       {"force_max_n", largest_force_n(body)},
       {"map",
        {{"depth_m", map.depth_m},
         {"low_n_per_m", map.low},
         {"high_n_per_m", map.high},
         {"clipped_low", map.clipped_low},
         {"clipped_high", map.clipped_high},
         {"colours", page_colours()}}},
       {"ranges",
        {{"slow_hz", {ViewRanges::kSlowHzMin, body.fast_hz}},
         {"stiffness_scale", {ViewRanges::kStiffnessMin, ViewRanges::kStiffnessMax}},
         {"friction", {0.0, ViewRanges::kFrictionMax}}}}});
  text.back() = ',';
  text += "\"puncture\":" + puncture_text(body.table);
  if (!body.hands.empty()) {
    text += ",\"hands\":" + tools_text(body.hands);
  }
  return text + "}";
}

std::string frame_text(const ViewFrame& frame, const std::vector<TickRecord>& ticks) {
  const TickRecord& now = frame.now;
  const Eigen::Quaterniond& turn = frame.contact.turn;
  const Json json{
      {"type", "state"},
      {"state", frame.state},
      {"paused", frame.paused},
      {"speed", frame.speed},
      {"clients", frame.clients},
      {"holding", frame.holding},
      {"tape", frame.tape},
      {"fault", frame.fault},
      {"time_s", static_cast<double>(now.time_ns) / kNanosecondsPerSecond},
      {"tool_m", now.position_m},
      {"hand_m", or_null(frame.hand_m)},
      {"pointer_m", or_null(frame.pointer_m)},
      {"force_n", now.force_n},
      {"depth_m", depth_m(frame, now)},
      {"stored_j", now.stored_j},
      {"tank_j", now.tank_j},
      {"memory_j", memory_j(now)},
      {"dents", as_json(frame.dents)},
      {"dissipated_j", now.dissipated_j},
      {"net_j", frame.net_j},
      {"shift_m", now.rest_offset_m},
      {"flags", now.flags},
      {"contact_m", list(frame.contact.point_m)},
      {"normal", list(frame.contact.normal)},
      {"contact_nodes", frame.contact.node},
      {"contact_shares", list(frame.contact.share)},
      {"penetration_m", frame.contact.penetration_m},
      {"tool_turn", std::array<double, 4>{turn.x(), turn.y(), turn.z(), turn.w()}},
      {"run", as_json(frame.run)},
      {"settings", as_json(frame.settings)}};
  std::string text = dumped(json);
  text.pop_back();
  if (frame.service) {
    text += ",\"service\":" + dumped(as_json(*frame.service));
  }
  if (frame.device) {
    text += ",\"device\":" + dumped(as_json(*frame.device));
  }
  if (frame.hands) {
    text += "," + hands_text(*frame.hands, ticks);
  }
  if (frame.needle) {
    text += ",\"needle\":" + needle_text(*frame.needle, now);
  }
  if (frame.friction) {
    text += ",\"friction\":" + friction_text(*frame.friction);
  }
  return text + ",\"trace\":" + trace_text(frame, ticks) + "}";
}

std::string role_text(bool controls) {
  return dumped({{"type", "role"}, {"role", controls ? "controller" : "watcher"}});
}

std::string refusal_text(std::string_view why) {
  return dumped({{"type", "refused"}, {"why", why}});
}

}  // namespace palpate
