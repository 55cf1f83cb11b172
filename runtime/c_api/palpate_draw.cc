// The C interface's displaced surface, for drawing.
#include "runtime/c_api/palpate_draw.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/displaced_surface.h"
#include "runtime/c_api/guarded.h"
#include "runtime/c_api/host_handles.h"

namespace {

using palpate::InputError;
using palpate::PressedField;
using palpate::ResponseDatabase;

const ResponseDatabase& database_of(const palpate_tool& tool) {
  const ResponseDatabase* database = tool.body.database();
  if (database == nullptr) {
    throw InputError(
        "displacements need a database in memory: open it without streaming, or build "
        "the scene first");
  }
  return *database;
}

// @throws InputError for what no palpate_contacts_get() gives.
void check(const palpate_contact& contact, const palpate_tool& tool,
           const ResponseDatabase& database) {
  const auto tables = static_cast<std::int32_t>(tool.tool.tables().size());
  if (contact.table < 0 || contact.table >= tables ||
      contact.triangle >= database.body.triangle.rows() ||
      !std::isfinite(contact.own_depth) ||
      !Eigen::Map<const Eigen::Vector3d>(contact.shares).allFinite()) {
    throw InputError(
        fmt::format("a contact of table {}, triangle {} and depth {} is none of this "
                    "tool's, as palpate_contacts_get() fills them",
                    contact.table, contact.triangle, contact.own_depth));
  }
}

// The fields at a contact's corners; none unless all that count are stored.
std::vector<PressedField> fields_under(const palpate_contact& contact,
                                       const palpate::SurfaceMesh& mesh,
                                       const palpate::DisplacementField& field,
                                       double depth_m) {
  std::vector<PressedField> pressed;
  for (Eigen::Index corner = 0; corner < 3; ++corner) {
    const double share = contact.shares[corner];
    if (share == 0.0) {
      continue;
    }
    const Eigen::Index row =
        palpate::deepest_field(field, mesh.triangle(contact.triangle, corner));
    if (row < 0) {
      return {};
    }
    pressed.push_back({row, share * depth_m});
  }
  return pressed;
}

int displace(const palpate_tool& tool, std::span<const palpate_contact> contacts,
             double* displacements) {
  const ResponseDatabase& database = database_of(tool);
  std::vector<std::vector<PressedField>> pressed(tool.tool.tables().size());
  int known = 0;
  for (const palpate_contact& contact : contacts) {
    check(contact, tool, database);
    if (contact.touching == 0 || contact.triangle < 0 || !(contact.own_depth > 0.0)) {
      continue;
    }
    const auto table = static_cast<std::size_t>(contact.table);
    const std::vector<PressedField> under =
        fields_under(contact, database.body,
                     find_tool(database, tool.tool.tables()[table]).displacement,
                     contact.own_depth * tool.metres_per_unit);
    known += under.empty() ? 0 : 1;
    pressed[table].insert(pressed[table].end(), under.begin(), under.end());
  }
  Eigen::Map<palpate::Points> moved(displacements, database.body.position_m.rows(), 3);
  moved.setZero();
  for (std::size_t table = 0; table < pressed.size(); ++table) {
    if (!pressed[table].empty()) {
      moved += palpate::displaced_m(
          find_tool(database, tool.tool.tables()[table]).displacement, pressed[table]);
    }
  }
  for (Eigen::Index i = 0; i < moved.rows(); ++i) {
    moved.row(i) = tool.body.placement()
                       .vector_in_world(moved.row(i).transpose() / tool.metres_per_unit)
                       .transpose();
  }
  return known;
}

}  // namespace

int palpate_displaced(const palpate_tool* tool, const palpate_contact* contacts,
                      size_t count, size_t contact_bytes, double* displacements,
                      char* error, size_t error_bytes) {
  palpate::copy_text("", error, error_bytes);
  return palpate::guarded(error, error_bytes, [&] {
    if (tool == nullptr || displacements == nullptr ||
        (count > 0 && contacts == nullptr) || contact_bytes < sizeof(size_t)) {
      throw InputError("no tool, contacts or displacements: a pointer is null");
    }
    std::vector<palpate_contact> all(count);
    for (size_t i = 0; i < count; ++i) {
      std::memcpy(&all[i],
                  reinterpret_cast<const unsigned char*>(contacts) + i * contact_bytes,
                  std::min(contact_bytes, sizeof(palpate_contact)));
    }
    return displace(*tool, all, displacements);
  });
}
