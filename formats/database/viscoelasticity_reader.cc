#include "formats/database/viscoelasticity_reader.h"

#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/database/database_layout.h"
#include "formats/database/viscoelasticity_rules.h"
#include "formats/stored/stored_reader.h"

namespace palpate {
namespace {

void read_shares(StoredReader& file, const std::string& group, std::int64_t nodes,
                 Viscoelasticity& relaxation) {
  const std::string path = content::ViscoelasticityGroups(group).relaxation + "/g";
  const std::int64_t terms = relaxation.terms();
  if (file.shape_of(path, "1", StoredType::kFloat32, {-1, terms}).front() == 1) {
    file.dataset(path, "1", relaxation.g);
    check_node_rows(group, relaxation, 1, 0);
  } else {
    static_cast<void>(file.shape_of(path, "1", StoredType::kFloat32, {nodes, terms}));
    relaxation.g.resize(0, terms);
  }
}

// Of rows of nodes only that there are some.
void read_yielding_head(StoredReader& file, const std::string& group,
                        std::int64_t nodes, ToolIndex& tool) {
  for_each_dataset(tool.viscoelasticity.yielding, [&](const std::string& name,
                                                      const char* units, auto& values) {
    const std::string path = group + name;
    if (!file.has(path)) {
      return;
    }
    if (file.shape_of(path, units, StoredType::kFloat64, {-1}).front() == 1) {
      file.dataset(path, units, values);
    } else {
      static_cast<void>(file.shape_of(path, units, StoredType::kFloat64, {nodes}));
      tool.yielding_rows = true;
    }
  });
  check_yielding(group, tool.viscoelasticity.yielding, nodes);
}

}  // namespace

void read_viscoelasticity_head(StoredReader& file, const std::string& group,
                               std::int64_t nodes, ToolIndex& tool) {
  const content::ViscoelasticityGroups groups(group);
  Viscoelasticity& relaxation = tool.viscoelasticity;
  if (file.has(groups.relaxation + "/tau_s")) {
    content::exchange_relaxation_head(file, groups.relaxation, relaxation);
    check_terms(group, relaxation);
    read_shares(file, group, nodes, relaxation);
  }
  read_yielding_head(file, group, nodes, tool);
  if (!file.has(groups.memory)) {
    return;
  }
  content::exchange_sites_head(file, groups.memory, relaxation);
  check_terms(group, relaxation);
  if (file.has(groups.memory + "/site")) {
    tool.memory_sites =
        file.shape_of(groups.memory + "/site_node", "1", StoredType::kInt32, {-1})
            .front();
    for (const auto& [name, type] : {std::pair{"/site", StoredType::kInt32},
                                     std::pair{"/weight", StoredType::kFloat32}}) {
      // Rows by node are read chunk by chunk later; their shapes are checked here.
      static_cast<void>(
          file.shape_of(groups.memory + name, "1", type, {nodes, kMostNodeSites}));
    }
  }
}

void read_node_rows(const StoredReader& file, const std::string& group,
                    const ToolIndex& tool, std::int64_t begin, std::int64_t count,
                    Viscoelasticity& relaxation) {
  const content::ViscoelasticityGroups groups(group);
  const auto rows = [&](const std::string& path, auto& values, std::int64_t columns) {
    using Value = typename std::remove_reference_t<decltype(values)>::Scalar;
    values.resize(count, columns);
    file.rows(path, "1", stored_type<Value>(), begin, count, columns, values.data());
  };
  // Without a row of the whole tool, g has one for each node.
  if (!relaxation.empty() && relaxation.g.rows() == 0) {
    rows(groups.relaxation + "/g", relaxation.g, relaxation.terms());
  }
  if (tool.memory_sites > 0) {
    rows(groups.memory + "/site", relaxation.sites.site, kMostNodeSites);
    rows(groups.memory + "/weight", relaxation.sites.weight, kMostNodeSites);
  }
  for_each_dataset(relaxation.yielding, [&](const std::string& name, const char* units,
                                            auto& values) {
    if (tool.yielding_rows && values.empty() && file.has(group + name)) {
      values.resize(static_cast<std::size_t>(count));
      file.rows(group + name, units, StoredType::kFloat64, begin, count, 0,
                values.data());
    }
  });
}

void check_shares(const ToolIndex& tool, std::int64_t chunk,
                  const Viscoelasticity& part) {
  if (tool.share_min.rows() == 0) {
    return;
  }
  const ShareExtent extent = share_extent(part);
  if (tool.share_min.row(chunk) != extent.low ||
      tool.share_max.row(chunk) != extent.high) {
    throw FormatError(fmt::format(
        "/tools/{}/index/share_min, share_max: row {} must have the smallest and the "
        "largest shares of chunk {}",
        tool.tool.name, chunk, chunk));
  }
}

}  // namespace palpate
