#include "formats/report/taxel_export.h"

#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/response/tangent_frame.h"

namespace palpate {
namespace {

template <typename Vector>
std::vector<double> numbers_of(const Vector& v) {
  return {v.data(), v.data() + v.size()};
}

}  // namespace

std::string taxel_csv(const Taxels& taxels, const TaxelGrid& grid) {
  std::string text;
  for (Eigen::Index row = grid.rows; row-- > 0;) {
    for (Eigen::Index column = 0; column < grid.columns; ++column) {
      text +=
          fmt::format("{}{}", column > 0 ? "," : "", taxels.pressure_pa(row, column));
    }
    text += "\n";
  }
  return text;
}

std::string taxel_json(const Taxels& taxels, const TaxelGrid& grid) {
  const auto frame = tangent_frame(taxels.outward);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index row = 0; row < grid.rows; ++row) {
    rows.push_back(numbers_of(taxels.pressure_pa.row(row).eval()));
  }
  const ContactPressure& contact = taxels.contact;
  return json_text(nlohmann::ordered_json{
      {"pitch_m", grid.pitch_m},
      {"pressure_pa", std::move(rows)},
      {"force_n", contact.normal_n},
      {"beside_n", taxels.beside_n},
      {"radius_m", contact.normal_n > 0.0 ? contact.radius_m() : 0.0},
      {"middle_pa", contact.normal_n > 0.0 ? contact.middle_pa() : 0.0},
      {"centre_m", numbers_of(contact.centre_m)},
      {"exponent", contact.exponent},
      {"error_relative", taxels.error_relative},
      {"middle_m", numbers_of(taxels.middle_m)},
      {"outward", numbers_of(taxels.outward)},
      {"x", numbers_of(frame.col(0).eval())},
      {"y", numbers_of(frame.col(1).eval())}});
}

}  // namespace palpate
