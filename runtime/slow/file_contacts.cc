#include "runtime/slow/file_contacts.h"

#include <algorithm>
#include <array>

namespace palpate {
namespace {

// Of the contacts that one table answers.
ContactSpread spread_of(const CoupledSet& set, std::size_t table) {
  ContactSpread spread;
  std::array<int, kPortsMax> contacts{};
  const auto is_of = [&](const ContactSphere& sphere) {
    return static_cast<std::size_t>(sphere.table) == table;
  };
  for (int i = 0; i < set.count; ++i) {
    const ContactSphere& a = set.sphere[static_cast<std::size_t>(i)];
    if (!is_of(a)) {
      continue;
    }
    ++contacts[static_cast<std::size_t>(a.port)];
    for (int j = 0; j < i; ++j) {
      const ContactSphere& b = set.sphere[static_cast<std::size_t>(j)];
      if (is_of(b) && b.port == a.port) {
        spread.extent_m = std::max(spread.extent_m, (a.centre_m - b.centre_m).norm());
      }
    }
  }
  spread.contacts = std::ranges::max(contacts);
  spread.hands = static_cast<int>(kPortsMax - std::ranges::count(contacts, 0));
  return spread;
}

}  // namespace

std::vector<PressingTool> pressing_tools(const DatabaseIndex& index,
                                         std::span<const std::string> names) {
  std::vector<PressingTool> tools;
  for (const std::string& name : names) {
    tools.emplace_back(index.tools[find_tool(index, name)]);
  }
  return tools;
}

std::shared_ptr<ContactStream> streamed_contacts(const DatabaseIndex& index,
                                                 const StoredSource& file,
                                                 std::span<const std::string> tools,
                                                 const CacheOptions& cache,
                                                 const Eigen::Vector3d& start_m,
                                                 bool in_thread) {
  const std::vector<PressingTool> pressing = pressing_tools(index, tools);
  const CoupledSet set = coupled_set(pressing);
  const std::vector<std::string> names = response_names(pressing);
  std::vector<std::unique_ptr<TableElements>> tables;
  for (std::size_t table = 0; table < names.size(); ++table) {
    CacheOptions own = cache;
    own.tool = names[table];
    own.coupling = is_alone(set) ? "" : pressing.front().shape.name;
    own.budget_bytes = cache.budget_bytes / names.size();
    own.spread = spread_of(set, table);
    tables.push_back(std::make_unique<StreamedElements>(file, own, start_m, in_thread));
  }
  return std::make_shared<ContactStream>(pressing, std::move(tables));
}

}  // namespace palpate
