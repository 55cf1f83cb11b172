// What a database says of a needle's puncture, once for both directions, as
// database_layout.h has the rest; only for the sources behind response_database.h and
// database_index.h.
#pragma once

#include <string>

#include <fmt/format.h>

#include "formats/base/lines.h"
#include "formats/database/shape_layout.h"
#include "formats/response/puncture.h"

namespace palpate::content {

/// Calls with(name, units, values) for every dataset but the text `material` and the
/// optional `membrane_j`. Names are relative to the group.
template <typename Rows, typename With>
void for_each_puncture_dataset(Rows& puncture, const With& with) {
  with("/membrane_n", "N", puncture.membrane_n);
  with("/cutting_n", "N", puncture.cutting_n);
  with("/friction_n_per_m", "N m-1", puncture.friction_n_per_m);
  with("/static_ratio", "1", puncture.static_ratio);
  with("/toughness_j_per_m2", "J m-2", puncture.toughness_j_per_m2);
  with("/rupture", rupture_units(puncture), puncture.rupture);
  with("/layer_depth_m", "m", puncture.layer_depth_m);
  with("/layer_material", "1", puncture.layer_material);
}

/// @param tool the group of the tool. `File` as in database_layout.h.
template <typename File, typename Rows>
void exchange_puncture(File& file, const std::string& tool, Rows& puncture) {
  const std::string group = tool + "/puncture";
  if (!file.optional_group(group, !puncture.empty())) {
    return;
  }
  file.attribute(group, "rule", puncture.rule);
  for_each_puncture_number(puncture, [&](const char* name, auto& number) {
    file.attribute(group, name, number);
  });
  for_each_optional_puncture_number(puncture, [&](const char* name, auto& number) {
    exchange_number(file, group, name, number);
  });
  if constexpr (File::kWrites) {
    file.text(group + "/material", join_lines(puncture.material));
  } else {
    std::string text;
    file.text(group + "/material", text);
    puncture.material = split_lines(text);
    if (puncture.empty()) {
      file.fail(fmt::format("dataset {}/material is empty, must have 1 to {} lines",
                            group, kMostPunctureMaterials));
    }
  }
  for_each_puncture_dataset(
      puncture, [&](const std::string& name, const char* units, auto& values) {
        file.dataset(group + name, units, values);
      });
  if (file.optional_dataset(group + "/membrane_j", !puncture.membrane_j.empty())) {
    file.dataset(group + "/membrane_j", "J", puncture.membrane_j);
  }
}

}  // namespace palpate::content
