#include "formats/database/database_index.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "formats/base/sha256.h"
#include "formats/database/chunk_digest.h"
#include "formats/database/index_layout.h"

namespace palpate {
namespace {

void set_digest(Sha256Rows& rows, std::int64_t row,
                const std::vector<std::uint8_t>& to) {
  std::copy(to.begin(), to.end(), rows.row(row).data());
}

double largest_between(const std::vector<double>& values, std::int64_t begin,
                       std::int64_t end) {
  return begin == end ? 0.0
                      : *std::max_element(values.begin() + begin, values.begin() + end);
}

BodyChunk body_chunk(const ResponseDatabase& ordered, const StorageOrder& order,
                     const DatabaseIndex& index, std::int64_t k) {
  const auto c = static_cast<std::size_t>(k);
  const std::int64_t node = index.node_begin[c];
  const std::int64_t nodes = index.node_begin[c + 1] - node;
  const std::int64_t triangle = index.triangle_begin[c];
  const std::int64_t triangles = index.triangle_begin[c + 1] - triangle;
  return {node,
          ordered.body.position_m.middleRows(node, nodes),
          ordered.normal.middleRows(node, nodes),
          ordered.body.triangle.middleRows(triangle, triangles),
          {order.node.begin() + node, order.node.begin() + node + nodes},
          {order.triangle.begin() + triangle,
           order.triangle.begin() + triangle + triangles}};
}

// Of its nodes and of its triangles, whose other nodes may lie in later chunks.
Eigen::AlignedBox3d box_around(const BodyChunk& chunk, const Points& position_m) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < chunk.position_m.rows(); ++i) {
    box.extend(Eigen::Vector3d(chunk.position_m.row(i).transpose()));
  }
  for (Eigen::Index t = 0; t < chunk.triangle.rows(); ++t) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      box.extend(Eigen::Vector3d(position_m.row(chunk.triangle(t, j)).transpose()));
    }
  }
  return box;
}

void divide_nodes(const ResponseDatabase& ordered, DatabaseIndex& index) {
  const std::int64_t n = ordered.body.position_m.rows();
  const std::int64_t size = ordered.storage.chunk_nodes;
  for (std::int64_t begin = 0; begin < n; begin += size) {
    index.node_begin.push_back(begin);
  }
  index.node_begin.push_back(n);
  // Triangles are ordered by their first node.
  std::int64_t t = 0;
  for (const std::int64_t begin : index.node_begin) {
    while (t < ordered.body.triangle.rows() &&
           ordered.body.triangle.row(t).minCoeff() < begin) {
      ++t;
    }
    index.triangle_begin.push_back(t);
  }
}

// What the index keeps: no rows of nodes or sites.
Viscoelasticity head_of(const Viscoelasticity& relaxation) {
  Viscoelasticity head = relaxation;
  head.error_relative.clear();
  head.sites = {.spacing_m = relaxation.sites.spacing_m};
  if (relaxation.g.rows() > 1) {
    head.g.resize(0, relaxation.g.cols());
  }
  for_each_dataset(head.yielding, [](const auto&, const auto&, auto& values) {
    if (values.size() > 1) {
      values.clear();
    }
  });
  return head;
}

bool has_rows(const Yielding& yielding) {
  bool any = false;
  for_each_dataset(yielding, [&any](const auto&, const auto&, const auto& values) {
    any = any || values.size() > 1;
  });
  return any;
}

// [begin, end) of a chunk's nodes.
std::pair<std::int64_t, std::int64_t> nodes_of(const DatabaseIndex& index,
                                               std::int64_t chunk) {
  const auto k = static_cast<std::size_t>(chunk);
  return {index.node_begin[k], index.node_begin[k + 1]};
}

void set_share_extents(const Viscoelasticity& relaxation, const DatabaseIndex& index,
                       ToolIndex& tool) {
  if (relaxation.g.rows() < 2) {
    return;
  }
  tool.share_min.resize(index.chunks(), relaxation.terms() + 1);
  tool.share_max.resize(index.chunks(), relaxation.terms() + 1);
  for (std::int64_t k = 0; k < index.chunks(); ++k) {
    const auto [begin, end] = nodes_of(index, k);
    const ShareExtent extent = share_extent(rows_of(relaxation, begin, end));
    tool.share_min.row(k) = extent.low;
    tool.share_max.row(k) = extent.high;
  }
}

