#include "formats/scene_section.h"

#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>

#include "formats/nearest_name.h"

namespace palpate {
namespace {

std::string kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

bool contains(Names names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

void SceneSection::throw_at(const toml::node& where, const std::string& what) const {
  const toml::source_index line = where.source().begin.line;
  throw InputError(
      fmt::format("{}{}: {}", file_, line == 0 ? "" : fmt::format(":{}", line), what));
}

void SceneSection::require_known(Names known) const {
  for (const auto& [key, value] : table_) {
    if (!contains(known, key.str())) {
      fail(value, "unknown key {:?} in {}; the nearest known one is \"{}\", known: {}",
           key.str(), title_, nearest_name(key.str(), known), fmt::join(known, ", "));
    }
  }
}

const toml::node& SceneSection::need(std::string_view key) const {
  const toml::node* node = find(key);
  if (node == nullptr) {
    fail("{} needs the key \"{}\"", title_, key);
  }
  return *node;
}

double SceneSection::number(std::string_view key, const NumberRule& rule) const {
  const toml::node& node = need(key);
  const double value = number_of(node, key);
  if (!std::isfinite(value) || !rule.holds(value)) {
    fail(node, "{} in {} is {}, must be {}", key, title_, value, rule.text);
  }
  return value;
}

double SceneSection::number_or(double otherwise, std::string_view key,
                               const NumberRule& rule) const {
  return find(key) == nullptr ? otherwise : number(key, rule);
}

std::string SceneSection::text(std::string_view key) const {
  const toml::node& node = need(key);
  const auto value = node.value_exact<std::string>();
  if (!value) {
    fail(node, "{} in {} is {}, must be a text", key, title_, kind_of(node));
  }
  if (value->empty()) {
    fail(node, "{} in {} is empty, must be a text", key, title_);
  }
  return *value;
}

std::string SceneSection::choice(std::string_view key, Names available) const {
  std::string value = text(key);
  if (!contains(available, value)) {
    fail(need(key), "{} {:?} in {} is not available; available: {}", key, value, title_,
         fmt::join(available, ", "));
  }
  return value;
}

Eigen::AlignedBox3d SceneSection::box(std::string_view key) const {
  const toml::node& node = need(key);
  const toml::array* corners = node.as_array();
  if (corners == nullptr || corners->size() != 2) {
    fail(node, "{} in {} must be two corners: [[x, y, z], [x, y, z]] in metres", key,
         title_);
  }
  const Eigen::AlignedBox3d box(corner(key, *corners->get(0)),
                                corner(key, *corners->get(1)));
  for (int axis = 0; axis < 3; ++axis) {
    if (!(box.min()[axis] <= box.max()[axis])) {
      fail(node,
           "{} in {} goes from {} to {} along {}, the first corner must be the lower "
           "one",
           key, title_, box.min()[axis], box.max()[axis], "xyz"[axis]);
    }
  }
  return box;
}

double SceneSection::number_of(const toml::node& node, std::string_view key) const {
  if (!node.is_number()) {
    fail(node, "{} in {} is {}, must be a number", key, title_, kind_of(node));
  }
  return node.value<double>().value_or(std::nan(""));
}

Eigen::Vector3d SceneSection::corner(std::string_view key,
                                     const toml::node& node) const {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != 3) {
    fail(node, "a corner of {} in {} must have three coordinates: [x, y, z]", key,
         title_);
  }
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] = number_of(*array->get(static_cast<std::size_t>(axis)), key);
    if (!std::isfinite(point[axis])) {
      fail(node, "a coordinate of {} in {} is {}, must be finite", key, title_,
           point[axis]);
    }
  }
  return point;
}

}  // namespace palpate
