#include "runtime/served/served_scene.h"

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

std::int32_t tool_index(const JobDescription& plan, const std::string& name) {
  std::string known;
  for (std::size_t i = 0; i < plan.tool.size(); ++i) {
    known += (i > 0 ? ", " : "") + plan.tool[i].name;
    if (plan.tool[i].name == name || (name.empty() && plan.tool.size() == 1)) {
      return static_cast<std::int32_t>(i);
    }
  }
  throw InputError(
      name.empty() ? fmt::format("the scene has several tools, name one: {}", known)
                   : fmt::format("tool \"{}\" is not there; known: {}", name, known));
}

void check_rendered(const JobDescription& plan, std::int32_t tool) {
  const auto refuse = [](const std::string& what) {
    throw InputError(what +
                     ": not rendered while it is computed; give palpate-precompute "
                     "build the scene, and this command its database");
  };
  const auto i = static_cast<std::size_t>(tool);
  if (!plan.tool[i].contact.empty()) {
    refuse(fmt::format("tool \"{}\" touches at several places", plan.tool[i].name));
  }
  const bool yields = i < plan.yielding.size() && !plan.yielding[i].empty();
  if (!plan.relaxation.empty() || yields) {
    refuse("the body relaxes or yields");
  }
  if (i < plan.puncture.size() && !plan.puncture[i].empty()) {
    refuse(fmt::format("tool \"{}\" is a needle", plan.tool[i].name));
  }
}

bool same_body(const JobDescription& a, const JobDescription& b, std::int32_t tool) {
  const auto i = static_cast<std::size_t>(tool);
  return a.body.position_m.rows() == b.body.position_m.rows() &&
         a.body.triangle.rows() == b.body.triangle.rows() &&
         a.body.position_m == b.body.position_m && a.body.triangle == b.body.triangle &&
         i < b.tool.size() && a.tool[i].name == b.tool[i].name &&
         a.tool[i].kind == b.tool[i].kind && a.tool[i].radius_m == b.tool[i].radius_m;
}

ResponseDatabase body_of(const ServedScene& scene, std::int32_t tool) {
  const JobDescription& plan = scene.plan;
  ResponseDatabase database;
  database.body = plan.body;
  database.normal = plan.normal;
  database.tools = {make_table(plan.tool[static_cast<std::size_t>(tool)],
                               std::vector<NodeResponse>(static_cast<std::size_t>(
                                   plan.body.position_m.rows())))};
  database.provenance = plan.provenance;
  return database;
}

ServedResponses answers_of(const ResponseDatabase& database, const JobDescription& plan,
                           std::int32_t tool) {
  if (database.body.position_m.rows() != plan.body.position_m.rows() ||
      database.body.position_m != plan.body.position_m) {
    throw FormatError("its body is not that of the scene");
  }
  const ResponseTable& table =
      find_tool(database, plan.tool[static_cast<std::size_t>(tool)].name);
  ServedResponses responses{.quality = AnswerQuality::kFinal, .node = {}};
  for (std::int32_t i = 0; i < table.nodes(); ++i) {
    const CurveView curve = table.curve(i);
    const auto row = static_cast<std::size_t>(i);
    if (curve.depth_m.empty()) {
      continue;
    }
    WorkUnitNode answer{.tool = tool, .vertex = i};
    NodeResponse& response = answer.response;
    response.direction = table.direction.row(i).transpose();
    response.direction_spread_rad = table.direction_spread_rad[row];
    if (table.tilt.rows() > 0) {
      response.tilt = {.tilt = table.tilt.row(i).transpose(),
                       .by_depth_per_m = table.tilt_by_depth_per_m.row(i).transpose()};
    }
    response.touch_offset_m = table.touch_offset_m[row];
    response.depth_m.assign(curve.depth_m.begin(), curve.depth_m.end());
    response.force_n.assign(curve.force_n.begin(), curve.force_n.end());
    response.error_relative = table.error_relative[row];
    response.origin = static_cast<ResponseOrigin>(table.origin[row]);
    response.flags = table.flags[row];
    responses.node.push_back(std::move(answer));
  }
  return responses;
}

}  // namespace palpate
