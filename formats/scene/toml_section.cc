#include "formats/scene/toml_section.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/ranges.h>

#include "formats/base/nearest_name.h"

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

void SceneSection::require_own(const std::string& owner, Names own,
                               Names shared) const {
  for (const auto& [key, value] : table_) {
    if (!contains(own, key.str()) && !contains(shared, key.str())) {
      fail(value, "{:?} in {} does not belong to {}, which has: {}", key.str(), title_,
           owner, fmt::join(own, ", "));
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

std::string SceneSection::choice_or(std::string_view otherwise, std::string_view key,
                                    Names available) const {
  return find(key) == nullptr ? std::string(otherwise) : choice(key, available);
}

bool SceneSection::boolean_or(bool otherwise, std::string_view key) const {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return otherwise;
  }
  if (!node->is_boolean()) {
    fail(*node, "{} in {} is {}, must be true or false", key, title_, kind_of(*node));
  }
  return node->value<bool>().value_or(otherwise);
}

int SceneSection::integer_or(int otherwise, std::string_view key, int least,
                             int most) const {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return otherwise;
  }
  const auto value = node->value_exact<std::int64_t>();
  if (!value) {
    fail(*node, "{} in {} must be a whole number in [{}, {}]", key, title_, least,
         most);
  }
  if (*value < least || *value > most) {
    fail(*node, "{} in {} is {}, must be in [{}, {}]", key, title_, *value, least,
         most);
  }
  return static_cast<int>(*value);
}

std::vector<double> SceneSection::numbers(std::string_view key, const NumberRule& rule,
                                          std::size_t most) const {
  const toml::node& node = need(key);
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty() || array->size() > most) {
    fail(node, "{} in {} must be a list of 1 to {} numbers", key, title_, most);
  }
  std::vector<double> values;
  for (const toml::node& element : *array) {
    values.push_back(number_of(element, key));
    if (!std::isfinite(values.back()) || !rule.holds(values.back())) {
      fail(node, "{} in {} holds {}, must be {}", key, title_, values.back(),
           rule.text);
    }
  }
  return values;
}

SceneSection SceneSection::table(std::string_view key, Names known) const {
  const toml::node& node = need(key);
  if (!node.is_table()) {
    fail(node, "{} in {} is {}, must be a table: {{ {} }}", key, title_, kind_of(node),
         fmt::join(known, ", "));
  }
  SceneSection section(file_, fmt::format("{} of {}", key, title_), *node.as_table());
  section.require_known(known);
  return section;
}

std::string_view SceneSection::only_one_of(Names keys) const {
  std::string_view found;
  for (const std::string_view key : keys) {
    if (find(key) != nullptr && !found.empty()) {
      fail(need(key), "{} has both {} and {}, must have one of: {}", title_, found, key,
           fmt::join(keys, ", "));
    }
    found = find(key) != nullptr ? key : found;
  }
  if (found.empty()) {
    fail("{} needs one of the keys: {}", title_, fmt::join(keys, ", "));
  }
  return found;
}

Eigen::AlignedBox3d SceneSection::box(std::string_view key) const {
  const toml::node& node = need(key);
  const toml::array* corners = node.as_array();
  if (corners == nullptr || corners->size() != 2) {
    fail(node, "{} in {} must be two corners: [[x, y, z], [x, y, z]] in metres", key,
         title_);
  }
  const Eigen::AlignedBox3d box(
      point(fmt::format("a corner of {}", key), *corners->get(0)),
      point(fmt::format("a corner of {}", key), *corners->get(1)));
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

Eigen::Vector3d SceneSection::point(const std::string& what,
                                    const toml::node& node) const {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != 3) {
    fail(node, "{} in {} must have three coordinates: [x, y, z]", what, title_);
  }
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] = number_of(*array->get(static_cast<std::size_t>(axis)), what);
    if (!std::isfinite(point[axis])) {
      fail(node, "a coordinate of {} in {} is {}, must be finite", what, title_,
           point[axis]);
    }
  }
  return point;
}

Eigen::Vector3d SceneSection::vector(std::string_view key) const {
  return point(std::string(key), need(key));
}

Points SceneSection::points(std::string_view key, std::size_t most) const {
  const toml::node& node = need(key);
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty() || array->size() > most) {
    fail(node, "{} in {} must be a list of 1 to {} points: [[x, y, z], ...] in metres",
         key, title_, most);
  }
  Points points(static_cast<Eigen::Index>(array->size()), 3);
  for (std::size_t i = 0; i < array->size(); ++i) {
    points.row(static_cast<Eigen::Index>(i)) =
        point(fmt::format("point {} of {}", i, key), *array->get(i)).transpose();
  }
  return points;
}

Eigen::Vector3d SceneSection::direction(std::string_view key) const {
  const Eigen::Vector3d along = vector(key);
  const double largest = along.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) {
    fail(need(key), "{} in {} is [0, 0, 0], must have a direction", key, title_);
  }
  return (along / largest).normalized();
}

}  // namespace palpate
