#include "runtime/slow/contact_elements.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/contact_set.h"
#include "formats/response/tool_support.h"
#include "runtime/slow/memory_elements.h"

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

void refuse_needle(const PressingTool& tool) {
  if (!tool.puncture.empty()) {
    throw InputError(fmt::format(
        "tool \"{}\" is a needle, and contacts that are coupled puncture nothing: "
        "render it alone, or beside others as a tool of its own",
        tool.shape.name));
  }
}

void check_renderable(const PressingTool& tool, int contacts) {
  const std::string& name = tool.shape.name;
  if (tool.compliance.empty()) {
    throw InputError(fmt::format(
        "tool \"{}\" has no table of compliance, which {} contacts on one body need: "
        "build the database again with palpate-precompute from a scene whose [[tool]] "
        "has shape = \"spheres\" or compliance = true",
        name, contacts));
  }
  const Viscoelasticity& relaxation = tool.relaxation;
  if (!relaxation.empty() && !relaxation.instantaneous) {
    throw InputError(fmt::format(
        "tool \"{}\" relaxes, and its curves are of a press at {} m/s, as its "
        "table of compliance is: {} contacts need instantaneous ones, as "
        "palpate-precompute builds them",
        name, relaxation.speed_m_per_s, contacts));
  }
}

std::size_t radii_of(const ToolShape& tool) {
  return tool.contact.empty() ? 1 : distinct_radii(tool.contact).size();
}

std::vector<PressingTool> pressing(std::span<const ResponseTable* const> tables) {
  std::vector<PressingTool> tools;
  for (const ResponseTable* table : tables) {
    tools.emplace_back(*table);
  }
  return tools;
}

std::vector<std::unique_ptr<TableElements>> in_memory(
    const ResponseDatabase& database, std::span<const ResponseTable* const> tools,
    double force_scale) {
  const bool couples = !is_alone(coupled_set(tools));
  std::vector<std::unique_ptr<TableElements>> all;
  for (const ResponseTable* responses : response_tables(database, tools)) {
    all.push_back(std::make_unique<ElementStream>(
        database, *responses, force_scale,
        couples ? &tools.front()->compliance : nullptr));
  }
  return all;
}

}  // namespace

const ResponseTable& table_of_radius(const ResponseDatabase& database,
                                     const ResponseTable& tool, std::size_t radius) {
  return radius == 0 ? tool : find_tool(database, table_name(tool.tool.name, radius));
}

std::vector<std::string> response_names(std::span<const PressingTool> tools) {
  std::vector<std::string> names;
  for (const PressingTool& tool : tools) {
    for (std::size_t i = 0; i < radii_of(tool.shape); ++i) {
      names.push_back(table_name(tool.shape.name, i));
    }
  }
  if (names.size() > static_cast<std::size_t>(kResponseTables)) {
    throw InputError(
        fmt::format("contacts have {} radii, must have {} at most: give spheres of "
                    "nearly one size the same radius",
                    names.size(), kResponseTables));
  }
  return names;
}

std::vector<const ResponseTable*> response_tables(
    const ResponseDatabase& database, std::span<const ResponseTable* const> tools) {
  std::vector<const ResponseTable*> tables;
  for (const std::string& name : response_names(pressing(tools))) {
    tables.push_back(&find_tool(database, name));
  }
  return tables;
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

CoupledSet coupled_set(std::span<const ResponseTable* const> tools) {
  return coupled_set(pressing(tools));
}

CoupledSet coupled_set(std::span<const PressingTool> tools) {
  if (tools.empty() || tools.size() > static_cast<std::size_t>(kPortsMax)) {
    throw InputError(fmt::format("{} tools press one body together, must be 1 to {}",
                                 tools.size(), kPortsMax));
  }
  CoupledSet set;
  set.ports = static_cast<int>(tools.size());
  static_cast<void>(response_names(tools));
  std::size_t first = 0;
  for (std::size_t port = 0; port < tools.size(); ++port) {
    const ToolShape& tool = tools[port].shape;
    if (tools.size() > 1 || !tool.contact.empty()) {
      refuse_needle(tools[port]);
    }
    add_spheres(tool, port, first, set);
    first += radii_of(tool);
  }
  if (!is_alone(set)) {
    for (const PressingTool& tool : tools) {
      check_renderable(tool, set.count);
    }
    // What couples contacts is the body's: the first tool's table serves all.
    const ComplianceTable& body = tools.front().compliance;
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
    : ContactStream(pressing(tools), in_memory(database, tools, force_scale)) {}

ContactStream::ContactStream(std::span<const PressingTool> tools,
                             std::vector<std::unique_ptr<TableElements>> table)
    : set_(coupled_set(tools)),
      names_(response_names(tools)),
      table_(std::move(table)) {}

TableElements& ContactStream::table_of(int i) const {
  const ContactSphere& sphere = set_.sphere[static_cast<std::size_t>(i)];
  return *table_[static_cast<std::size_t>(sphere.table)];
}

ContactElement ContactStream::element(int i, std::int32_t triangle) const {
  const TableElements& table = table_of(i);
  return {
      .contact = i, .element = table.element(triangle), .row = table.rows(triangle)};
}

std::optional<ContactElement> ContactStream::element_of(int i,
                                                        std::int32_t triangle) const {
  if (i < 0 || i >= set_.count) {
    return std::nullopt;
  }
  const std::optional<Element> element = table_of(i).element_of(triangle);
  return element ? std::optional(ContactElement{.contact = i,
                                                .element = *element,
                                                .row = table_of(i).rows(triangle)})
                 : std::nullopt;
}

// Each table sees its own contacts.
void ContactStream::follow(const ContactToolState& tool) {
  std::array<ToolState, kContactsMax> contact;
  for (std::size_t table = 0; table < table_.size(); ++table) {
    std::size_t count = 0;
    for (int i = 0; i < std::min(tool.count, set_.count); ++i) {
      const auto self = static_cast<std::size_t>(i);
      if (static_cast<std::size_t>(set_.sphere[self].table) == table &&
          tool.contact[self].position_m.allFinite()) {
        contact[count++] = tool.contact[self];
      }
    }
    table_[table]->follow(std::span(contact).first(count));
  }
}

std::size_t ContactStream::update(int i, const ToolState& at, std::int64_t now_ns,
                                  ContactFifo& fifo, ContactSent& sent) {
  if (!at.position_m.allFinite()) {
    return 0;
  }
  const auto self = static_cast<std::size_t>(i);
  const WantedTriangles wanted = table_of(i).wanted(at);
  ContactSent::Contact& last = sent.contact[self];
  const bool same =
      last.whole && last.wanted.count == wanted.count &&
      std::equal(wanted.triangle.begin(),
                 wanted.triangle.begin() + static_cast<std::ptrdiff_t>(wanted.count),
                 last.wanted.triangle.begin());
  // Messages may be dropped on the way. A contact whose triangles are the same sends
  // them again where updates mod `turns` is i mod `turns`.
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
  follow(tool);
  std::size_t pushed = 0;
  for (int i = 0; i < std::min(tool.count, set_.count); ++i) {
    pushed += update(i, tool.contact[static_cast<std::size_t>(i)], now_ns, fifo, sent);
  }
  return pushed;
}

}  // namespace palpate
