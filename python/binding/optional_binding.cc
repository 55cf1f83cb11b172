// The parts of a tool that a database may leave out, as dicts of read-only arrays.
#include "python/binding/array_view.h"
#include "python/binding/bind.h"
#include "python/binding/held_database.h"

#include <pybind11/stl.h>

namespace py = pybind11;

namespace palpate {
namespace {

py::dict accuracy(const HeldTool& tool) {
  const AccuracyRecord& from = tool.table->accuracy;
  const py::object owner = py::cast(tool.held);
  py::dict parts;
  parts["budget_relative"] = from.budget_relative;
  parts["error_factor"] = from.error_factor;
  parts["hard_error_factor"] = from.hard_error_factor;
  parts["covered"] = from.covered;
  parts["hard_covered"] = from.hard_covered;
  parts["verified"] = from.verified;
  parts["between_nodes"] = from.between_nodes;
  parts["quantile_level"] = looking_at(from.quantile_level, owner);
  parts["error_relative"] = looking_at(from.error_relative, owner);
  parts["depth_share"] = looking_at(from.depth_share, owner);
  parts["covering_relative"] = looking_at(from.covering_relative, owner);
  return parts;
}

py::dict displacement(const HeldTool& tool) {
  const DisplacementField& from = tool.table->displacement;
  const py::object owner = py::cast(tool.held);
  py::dict parts;
  parts["basis"] = rows_of(from.basis, owner);
  parts["coefficient"] = rows_of(from.coefficient, owner);
  parts["node"] = looking_at(from.node, owner);
  parts["depth_m"] = looking_at(from.depth_m, owner);
  parts["error_relative"] = looking_at(from.error_relative, owner);
  return parts;
}

py::dict relaxation(const HeldTool& tool) {
  const ResponseRelaxation& from = tool.table->relaxation;
  const py::object owner = py::cast(tool.held);
  py::dict parts;
  parts["rule"] = from.rule;
  parts["probes"] = from.probes;
  parts["speed_m_per_s"] = from.speed_m_per_s;
  parts["seconds"] = from.seconds;
  parts["g_1"] = looking_at(from.terms.g_1, owner);
  parts["g_2"] = looking_at(from.terms.g_2, owner);
  parts["tau_1_s"] = looking_at(from.terms.tau_1_s, owner);
  parts["tau_2_s"] = looking_at(from.terms.tau_2_s, owner);
  return parts;
}

py::dict viscoelasticity(const HeldTool& tool) {
  const Viscoelasticity& from = tool.table->viscoelasticity;
  const py::object owner = py::cast(tool.held);
  py::dict parts;
  parts["rule"] = from.rule;
  parts["probes"] = from.probes;
  parts["instantaneous"] = from.instantaneous;
  parts["speed_m_per_s"] = from.speed_m_per_s;
  parts["tau_s"] = looking_at(from.tau_s, owner);
  parts["g"] = rows_of(from.g, owner);
  parts["error_relative"] = looking_at(from.error_relative, owner);
  parts["site_spacing_m"] = from.sites.spacing_m;
  parts["site_node"] = looking_at(from.sites.node, owner);
  parts["site"] = rows_of(from.sites.site, owner);
  parts["site_weight"] = rows_of(from.sites.weight, owner);
  parts["bundle_depth_m"] = looking_at(from.bundle_depth_m, owner);
  for_each_dataset(from.yielding, [&](const std::string& name, const char* /*units*/,
                                      const std::vector<double>& rows) {
    parts[py::str(name.substr(1))] = looking_at(rows, owner);  // "plastic/share"
  });
  return parts;
}

py::dict puncture(const HeldTool& tool) {
  const Puncture& from = tool.table->puncture;
  const py::object owner = py::cast(tool.held);
  py::dict parts;
  parts["rule"] = from.rule;
  parts["material"] = from.material;
  parts["membrane_n"] = looking_at(from.membrane_n, owner);
  parts["cutting_n"] = looking_at(from.cutting_n, owner);
  parts["friction_n_per_m"] = looking_at(from.friction_n_per_m, owner);
  parts["static_ratio"] = looking_at(from.static_ratio, owner);
  parts["toughness_j_per_m2"] = looking_at(from.toughness_j_per_m2, owner);
  const auto add = [&](const char* name, double number) {
    parts[name] = number;
  };
  for_each_puncture_number(from, add);
  for_each_optional_puncture_number(from, add);
  if (!from.membrane_j.empty()) {
    parts["membrane_j"] = looking_at(from.membrane_j, owner);
  }
  parts["rupture"] = looking_at(from.rupture, owner);
  parts["layer_depth_m"] = rows_of(from.layer_depth_m, owner);
  parts["layer_material"] = rows_of(from.layer_material, owner);
  return parts;
}

}  // namespace

void bind_optional(py::class_<HeldTool>& type) {
  type.def_property_readonly(
      "accuracy", &accuracy,
      "how well the budget was kept; budget_relative 0: no record");
  type.def_property_readonly("displacement", &displacement,
                             "surface under the tool: basis (3 n, m) [-], coefficient "
                             "(k, m) [m], node (k,), depth_m (k,)");
  type.def_property_readonly(
      "relaxation", &relaxation,
      "what holds showed: g_1, g_2 [-], tau_1_s, tau_2_s [s], one "
      "row or (n,); empty if unknown");
  type.def_property_readonly("viscoelasticity", &viscoelasticity,
                             "as it is rendered: tau_s (K,) [s], g (1 or n, K) [-], "
                             "memory sites, yielding; empty if nothing relaxes");
  type.def_property_readonly("puncture", &puncture,
                             "of a needle: material (m,), their forces, rupture [N or "
                             "J], layers (1 or n, K); empty if nothing is punctured");
}

}  // namespace palpate
