#include "formats/database/compliance_rules.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/database/format_error.h"
#include "formats/response/contact_set.h"

namespace palpate {
namespace {

// Rounding of distances that are evenly spaced in ln.
constexpr double kSpacingTolerance = 1e-9;

void check_finite_rows(const std::string& path, const RowsOf<float>& values,
                       std::int64_t rows, std::int64_t columns, std::int64_t first) {
  if (values.rows() != rows || (rows > 0 && values.cols() != columns)) {
    fail("{} is {} x {}, must be {} x {}", path, values.rows(), values.cols(), rows,
         columns);
  }
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index k = 0; k < values.cols(); ++k) {
      if (!std::isfinite(values(i, k))) {
        fail("{}: row {} has {}, must be finite", path, first + i,
             static_cast<double>(values(i, k)));
      }
    }
  }
}

}  // namespace

void check_compliance_head(const std::string& tool, const ComplianceTable& table) {
  if (table.empty()) {
    return;
  }
  const std::string group = tool + "/compliance";
  const std::string path = group + "/distance_m";
  const std::vector<double>& distance_m = table.distance_m;
  if (distance_m.size() < kFewestKnots || distance_m.size() > kMostKnots) {
    fail("{} has {} rows, must have {} to {}", path, distance_m.size(), kFewestKnots,
         kMostKnots);
  }
  const double first = distance_m.front(), last = distance_m.back();
  if (!(first > 0.0 && last > first && last <= kLargest)) {
    fail("{} runs from {} to {}, must be positive and increase", path, first, last);
  }
  const std::vector<double> spaced = log_spaced(first, last, distance_m.size());
  for (std::size_t k = 0; k < spaced.size(); ++k) {
    if (!(std::abs(distance_m[k] / spaced[k] - 1.0) <= kSpacingTolerance)) {
      fail("{}: element {} is {}, must be {}: evenly spaced in ln", path, k,
           distance_m[k], spaced[k]);
    }
  }
  if (!(table.error_relative >= 0.0 && table.error_relative <= kLargest)) {
    fail("{}@error_relative is {}, must be at least 0 and finite", group,
         table.error_relative);
  }
}

void check_compliance_rows(const std::string& tool, const ComplianceTable& table,
                           std::int64_t nodes, std::int64_t first) {
  const std::string group = tool + "/compliance";
  const auto knots = static_cast<std::int64_t>(table.knots());
  check_finite_rows(group + "/value", table.value, table.empty() ? 0 : nodes, knots,
                    first);
  const std::int64_t modes = table.mode.cols();
  if (modes > static_cast<std::int64_t>(kMostModes) || table.added_modes < 0 ||
      table.added_modes > modes) {
    fail(
        "{}/mode has {} columns of which {} add, must have at most {}, and no fewer "
        "than add",
        group, modes, table.added_modes, kMostModes);
  }
  check_finite_rows(group + "/mode", table.mode,
                    table.empty() || modes == 0 ? 0 : nodes, modes, first);
}

void check_contact_tables(const std::vector<ResponseTable>& tables) {
  for (const ResponseTable& table : tables) {
    if (table.tool.contact.empty()) {
      continue;
    }
    for (const ToolShape& sphere : spheres_of(table.tool)) {
      const auto found =
          std::find_if(tables.begin(), tables.end(), [&](const ResponseTable& other) {
            return other.tool.name == sphere.name;
          });
      if (found == tables.end()) {
        fail(
            "/tools/{}/contact/radius_m has {}, must have a table of that radius, "
            "named "
            "{:?}",
            table.tool.name, sphere.radius_m, sphere.name);
      }
      if (found->tool.kind != "sphere" || found->tool.radius_m != sphere.radius_m) {
        fail(
            "/tools/{} is a {} of radius {}, must be a sphere of radius {} as {} has "
            "it",
            sphere.name, found->tool.kind, found->tool.radius_m, sphere.radius_m,
            table.tool.name);
      }
    }
  }
}

}  // namespace palpate
