#include "formats/response/contact_set.h"

#include <algorithm>

#include <fmt/format.h>

namespace palpate {

std::vector<double> distinct_radii(const ContactSet& contact) {
  std::vector<double> radii;
  for (const double radius_m : contact.radius_m) {
    if (std::find(radii.begin(), radii.end(), radius_m) == radii.end()) {
      radii.push_back(radius_m);
    }
  }
  return radii;
}

std::vector<std::size_t> radius_of_contacts(const ContactSet& contact) {
  const std::vector<double> radii = distinct_radii(contact);
  std::vector<std::size_t> which;
  for (const double radius_m : contact.radius_m) {
    which.push_back(static_cast<std::size_t>(
        std::find(radii.begin(), radii.end(), radius_m) - radii.begin()));
  }
  return which;
}

std::string table_name(const std::string& tool, std::size_t i) {
  return i == 0 ? tool : fmt::format("{}.{}", tool, i + 1);
}

std::vector<ToolShape> spheres_of(const ToolShape& tool) {
  std::vector<ToolShape> spheres{tool};
  const std::vector<double> radii = distinct_radii(tool.contact);
  for (std::size_t i = 1; i < radii.size(); ++i) {
    ToolShape& sphere = spheres.emplace_back(tool);
    sphere.name = table_name(tool.name, i);
    sphere.radius_m = radii[i];
    sphere.contact = {};
  }
  return spheres;
}

}  // namespace palpate
