// What a file holds of a tool's shape, once for both directions; a part of
// database_layout.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include <Eigen/Core>

namespace palpate::content {

template <typename File, typename Number>
void exchange_number(File& file, const std::string& group, const char* name,
                     Number& value) {
  if (file.optional_attribute(group, name, value != Number{})) {
    file.attribute(group, name, value);
  }
}

// A tool's axis, which not every tool has.
template <typename File, typename Axis>
void exchange_axis(File& file, const std::string& group, Axis& axis) {
  if (!file.optional_attribute(group, "axis_x", axis.has_value())) {
    return;
  }
  if constexpr (!File::kWrites) {
    axis.emplace();
  }
  constexpr std::array<const char*, 3> kNames{"axis_x", "axis_y", "axis_z"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    file.attribute(group, kNames[i], (*axis)[static_cast<Eigen::Index>(i)]);
  }
}

// Of a tool's shape, what its kind does not have is not written.
template <typename File, typename Tool>
void exchange_shape(File& file, const std::string& group, Tool& tool) {
  file.group(group);
  file.attribute(group, "shape", tool.kind);
  file.attribute(group, "radius_m", tool.radius_m);
  file.attribute(group, "friction", tool.friction);
  file.attribute(group, "presliding_m", tool.presliding_m);
  exchange_number(file, group, "edge_radius_m", tool.edge_radius_m);
  exchange_number(file, group, "half_angle_rad", tool.half_angle_rad);
  exchange_number(file, group, "tip_radius_m", tool.tip_radius_m);
  exchange_number(file, group, "length_m", tool.length_m);
  exchange_axis(file, group, tool.axis);
  if (file.optional_attribute(group, "sticking", tool.sticking)) {
    std::int64_t sticking = 1;
    file.attribute(group, "sticking", sticking);
    if constexpr (!File::kWrites) {
      tool.sticking = sticking != 0;
    }
  }
  const std::string contact = group + "/contact";
  if (file.optional_group(contact, !tool.contact.empty())) {
    file.dataset(contact + "/point_m", "m", tool.contact.point_m);
    file.dataset(contact + "/radius_m", "m", tool.contact.radius_m);
  }
  const std::string mesh = group + "/mesh";
  if (file.optional_group(mesh, tool.mesh.triangle.rows() > 0)) {
    file.dataset(mesh + "/position_m", "m", tool.mesh.position_m);
    file.dataset(mesh + "/triangle", "1", tool.mesh.triangle);
  }
}

}  // namespace palpate::content