void set_compliance(const ComplianceTable& table, const DatabaseIndex& index,
                    ToolIndex& tool) {
  tool.compliance = table;
  tool.compliance.value.resize(0, table.value.cols());
  tool.compliance.mode.resize(0, table.mode.cols());
  tool.compliance_sha256.resize(table.empty() ? 0 : index.chunks(), kSha256Bytes);
  for (std::int64_t k = 0; k < tool.compliance_sha256.rows(); ++k) {
    const auto [begin, end] = nodes_of(index, k);
    ComplianceTable part;
    part.value = table.value.middleRows(begin, end - begin);
    if (table.mode.size() > 0) {
      part.mode = table.mode.middleRows(begin, end - begin);
    }
    set_digest(tool.compliance_sha256, k, compliance_digest(part));
  }
}

void set_puncture(const Puncture& puncture, ToolIndex& tool) {
  tool.puncture = puncture;
  if (!puncture.empty()) {
    tool.puncture_sha256.resize(1, kSha256Bytes);
    set_digest(tool.puncture_sha256, 0, puncture_digest(puncture));
  }
}

// By origin and by flag; seven flags where there are no more, as it was before there
// was an eighth.
void count_nodes(const ResponseTable& table, ToolIndex& tool) {
  tool.origin_count.assign(4, 0);
  const bool eighth =
      std::any_of(table.flags.begin(), table.flags.end(), [](auto bits) {
        return (bits & kNearSingular) != 0;
      });
  tool.flag_count.assign(eighth ? kResponseFlags : kResponseFlags - 1, 0);
  for (std::size_t i = 0; i < table.origin.size(); ++i) {
    ++tool.origin_count[table.origin[i] & 3u];
    for (std::size_t bit = 0; bit < tool.flag_count.size(); ++bit) {
      tool.flag_count[bit] += table.flags[i] >> bit & 1;
    }
  }
}

ToolIndex make_tool_index(const ResponseTable& table, const DatabaseIndex& index) {
  ToolIndex tool;
  tool.tool = table.tool;
  tool.relaxation = table.relaxation;
  tool.viscoelasticity = head_of(table.viscoelasticity);
  tool.memory_sites =
      static_cast<std::int64_t>(table.viscoelasticity.sites.node.size());
  tool.yielding_rows = has_rows(table.viscoelasticity.yielding);
  tool.accuracy = table.accuracy;
  count_nodes(table, tool);
  tool.sha256.resize(index.chunks(), kSha256Bytes);
  tool.tilt_sha256.resize(table.tilt.rows() > 0 ? index.chunks() : 0, kSha256Bytes);
  tool.contact_sha256.resize(table.contact.empty() ? 0 : index.chunks(), kSha256Bytes);
  for (std::int64_t k = 0; k < index.chunks(); ++k) {
    const auto [begin, end] = nodes_of(index, k);
    tool.sample_begin.push_back(table.sample_begin[static_cast<std::size_t>(begin)]);
    const TableMaxima of = maxima_of(table, begin, end);
    tool.depth_max_m.push_back(of.depth_m);
    tool.force_max_n.push_back(of.force_n);
    tool.stiffness_max_n_per_m.push_back(of.stiffness_n_per_m);
    tool.error_relative_max.push_back(of.error_relative);
    tool.direction_spread_max_rad.push_back(of.direction_spread_rad);
    std::vector<std::int32_t> nodes(static_cast<std::size_t>(end - begin));
    std::iota(nodes.begin(), nodes.end(), static_cast<std::int32_t>(begin));
    const ResponseTable part = select_nodes(table, nodes);
    set_digest(tool.sha256, k, chunk_digest(part));
    if (table.tilt.rows() > 0) {
      set_digest(tool.tilt_sha256, k, tilt_digest(part));
    }
    if (!table.contact.empty()) {
      set_digest(tool.contact_sha256, k, contact_digest(part.contact));
    }
  }
  tool.sample_begin.push_back(table.sample_begin.back());
  if (has_node_rows(table.viscoelasticity)) {
    tool.memory_sha256.resize(index.chunks(), kSha256Bytes);
    for (std::int64_t k = 0; k < index.chunks(); ++k) {
      const auto [begin, end] = nodes_of(index, k);
      const Viscoelasticity part = rows_of(table.viscoelasticity, begin, end);
      set_digest(tool.memory_sha256, k, memory_digest(part));
    }
  }
  set_share_extents(table.viscoelasticity, index, tool);
  set_compliance(table.compliance, index, tool);
  set_puncture(table.puncture, tool);
  tool.has_pressure = table.contact.has_pressure();
  tool.has_lateral = table.contact.has_lateral();
  return tool;
}

