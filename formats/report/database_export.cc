#include "formats/report/database_export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/database/vtk_cells.h"
#include "formats/report/contact_columns.h"

namespace palpate {
namespace {

using Out = std::back_insert_iterator<std::string>;

// Shortest digits that read back as the same number; flags as numbers, not letters.
template <typename Values>
void data_array(Out out, const char* type, const std::string& name, int components,
                const Values& values) {
  fmt::format_to(out,
                 "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
                 "format=\"ascii\">\n",
                 type, name, components);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = values[i];
    const bool ends = (i + 1) % 12 == 0 || i + 1 == values.size();
    if constexpr (sizeof value == 1) {
      fmt::format_to(out, "{}{}", static_cast<int>(value), ends ? "\n" : " ");
    } else {
      fmt::format_to(out, "{}{}", value, ends ? "\n" : " ");
    }
  }
  fmt::format_to(out, "</DataArray>\n");
}

std::span<const double> flat(const Points& points) {
  return {points.data(), static_cast<std::size_t>(points.size())};
}

// A value per node.
template <typename Value>
std::vector<double> of_nodes(const ResponseTable& table, const Value& value) {
  std::vector<double> values;
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    values.push_back(value(i));
  }
  return values;
}

// Row of a part that has one row for all nodes alike, or one for each.
Eigen::Index own_row(Eigen::Index rows, std::int64_t node) {
  return rows == 1 ? 0 : node;
}

// What VTK's parser of numbers in text cannot read stands as -1.
double readable(double value) {
  return std::isfinite(value) ? value : -1.0;
}

// "rupture_n" or "rupture_j".
const char* rupture_column(const Puncture& puncture) {
  return puncture.rule == "energy" ? "rupture_j" : "rupture_n";
}

void puncture_data(Out out, const ResponseTable& table) {
  const Puncture& puncture = table.puncture;
  if (puncture.empty()) {
    return;
  }
  data_array(out, "Float64", rupture_column(puncture), 1,
             of_nodes(table, [&](std::int64_t node) {
               return readable(row_of(puncture.rupture, node));
             }));
  std::vector<double> depth_m;
  std::vector<std::int32_t> material;
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    const Eigen::Index row = own_row(puncture.layer_depth_m.rows(), i);
    for (Eigen::Index k = 0; k < puncture.layer_depth_m.cols(); ++k) {
      depth_m.push_back(readable(puncture.layer_depth_m(row, k)));
      material.push_back(puncture.layer_material(row, k));
    }
  }
  const auto layers = static_cast<int>(puncture.layer_depth_m.cols());
  data_array(out, "Float64", "layer_depth_m", layers, depth_m);
  data_array(out, "Int32", "layer_material", layers, material);
}

void contact_data(Out out, const ResponseTable& table) {
  const auto last = [&](std::int64_t node) {
    return table.curve(node).depth_m.size() - 1;
  };
  const auto pressed = [&](std::int64_t node) {
    return !table.curve(node).depth_m.empty();
  };
  if (table.contact.has_pressure()) {
    data_array(out, "Float64", "contact_radius_m", 1,
               of_nodes(table, [&](std::int64_t node) {
                 return pressed(node) ? contact_radius_m(table, node, last(node)) : 0.0;
               }));
  }
  if (table.contact.has_lateral()) {
    std::vector<double> rows;
    for (std::int64_t i = 0; i < table.nodes(); ++i) {
      const std::array<double, 3> row =
          pressed(i) ? lateral_n_per_m(table, i, last(i)) : std::array<double, 3>{};
      rows.insert(rows.end(), row.begin(), row.end());
    }
    data_array(out, "Float64", "lateral_n_per_m", 3, rows);
  }
}

// "plastic_share" of "/plastic/share".
std::string column_name(std::string dataset) {
  std::replace(dataset.begin(), dataset.end(), '/', '_');
  return dataset.substr(1);
}

void point_data(Out out, const ResponseTable& table) {
  fmt::format_to(out, "<PointData Scalars=\"stiffness\">\n");
  data_array(out, "Float64", "stiffness", 1, table.stiffness_max_n_per_m);
  data_array(out, "Float64", "depth_max", 1, node_depth_max_m(table));
  data_array(out, "Float64", "error", 1, table.error_relative);
  data_array(out, "UInt8", "origin", 1, table.origin);
  data_array(out, "UInt8", "flags", 1, table.flags);
  data_array(out, "Float64", "direction", 3, flat(table.direction));
  const Viscoelasticity& relaxation = table.viscoelasticity;
  for (std::int64_t k = 0; k < relaxation.terms(); ++k) {
    data_array(out, "Float64", fmt::format("relaxing_g_{}", k + 1), 1,
               of_nodes(table, [&](std::int64_t node) {
                 return relaxation.shares(node)(k);
               }));
  }
  if (!relaxation.empty()) {
    data_array(out, "Float64", "relaxation_time_s", 1,
               of_nodes(table, [&](std::int64_t node) {
                 return mean_time_s(relaxation, node);
               }));
  }
  for_each_dataset(relaxation.yielding, [&](const std::string& name, const char*,
                                            const std::vector<double>& values) {
    if (!values.empty()) {
      data_array(out, "Float64", column_name(name), 1,
                 of_nodes(table, [&](std::int64_t node) {
                   return row_of(values, node);
                 }));
    }
  });
  if (const ComplianceTable& coupling = table.compliance; !coupling.empty()) {
    data_array(out, "Float32", "compliance_m2_per_n",
               static_cast<int>(coupling.knots()),
               std::span(coupling.value.data(),
                         static_cast<std::size_t>(coupling.value.size())));
  }
  contact_data(out, table);
  puncture_data(out, table);
  fmt::format_to(out, "</PointData>\n");
}

}  // namespace

