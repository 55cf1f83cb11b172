#include "runtime/c_api/host_drawing.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/displaced_surface.h"

namespace palpate {
namespace {

const ResponseDatabase& database_of(const HostBody& body) {
  if (body.database() == nullptr) {
    throw InputError(
        "displacements need a database in memory: open it without streaming, or build "
        "the scene first");
  }
  return *body.database();
}

double own_depth_m(const BodyContact& contact) {
  return contact.at.depth_m - contact.at.dimple_m;
}

void check(const BodyContact& contact, const HostTool& tool,
           const ResponseDatabase& database) {
  const auto tables = static_cast<std::int32_t>(tool.tables().size());
  if (contact.table < 0 || contact.table >= tables ||
      contact.at.triangle >= database.body.triangle.rows() ||
      !std::isfinite(own_depth_m(contact)) || !contact.at.share.allFinite()) {
    throw InputError(
        fmt::format("a contact of table {}, triangle {} and depth {} m is none of this "
                    "tool's",
                    contact.table, contact.at.triangle, own_depth_m(contact)));
  }
}

// The fields at a contact's corners; none unless all that count are stored.
std::vector<PressedField> fields_under(const BodyContact& contact,
                                       const SurfaceMesh& mesh,
                                       const DisplacementField& field) {
  std::vector<PressedField> pressed;
  for (Eigen::Index corner = 0; corner < 3; ++corner) {
    const double share = contact.at.share[corner];
    if (share == 0.0) {
      continue;
    }
    const Eigen::Index row =
        deepest_field(field, mesh.triangle(contact.at.triangle, corner));
    if (row < 0) {
      return {};
    }
    pressed.push_back({row, share * own_depth_m(contact)});
  }
  return pressed;
}

}  // namespace

DisplacedSurface displaced_surface(const HostBody& body, const HostTool& tool,
                                   std::span<const BodyContact> contacts) {
  const ResponseDatabase& database = database_of(body);
  std::vector<std::vector<PressedField>> pressed(tool.tables().size());
  const auto field_of = [&](std::size_t table) -> const DisplacementField& {
    return find_tool(database, tool.tables()[table]).displacement;
  };
  DisplacedSurface surface;
  for (const BodyContact& contact : contacts) {
    check(contact, tool, database);
    if (!contact.at.touching || contact.at.triangle < 0 ||
        !(own_depth_m(contact) > 0.0)) {
      continue;
    }
    const auto table = static_cast<std::size_t>(contact.table);
    // Fields of the three corners by their shares of the contact's depth.
    const std::vector<PressedField> under =
        fields_under(contact, database.body, field_of(table));
    surface.known += under.empty() ? 0 : 1;
    pressed[table].insert(pressed[table].end(), under.begin(), under.end());
  }
  surface.moved_m = Points::Zero(database.body.position_m.rows(), 3);
  for (std::size_t table = 0; table < pressed.size(); ++table) {
    if (!pressed[table].empty()) {
      // Displacements of contacts add up, as in a linear body.
      surface.moved_m += displaced_m(field_of(table), pressed[table]);
    }
  }
  for (Eigen::Index i = 0; i < surface.moved_m.rows(); ++i) {
    surface.moved_m.row(i) = body.placement()
                                 .vector_in_world(surface.moved_m.row(i).transpose())
                                 .transpose();
  }
  return surface;
}

}  // namespace palpate