// What content::exchange_index() passes through, as a digest.
class IndexDigest {
 public:
  void group(const std::string&) {}
  [[nodiscard]] bool optional(const std::string&, bool wanted) const { return wanted; }
  template <typename Values>
  void values(const std::string&, const char*, const Values& values) {
    const std::int64_t count = static_cast<std::int64_t>(values.size());
    digest_.update(std::as_bytes(std::span(&count, 1)));
    add_values(digest_, values);
  }
  [[nodiscard]] std::string hex() const { return digest_.hex(); }

 private:
  Sha256 digest_;
};

}  // namespace

std::int64_t DatabaseIndex::chunk_of(std::int64_t node) const noexcept {
  const auto after = std::upper_bound(node_begin.begin(), node_begin.end(), node);
  return after - node_begin.begin() - 1;
}

ShareExtent share_extent(const ToolIndex& tool) {
  if (tool.viscoelasticity.g.rows() > 0) {
    return share_extent(tool.viscoelasticity);
  }
  return {tool.share_min.colwise().minCoeff(), tool.share_max.colwise().maxCoeff()};
}

bool has_node_rows(const Viscoelasticity& relaxation) noexcept {
  return relaxation.g.rows() > 1 || !relaxation.sites.empty() ||
         has_rows(relaxation.yielding);
}

Viscoelasticity rows_of(const Viscoelasticity& relaxation, std::int64_t begin,
                        std::int64_t end) {
  Viscoelasticity part = relaxation;
  const std::int64_t count = end - begin;
  if (relaxation.g.rows() > 1) {
    part.g = relaxation.g.middleRows(begin, count);
  }
  if (!relaxation.sites.empty()) {
    part.sites.site = relaxation.sites.site.middleRows(begin, count);
    part.sites.weight = relaxation.sites.weight.middleRows(begin, count);
  }
  for_each_dataset(part.yielding, [&](const auto&, const auto&, auto& values) {
    if (values.size() > 1) {
      values = {values.begin() + begin, values.begin() + end};
    }
  });
  return part;
}

TableMaxima maxima_of(const ResponseTable& table, std::int64_t begin,
                      std::int64_t end) {
  const std::int64_t first = table.sample_begin[static_cast<std::size_t>(begin)];
  const std::int64_t last = table.sample_begin[static_cast<std::size_t>(end)];
  return {largest_between(table.depth_m, first, last),
          largest_between(table.force_n, first, last),
          largest_between(table.stiffness_max_n_per_m, begin, end),
          largest_between(table.error_relative, begin, end),
          largest_between(table.direction_spread_rad, begin, end)};
}

DatabaseIndex make_index(const ResponseDatabase& ordered, const StorageOrder& order) {
  DatabaseIndex index;
  divide_nodes(ordered, index);
  const std::int64_t chunks = index.chunks();
  index.box_min_m.resize(chunks, 3);
  index.box_max_m.resize(chunks, 3);
  index.sha256.resize(chunks, kSha256Bytes);
  for (std::int64_t k = 0; k < chunks; ++k) {
    const BodyChunk chunk = body_chunk(ordered, order, index, k);
    const Eigen::AlignedBox3d box = box_around(chunk, ordered.body.position_m);
    index.box_min_m.row(k) = box.min().transpose();
    index.box_max_m.row(k) = box.max().transpose();
    set_digest(index.sha256, k, chunk_digest(chunk));
  }
  for (const ResponseTable& table : ordered.tools) {
    index.tools.push_back(make_tool_index(table, index));
  }
  index.measured_samples =
      static_cast<std::int64_t>(ordered.measurement.depth_m.size());
  index.provenance = ordered.provenance;
  index.provenance.scene_toml.clear();
  index.storage = ordered.storage;
  return index;
}

std::string index_digest(const DatabaseIndex& index) {
  IndexDigest digest;
  content::exchange_index(digest, index);
  return digest.hex();
}

}  // namespace palpate
