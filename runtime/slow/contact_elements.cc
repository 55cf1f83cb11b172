#include "runtime/slow/contact_elements.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/contact_set.h"
#include "formats/response/tool_support.h"

namespace palpate {
namespace {

// The spheres of one tool. @param table number of its first radius.
void add_spheres(const ToolShape& tool, std::size_t port, std::size_t table,
                 CoupledSet& set) {
  const auto add = [&](const Eigen::Vector3d& centre_m, double radius_m,
                       std::size_t radius) {
    if (set.count == kContactsMax) {
      throw InputError(
          fmt::format("the tools have more than {} contacts together", kContactsMax));
    }
    ContactSphere& sphere = set.sphere[static_cast<std::size_t>(set.count++)];
    sphere.centre_m = centre_m;
    sphere.radius_m = radius_m;
    sphere.port = static_cast<std::int8_t>(port);
    sphere.table = static_cast<std::int8_t>(table + radius);
  };
  if (tool.contact.empty()) {
    add(Eigen::Vector3d::Zero(), nominal_height_m(tool), 0);
    return;
  }
  const std::vector<std::size_t> radius = radius_of_contacts(tool.contact);
  for (std::size_t i = 0; i < radius.size(); ++i) {
    add(tool.contact.point_m.row(static_cast<Eigen::Index>(i)).transpose(),
        tool.contact.radius_m[i], radius[i]);
  }
}

void check_renderable(const ResponseTable& tool, int contacts) {
  const std::string& name = tool.tool.name;
  if (tool.compliance.empty()) {
    throw InputError(fmt::format(
        "tool \"{}\" has no table of compliance, which {} contacts on one body need: "
        "build the database again with palpate-precompute from a scene whose [[tool]] "
        "has shape = \"spheres\" or compliance = true",
        name, contacts));
  }
  const Viscoelasticity& relaxation = tool.viscoelasticity;
  if (!relaxation.empty() && !relaxation.instantaneous) {
    throw InputError(fmt::format(
        "tool \"{}\" relaxes, and its curves are of a press at {} m/s, as its "
        "table of compliance is: {} contacts need instantaneous ones, as "
        "palpate-precompute builds them",
        name, relaxation.speed_m_per_s, contacts));
  }
}

}  // namespace

const ResponseTable& table_of_radius(const ResponseDatabase& database,
                                     const ResponseTable& tool, std::size_t radius) {
  return radius == 0 ? tool : find_tool(database, table_name(tool.tool.name, radius));
}

std::vector<const ResponseTable*> response_tables(
    const ResponseDatabase& database, std::span<const ResponseTable* const> tools) {
  std::vector<const ResponseTable*> tables;
  for (const ResponseTable* tool : tools) {
    const std::size_t radii =
        tool->tool.contact.empty() ? 1 : distinct_radii(tool->tool.contact).size();
    for (std::size_t i = 0; i < radii; ++i) {
      tables.push_back(&table_of_radius(database, *tool, i));
    }
  }
  if (tables.size() > static_cast<std::size_t>(kResponseTables)) {
    throw InputError(
        fmt::format("contacts have {} radii, must have {} at most: give spheres of "
                    "nearly one size the same radius",
                    tables.size(), kResponseTables));
  }
  return tables;
}

ContactRow contact_row(const ComplianceTable& table, std::int64_t node,
                       double force_scale) {
  ContactRow row;
  const auto softer = static_cast<float>(1.0 / force_scale);
  const auto root = static_cast<float>(1.0 / std::sqrt(force_scale));
  for (Eigen::Index k = 0; k < table.value.cols(); ++k) {
    row.value[static_cast<std::size_t>(k)] = softer * table.value(node, k);
  }
  for (Eigen::Index m = 0; m < table.mode.cols(); ++m) {
    row.mode[static_cast<std::size_t>(m)] = root * table.mode(node, m);
  }
  return row;
}

ContactToolState contact_tool_state(const CoupledState& state,
                                    std::uint64_t ticks) noexcept {
  ContactToolState all;
  all.sequence = ticks;
  all.count = state.set.count;
  for (int i = 0; i < state.set.count; ++i) {
    const ContactPlace at = contact_place(state, i);
    all.contact[static_cast<std::size_t>(i)] = {.sequence = ticks,
                                                .time_ns = state.latest.time_ns,
                                                .position_m = at.centre_m,
                                                .triangle = at.triangle,
                                                .in_contact = at.touching};
  }
  return all;
}

CoupledSet coupled_set(const ResponseDatabase& database,
                       std::span<const ResponseTable* const> tools) {
  if (tools.empty() || tools.size() > static_cast<std::size_t>(kPortsMax)) {
    throw InputError(fmt::format("{} tools press one body together, must be 1 to {}",
                                 tools.size(), kPortsMax));
  }
  CoupledSet set;
  set.ports = static_cast<int>(tools.size());
  (void)response_tables(database, tools);
  std::size_t first = 0;
  for (std::size_t port = 0; port < tools.size(); ++port) {
    const ToolShape& tool = tools[port]->tool;
    add_spheres(tool, port, first, set);
    first += tool.contact.empty() ? 1 : distinct_radii(tool.contact).size();
  }
  if (!is_alone(set)) {
    for (const ResponseTable* tool : tools) {
      check_renderable(*tool, set.count);
    }
    const ComplianceTable& body = tools.front()->compliance;
    set.knots = knots_of(body);
    set.modes = static_cast<int>(body.modes());
    set.added_modes = static_cast<int>(body.added_modes);
  }
  if (const char* wrong = finish(set)) {
    throw InputError(fmt::format("contacts: {}", wrong));
  }
  return set;
}

ContactStream::ContactStream(const ResponseDatabase& database,
                             std::span<const ResponseTable* const> tools,
                             double force_scale)
    : database_(database),
      set_(coupled_set(database, tools)),
      compliance_(is_alone(set_) ? nullptr : &tools.front()->compliance),
      force_scale_(force_scale) {
  for (const ResponseTable* responses : response_tables(database, tools)) {
    tables_.push_back(responses->tool.name);
    radius_.push_back(
        std::make_unique<ElementStream>(database, *responses, force_scale));
  }
}

ContactElement ContactStream::element(int i, std::int32_t triangle) const {
  const ContactSphere& sphere = set_.sphere[static_cast<std::size_t>(i)];
  ContactElement message;
  message.contact = i;
  message.element = radius_[static_cast<std::size_t>(sphere.table)]->element(triangle);
  for (std::size_t a = 0; a < 3 && compliance_ != nullptr; ++a) {
    message.row[a] = contact_row(
        *compliance_, database_.body.triangle(triangle, static_cast<Eigen::Index>(a)),
        force_scale_);
  }
  return message;
}

std::optional<ContactElement> ContactStream::element_of(int i,
                                                        std::int32_t triangle) const {
  const bool there = i >= 0 && i < set_.count && triangle >= 0 &&
                     triangle < database_.body.triangle.rows();
  return there ? std::optional(element(i, triangle)) : std::nullopt;
}

std::size_t ContactStream::update(int i, const ToolState& at, std::int64_t now_ns,
                                  ContactFifo& fifo, ContactSent& sent) {
  if (!at.position_m.allFinite()) {
    return 0;
  }
  const auto self = static_cast<std::size_t>(i);
  const SurfaceSearch& search = radius_.front()->search();
  const bool walk =
      at.in_contact && at.triangle >= 0 && at.triangle < database_.body.triangle.rows();
  const std::int32_t active =
      (walk ? search.walk(at.position_m, at.triangle) : search.nearest(at.position_m))
          .triangle;
  if (active < 0) {
    return 0;
  }
  const WantedTriangles wanted =
      wanted_triangles(search, active, walk ? at.triangle : -1);
  ContactSent::Contact& last = sent.contact[self];
  const bool same =
      last.whole && last.wanted.count == wanted.count &&
      std::equal(wanted.triangle.begin(),
                 wanted.triangle.begin() + static_cast<std::ptrdiff_t>(wanted.count),
                 last.wanted.triangle.begin());
  const auto turns =
      static_cast<std::uint64_t>(std::min(set_.count, ContactSent::kRepeatUpdates));
  if (same && sent.updates % turns != self % turns) {
    return 0;
  }
  std::size_t pushed = 0;
  for (std::size_t t = 0; t < wanted.count; ++t) {
    ContactElement message = element(i, wanted.triangle[t]);
    message.element.sequence = ++sequence_;
    message.element.sent_ns = now_ns;
    message.element.active = t == 0;
    pushed += fifo.push(message) ? 1 : 0;
  }
  last = {wanted, pushed == wanted.count};
  return pushed;
}

std::size_t ContactStream::update(const ContactToolState& tool, std::int64_t now_ns,
                                  ContactFifo& fifo, ContactSent& sent) {
  ++sent.updates;
  std::size_t pushed = 0;
  for (int i = 0; i < std::min(tool.count, set_.count); ++i) {
    pushed += update(i, tool.contact[static_cast<std::size_t>(i)], now_ns, fifo, sent);
  }
  return pushed;
}

}  // namespace palpate
