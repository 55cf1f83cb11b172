#include "formats/report/pressure_export.h"

#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/response/pressure_law.h"

namespace palpate {
namespace {

// Calls row(node, law) for each node with a response.
template <typename Row>
void for_each_law(const ResponseDatabase& database, const ResponseTable& table,
                  const Row& row) {
  check_gives_pressure(table.tool);
  for (std::int64_t node = 0; node < table.nodes(); ++node) {
    if (!table.curve(node).depth_m.empty()) {
      row(node, pressure_law(table, node, database.normal.row(node).transpose()));
    }
  }
}

double even_depth_m(const PressureLaw& law, int i) {
  return law.depth_max_m() * i / (kPressureDepths - 1);
}

}  // namespace

std::string pressure_csv(const ResponseDatabase& database, const ResponseTable& table) {
  std::string text = "node,x_m,y_m,z_m,radius_m,depth_m,pressure_pa\n";
  for_each_law(database, table, [&](std::int64_t node, const PressureLaw& law) {
    const auto x = database.body.position_m.row(node);
    for (int i = 0; i < kPressureDepths; ++i) {
      const double depth_m = even_depth_m(law, i);
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", node, x[0],
                     x[1], x[2], law.radius_m(), depth_m, law.pressure_pa(depth_m));
    }
  });
  return text;
}

std::string pressure_json(const ResponseDatabase& database,
                          const ResponseTable& table) {
  using Json = nlohmann::ordered_json;
  Json laws(std::vector<Json>(static_cast<std::size_t>(table.nodes())));
  for_each_law(database, table, [&](std::int64_t node, const PressureLaw& law) {
    std::vector<double> depth_m;
    std::vector<double> pressure_pa;
    for (int i = 0; i < kPressureDepths; ++i) {
      depth_m.push_back(even_depth_m(law, i));
      pressure_pa.push_back(law.pressure_pa(depth_m.back()));
    }
    const LinearPressure fit = linear_pressure(law, law.depth_max_m());
    laws[static_cast<std::size_t>(node)] = {
        {"depth_m", depth_m},
        {"pressure_pa", pressure_pa},
        {"slope_pa_per_m", fit.slope_pa_per_m},
        {"misfit_relative", fit.misfit_relative},
        {"force_error_relative", fit.force_error_relative}};
  });
  const Json report = {
      {"tool", {{"name", table.tool.name}, {"radius_m", table.tool.radius_m}}},
      {"law", laws}};
  return json_text(report) + "\n";
}

}  // namespace palpate
