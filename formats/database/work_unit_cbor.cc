#include "formats/database/work_unit_cbor.h"

#include "formats/database/puncture_layout.h"

namespace palpate {
namespace {

using nlohmann::json;

Eigen::Vector3d vector_of(const json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

template <typename Matrix>
json flat(const Matrix& m) {
  return std::vector<typename Matrix::Scalar>(m.data(), m.data() + m.size());
}

template <typename Matrix>
Matrix rows_of_three(const json& j) {
  const auto values = j.get<std::vector<typename Matrix::Scalar>>();
  return Eigen::Map<const Matrix>(values.data(),
                                  static_cast<Eigen::Index>(values.size() / 3), 3);
}

json to_json(const SurfaceMesh& mesh) {
  return {{"position_m", flat(mesh.position_m)}, {"triangle", flat(mesh.triangle)}};
}

SurfaceMesh mesh_of(const json& j) {
  return {rows_of_three<Points>(j.at("position_m")),
          rows_of_three<Triangles>(j.at("triangle"))};
}

json to_json(const ToolShape& tool) {
  json j{{"name", tool.name},
         {"kind", tool.kind},
         {"radius_m", tool.radius_m},
         {"friction", tool.friction},
         {"presliding_m", tool.presliding_m},
         {"edge_radius_m", tool.edge_radius_m},
         {"half_angle_rad", tool.half_angle_rad},
         {"tip_radius_m", tool.tip_radius_m},
         {"length_m", tool.length_m},
         {"mesh", to_json(tool.mesh)},
         {"sticking", tool.sticking}};
  if (tool.presliding_computed) {
    j["presliding_computed"] = true;
  }
  if (tool.axis) {
    j["axis"] = json_list(*tool.axis);
  }
  if (!tool.contact.empty()) {
    j["contact"] = {{"point_m", flat(tool.contact.point_m)},
                    {"radius_m", tool.contact.radius_m}};
  }
  return j;
}

ToolShape tool_of(const json& j) {
  ToolShape tool{.name = j.at("name"),
                 .kind = j.at("kind"),
                 .radius_m = j.at("radius_m"),
                 .friction = j.at("friction"),
                 .presliding_m = j.at("presliding_m"),
                 .edge_radius_m = j.at("edge_radius_m"),
                 .half_angle_rad = j.at("half_angle_rad"),
                 .tip_radius_m = j.at("tip_radius_m"),
                 .length_m = j.at("length_m"),
                 .mesh = mesh_of(j.at("mesh")),
                 .sticking = j.at("sticking")};
  tool.presliding_computed = j.value("presliding_computed", false);
  if (j.contains("axis")) {
    tool.axis = vector_of(j.at("axis"));
  }
  if (j.contains("contact")) {
    const json& contact = j.at("contact");
    tool.contact = {rows_of_three<Points>(contact.at("point_m")),
                    contact.at("radius_m").get<std::vector<double>>()};
  }
  return tool;
}

void take_values(const json& j, std::vector<double>& values, Eigen::Index /*columns*/) {
  values = j.get<std::vector<double>>();
}

template <typename T>
void take_values(const json& j, RowsOf<T>& rows, Eigen::Index columns) {
  const auto values = j.get<std::vector<T>>();
  const auto size = static_cast<Eigen::Index>(values.size());
  rows = Eigen::Map<const RowsOf<T>>(values.data(), columns > 0 ? size / columns : 0,
                                     columns);
}

json to_json(const WorkUnitNode& node) {
  const NodeResponse& response = node.response;
  json directions = json::array();
  for (const Eigen::Vector3d& direction : response.sample_direction) {
    directions.push_back(json_list(direction));
  }
  json j{{"tool", node.tool},
         {"vertex", node.vertex},
         {"failure", node.failure},
         {"history", node.history},
         {"elsewhere", node.reaches_elsewhere},
         {"direction", json_list(response.direction)},
         {"direction_spread_rad", response.direction_spread_rad},
         {"touch_offset_m", response.touch_offset_m},
         {"depth_m", response.depth_m},
         {"force_n", response.force_n},
         {"sample_direction", std::move(directions)},
         {"error_relative", response.error_relative},
         {"origin", static_cast<int>(response.origin)},
         {"flags", response.flags}};
  if (response.tilt) {
    j["tilt"] = json_list(response.tilt->tilt);
    j["tilt_by_depth_per_m"] = json_list(response.tilt->by_depth_per_m);
  }
  for_each_contact_dataset(response.contact,
                           [&](const char* name, const char* /*units*/,
                               Eigen::Index /*columns*/, const RowsOf<float>& rows) {
                             if (rows.rows() > 0) {
                               j["contact"][name] = flat(rows);
                             }
                           });
  return j;
}

WorkUnitNode node_of(const json& j) {
  WorkUnitNode node{.tool = j.at("tool"),
                    .vertex = j.at("vertex"),
                    .response = {.direction = vector_of(j.at("direction")),
                                 .direction_spread_rad = j.at("direction_spread_rad"),
                                 .touch_offset_m = j.at("touch_offset_m"),
                                 .depth_m = j.at("depth_m"),
                                 .force_n = j.at("force_n"),
                                 .error_relative = j.at("error_relative"),
                                 .origin = static_cast<ResponseOrigin>(
                                     j.at("origin").get<std::uint8_t>()),
                                 .flags = j.at("flags")},
                    .failure = j.at("failure"),
                    .history = j.value("history", ""),
                    .reaches_elsewhere = j.value("elsewhere", false)};
  for (const json& direction : j.at("sample_direction")) {
    node.response.sample_direction.push_back(vector_of(direction));
  }
  if (j.contains("tilt")) {
    node.response.tilt = {.tilt = vector_of(j.at("tilt")),
                          .by_depth_per_m = vector_of(j.at("tilt_by_depth_per_m"))};
  }
  const json contact = j.value("contact", json::object());
  for_each_contact_dataset(node.response.contact,
                           [&](const char* name, const char* /*units*/,
                               Eigen::Index columns, RowsOf<float>& rows) {
                             if (contact.contains(name)) {
                               take_values(contact.at(name), rows, columns);
                             }
                           });
  return node;
}

json to_json(const Puncture& puncture) {
  json j{{"rule", puncture.rule},
         {"material", puncture.material},
         {"membrane_j", puncture.membrane_j},
         {"layers", puncture.layer_depth_m.cols()}};
  const auto keep = [&](const char* name, double number) {
    j[name] = number;
  };
  for_each_puncture_number(puncture, keep);
  for_each_optional_puncture_number(puncture, keep);
  content::for_each_puncture_dataset(
      puncture,
      [&](const std::string& name, const char* /*units*/, const auto& values) {
        j[name] = std::vector(values.data(), values.data() + values.size());
      });
  return j;
}

Puncture puncture_of(const json& j) {
  Puncture puncture{.rule = j.at("rule"),
                    .material = j.at("material").get<std::vector<std::string>>(),
                    .membrane_j = j.value("membrane_j", std::vector<double>{})};
  for_each_puncture_number(puncture, [&](const char* name, double& number) {
    number = j.at(name);
  });
  for_each_optional_puncture_number(puncture, [&](const char* name, double& number) {
    number = j.value(name, 0.0);
  });
  const auto columns = j.at("layers").get<Eigen::Index>();
  content::for_each_puncture_dataset(
      puncture, [&](const std::string& name, const char* /*units*/, auto& values) {
        take_values(j.at(name), values, columns);
      });
  return puncture;
}

}  // namespace

json json_list(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

void to_json(json& j, const WorkUnitOutcome& unit) {
  j = {{"index", unit.index}, {"is_check", unit.is_check}, {"node", json::array()}};
  for (const WorkUnitNode& node : unit.node) {
    j["node"].push_back(to_json(node));
  }
  if (unit.place.triangle >= 0) {
    j["place"] = {{"triangle", unit.place.triangle},
                  {"area_coordinate", json_list(unit.place.area_coordinate)}};
  }
}

void from_json(const json& j, WorkUnitOutcome& unit) {
  unit = {.index = j.at("index"), .is_check = j.at("is_check"), .node = {}};
  for (const json& node : j.at("node")) {
    unit.node.push_back(node_of(node));
  }
  if (const auto place = j.find("place"); place != j.end()) {
    unit.place.triangle = place->at("triangle");
    unit.place.area_coordinate = vector_of(place->at("area_coordinate"));
  }
}

void to_json(json& j, const JobDescription& plan) {
  const Provenance& from = plan.provenance;
  j = {{"digest", plan.digest},
       {"units", plan.units},
       {"body", to_json(plan.body)},
       {"normal", flat(plan.normal)},
       {"tool", json::array()},
       {"force_relative", plan.force_relative},
       {"reachable", plan.reachable},
       {"depth_max_m", plan.depth_max_m},
       {"force_max_n", plan.force_max_n},
       {"writer", from.writer},
       {"scene_toml", from.scene_toml},
       {"source_file", from.source_file},
       {"source_sha256", from.source_sha256}};
  j["left_out"] = plan.left_out;
  if (!plan.relaxation.empty()) {
    j["relaxation"] = {{"rule", plan.relaxation.rule},
                       {"tau_s", plan.relaxation.tau_s},
                       {"g", flat(plan.relaxation.g)}};
    j["bundles"] = plan.bundles;
  }
  for (const ToolShape& tool : plan.tool) {
    j["tool"].push_back(to_json(tool));
  }
  for (const Yielding& yielding : plan.yielding) {
    json rows = json::object();
    for_each_dataset(yielding, [&](const std::string& name, const char* /*units*/,
                                   const std::vector<double>& values) {
      rows[name] = values;
    });
    j["yielding"].push_back(std::move(rows));
  }
  for (const Puncture& puncture : plan.puncture) {
    j["puncture"].push_back(to_json(puncture));
  }
}

void from_json(const json& j, JobDescription& plan) {
  plan.digest = j.at("digest");
  plan.units = j.at("units");
  plan.body = mesh_of(j.at("body"));
  plan.normal = rows_of_three<Points>(j.at("normal"));
  plan.tool.clear();
  plan.force_relative = j.at("force_relative");
  plan.reachable = j.at("reachable");
  plan.depth_max_m = j.at("depth_max_m");
  plan.force_max_n = j.at("force_max_n");
  plan.left_out = j.value("left_out", "");
  plan.provenance.writer = j.at("writer");
  plan.provenance.scene_toml = j.at("scene_toml");
  plan.provenance.source_file = j.at("source_file");
  plan.provenance.source_sha256 = j.at("source_sha256");
  if (j.contains("relaxation")) {
    const json& relaxation = j.at("relaxation");
    plan.relaxation.rule = relaxation.at("rule");
    plan.relaxation.instantaneous = true;
    plan.relaxation.tau_s = relaxation.at("tau_s").get<std::vector<double>>();
    const auto g = relaxation.at("g").get<std::vector<float>>();
    plan.relaxation.g = Eigen::Map<const RowsOf<float>>(
        g.data(), 1, static_cast<Eigen::Index>(g.size()));
    plan.bundles = j.at("bundles");
  }
  for (const json& tool : j.at("tool")) {
    plan.tool.push_back(tool_of(tool));
  }
  plan.yielding.clear();
  for (const json& rows : j.value("yielding", json::array())) {
    Yielding& yielding = plan.yielding.emplace_back();
    for_each_dataset(yielding, [&](const std::string& name, const char* /*units*/,
                                   std::vector<double>& values) {
      values = rows.at(name).get<std::vector<double>>();
    });
  }
  plan.puncture.clear();
  for (const json& puncture : j.value("puncture", json::array())) {
    plan.puncture.push_back(puncture_of(puncture));
  }
}

}  // namespace palpate