std::string to_vtu(const ResponseDatabase& database, const ResponseTable& table) {
  const VtkCells cells = vtk_cells(database.body);
  std::string text;
  const Out out(text);
  fmt::format_to(out,
                 "<?xml version=\"1.0\"?>\n"
                 "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                 "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                 "<UnstructuredGrid>\n"
                 "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                 cells.points.front(), cells.cells.front());
  point_data(out, table);
  fmt::format_to(out, "<Points>\n");
  data_array(out, "Float64", "Points", 3, flat(database.body.position_m));
  fmt::format_to(out, "</Points>\n<Cells>\n");
  data_array(out, "Int64", "connectivity", 1, cells.connectivity);
  data_array(out, "Int64", "offsets", 1, std::span(cells.offset).subspan(1));
  data_array(out, "UInt8", "types", 1, cells.type);
  fmt::format_to(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
  return text;
}

namespace {

// ",rupture_n,layer_depth_m_1,layer_material_1,..."; nothing of a tool that punctures
// nothing.
std::string puncture_head(const Puncture& puncture) {
  std::string text;
  if (!puncture.empty()) {
    text = fmt::format(",{}", rupture_column(puncture));
    for (Eigen::Index k = 1; k <= puncture.layer_depth_m.cols(); ++k) {
      text += fmt::format(",layer_depth_m_{0},layer_material_{0}", k);
    }
  }
  return text;
}

// A node's values of these columns; without a layer: nan and -1.
std::string puncture_values(const Puncture& puncture, std::int64_t node) {
  std::string text;
  if (!puncture.empty()) {
    text = fmt::format(",{}", row_of(puncture.rupture, node));
    const Eigen::Index row = own_row(puncture.layer_depth_m.rows(), node);
    for (Eigen::Index k = 0; k < puncture.layer_depth_m.cols(); ++k) {
      text += fmt::format(",{},{}", puncture.layer_depth_m(row, k),
                          puncture.layer_material(row, k));
    }
  }
  return text;
}

}  // namespace

std::string to_csv(const ResponseDatabase& database, const ResponseTable& table) {
  const Viscoelasticity& relaxation = table.viscoelasticity;
  std::string text = "node,x_m,y_m,z_m,depth_m,force_n,stiffness_n_per_m,energy_j";
  const Out out(text);
  for (std::int64_t k = 1; k <= relaxation.terms(); ++k) {
    fmt::format_to(out, ",g_{}", k);
  }
  for_each_dataset(relaxation.yielding, [&](const std::string& name, const char*,
                                            const std::vector<double>& values) {
    if (!values.empty()) {
      fmt::format_to(out, ",{}", column_name(name));
    }
  });
  text += puncture_head(table.puncture) + contact_columns(table.contact) + '\n';
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    const auto x = database.body.position_m.row(i);
    const CurveView curve = table.curve(i);
    std::string shares;
    if (!relaxation.empty()) {
      for (const double g : relaxation.shares(i)) {
        fmt::format_to(std::back_inserter(shares), ",{}", g);
      }
    }
    for_each_dataset(relaxation.yielding, [&](const std::string&, const char*,
                                              const std::vector<double>& values) {
      if (!values.empty()) {
        fmt::format_to(std::back_inserter(shares), ",{}", row_of(values, i));
      }
    });
    shares += puncture_values(table.puncture, i);
    for (std::size_t k = 0; k < curve.depth_m.size(); ++k) {
      fmt::format_to(out, "{},{},{},{},{},{},{},{}{}{}\n", i, x[0], x[1], x[2],
                     curve.depth_m[k], curve.force_n[k], curve.stiffness_n_per_m[k],
                     curve.energy_j[k], shares, contact_values(table, i, k));
    }
  }
  return text;
}

namespace {

using Json = nlohmann::ordered_json;

template <typename Rows>
Json rows_json(const Rows& values) {
  Json rows = Json::array();
  for (const auto& row : values.rowwise()) {
    rows.push_back(std::vector<typename Rows::Scalar>(row.begin(), row.end()));
  }
  return rows;
}

// What is infinite or not a number becomes null.
Json to_json(const Puncture& puncture) {
  Json json{{"rule", puncture.rule},
            {"material", puncture.material},
            {"membrane_n", puncture.membrane_n},
            {"membrane_j", puncture.membrane_j},
            {"cutting_n", puncture.cutting_n},
            {"friction_n_per_m", puncture.friction_n_per_m},
            {"static_ratio", puncture.static_ratio},
            {"toughness_j_per_m2", puncture.toughness_j_per_m2},
            {rupture_column(puncture), puncture.rupture},
            {"layer_depth_m", rows_json(puncture.layer_depth_m)},
            {"layer_material", rows_json(puncture.layer_material)}};
  const auto add = [&json](const char* name, double number) {
    json[name] = number;
  };
  for_each_puncture_number(puncture, add);
  for_each_optional_puncture_number(puncture, add);
  return json;
}

Json to_json(const Viscoelasticity& relaxation) {
  Json json = {{"rule", relaxation.rule},
               {"probes", relaxation.probes},
               {"curve", relaxation.instantaneous ? "instantaneous" : "press"},
               {"speed_m_per_s", relaxation.speed_m_per_s},
               {"tau_s", relaxation.tau_s},
               {"g", rows_json(relaxation.g)},
               {"error_relative", relaxation.error_relative},
               {"bundle_depth_m", relaxation.bundle_depth_m}};
  for_each_dataset(relaxation.yielding, [&](const std::string& name, const char*,
                                            const std::vector<double>& values) {
    if (!values.empty()) {
      json[column_name(name)] = values;
    }
  });
  if (!relaxation.sites.empty()) {
    json["sites"] = {{"spacing_m", relaxation.sites.spacing_m},
                     {"node", relaxation.sites.node},
                     {"site", rows_json(relaxation.sites.site)},
                     {"weight", rows_json(relaxation.sites.weight)}};
  }
  return json;
}

// Pressure's radius and lateral stiffness at every sample.
void add_contact(const ResponseTable& table, std::int64_t node, Json& response) {
  for (std::size_t k = 0; k < table.curve(node).depth_m.size(); ++k) {
    if (table.contact.has_pressure()) {
      response["contact_radius_m"].push_back(contact_radius_m(table, node, k));
    }
    if (table.contact.has_lateral()) {
      response["lateral_n_per_m"].push_back(lateral_n_per_m(table, node, k));
    }
  }
}

}  // namespace

std::string to_json_text(const ResponseDatabase& database, const ResponseTable& table) {
  Json nodes = Json::array();
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const CurveView curve = table.curve(i);
    if (curve.depth_m.empty()) {
      nodes.push_back(nullptr);
      continue;
    }
    const auto u = table.direction.row(i);
    nodes.push_back({{"direction", {u[0], u[1], u[2]}},
                     {"touch_offset_m", table.touch_offset_m[at]},
                     {"error_relative", table.error_relative[at]},
                     {"origin", table.origin[at]},
                     {"flags", table.flags[at]},
                     {"depth_m", curve.depth_m},
                     {"force_n", curve.force_n},
                     {"stiffness_n_per_m", curve.stiffness_n_per_m},
                     {"energy_j", curve.energy_j}});
    add_contact(table, i, nodes.back());
  }
  Json report = {{"tool",
                  {{"name", table.tool.name},
                   {"shape", table.tool.kind},
                   {"radius_m", table.tool.radius_m},
                   {"friction", table.tool.friction},
                   {"presliding_m", table.tool.presliding_m}}},
                 {"position_m", rows_json(database.body.position_m)},
                 {"triangle", rows_json(database.body.triangle)},
                 {"response", nodes}};
  const ResponseRelaxation& relaxation = table.relaxation;
  if (!relaxation.empty()) {
    report["relaxation"] = {{"rule", relaxation.rule},
                            {"probes", relaxation.probes},
                            {"speed_m_per_s", relaxation.speed_m_per_s},
                            {"seconds", relaxation.seconds},
                            {"g_1", relaxation.terms.g_1},
                            {"g_2", relaxation.terms.g_2},
                            {"tau_1_s", relaxation.terms.tau_1_s},
                            {"tau_2_s", relaxation.terms.tau_2_s}};
  }
  if (!table.tool.contact.empty()) {
    report["tool"]["contact"] = {{"point_m", rows_json(table.tool.contact.point_m)},
                                 {"radius_m", table.tool.contact.radius_m}};
  }
  if (const ComplianceTable& compliance = table.compliance; !compliance.empty()) {
    report["compliance"] = {{"distance_m", compliance.distance_m},
                            {"value_m2_per_n", rows_json(compliance.value)},
                            {"mode", rows_json(compliance.mode)},
                            {"added_modes", compliance.added_modes},
                            {"error_relative", compliance.error_relative},
                            {"convex", compliance.convex}};
  }
  if (table.viscoelasticity.remembers()) {
    report["viscoelasticity"] = to_json(table.viscoelasticity);
  }
  if (!table.puncture.empty()) {
    report["puncture"] = to_json(table.puncture);
  }
  return json_text(report) + "\n";
}

}  // namespace palpate
