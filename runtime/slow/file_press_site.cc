#include "runtime/slow/file_press_site.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/slow/chunk_choice.h"

namespace palpate {
namespace {

// Of two places, the one with the smaller distance is pressed.
double distance(const Eigen::Vector3d& p, const std::optional<Eigen::Vector3d>& at) {
  return at ? (p - *at).norm() : -p.z();
}

double distance(const Eigen::AlignedBox3d& box,
                const std::optional<Eigen::Vector3d>& at) {
  return at ? box.exteriorDistance(*at) : -box.max().z();
}

// A chunk as a body of its own, without the triangles that reach out of it.
ResponseDatabase as_body(BodyChunk chunk, ResponseTable table) {
  ResponseDatabase body;
  const auto begin = static_cast<std::int32_t>(chunk.node_begin);
  const auto end = begin + static_cast<std::int32_t>(chunk.position_m.rows());
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < chunk.triangle.rows(); ++t) {
    if (chunk.triangle.row(t).maxCoeff() < end) {
      chunk.triangle.row(kept++) = chunk.triangle.row(t).array() - begin;
    }
  }
  body.body.triangle = chunk.triangle.topRows(kept);
  body.body.position_m = std::move(chunk.position_m);
  body.normal = std::move(chunk.normal);
  body.tools.push_back(std::move(table));
  return body;
}

// Where it is stiffest, and whose chunk and row that is; -1: no node responds.
struct StiffestRow {
  RenderedStiffness stiffness;
  std::int64_t chunk = -1;
  std::int64_t row = -1;
};

StiffestRow stiffest_row(const ChunkReader& reader, std::size_t tool,
                         double force_max_n) {
  const ToolIndex& entry = reader.index().tools[tool];
  const auto& stiffness = entry.stiffness_max_n_per_m;
  const auto stiffest = std::max_element(stiffness.begin(), stiffness.end());
  StiffestRow most;
  RenderedStiffness& largest = most.stiffness;
  if (stiffest == stiffness.end() || *stiffest <= 0.0) {
    return most;
  }
  // Where nodes yield differently, another chunk may be the stiffest when it is let go.
  const std::int64_t first = entry.yielding_rows ? 0 : stiffest - stiffness.begin();
  const std::int64_t last = entry.yielding_rows ? reader.index().chunks() : first + 1;
  for (std::int64_t chunk = first; chunk < last; ++chunk) {
    RenderedStiffness of =
        rendered_stiffness(reader.responses(tool, chunk), force_max_n);
    if (of.normal_n_per_m > largest.normal_n_per_m) {
      most.chunk = chunk;
      most.row = of.node;
      of.node = reader.body(chunk).source_node[static_cast<std::size_t>(of.node)];
      of.friction_n_per_m = std::max(of.friction_n_per_m, largest.friction_n_per_m);
      largest = of;
    }
  }
  const double force_n =
      std::min(force_max_n,
               *std::max_element(entry.force_max_n.begin(), entry.force_max_n.end()));
  if (entry.tool.presliding_m > 0.0) {
    largest.friction_n_per_m =
        std::max(largest.friction_n_per_m,
                 entry.tool.friction * force_n / entry.tool.presliding_m);
  }
  return most;
}

}  // namespace

StreamedPlace streamed_place(const ChunkReader& reader, std::size_t tool,
                             const std::optional<Eigen::Vector3d>& at_m) {
  const DatabaseIndex& index = reader.index();
  // Chunks by the distance of their boxes, a lower bound of that of their nodes.
  std::vector<std::pair<double, std::int64_t>> order;
  const std::vector<std::int64_t>& samples = index.tools[tool].sample_begin;
  for (std::int64_t k = 0; k < index.chunks(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (samples[i] < samples[i + 1]) {
      order.emplace_back(distance(chunk_box(index, k), at_m), k);
    }
  }
  std::sort(order.begin(), order.end());
  StreamedPlace best;
  double best_distance = std::numeric_limits<double>::infinity();
  for (const auto& [box_distance, k] : order) {
    // No box from here on can hold a nearer node.
    if (box_distance >= best_distance) {
      break;
    }
    BodyChunk body = reader.body(k);
    ResponseTable table = reader.responses(tool, k);
    std::int32_t row = -1;
    for (std::int32_t i = 0; i < table.nodes(); ++i) {
      const double here = distance(body.position_m.row(i).transpose(), at_m);
      if (!table.curve(i).depth_m.empty() && here < best_distance) {
        best_distance = here;
        row = i;
      }
    }
    if (row >= 0) {
      best.source_node = body.source_node[static_cast<std::size_t>(row)];
      best.row = row;
      best.around = as_body(std::move(body), std::move(table));
    }
  }
  if (best.row < 0) {
    throw InputError(fmt::format("tool \"{}\": no node of the body has a response",
                                 index.tools[tool].tool.name));
  }
  return best;
}

RenderedStiffness streamed_stiffness(const ChunkReader& reader, std::size_t tool,
                                     double force_max_n) {
  return stiffest_row(reader, tool, force_max_n).stiffness;
}

std::vector<StiffestNode> streamed_stiffest(const ChunkReader& reader, std::size_t tool,
                                            double force_max_n) {
  const DatabaseIndex& index = reader.index();
  return stiffest_by_contact(
      index.tools[tool].tool, force_max_n,
      [&](const std::string& table, double each_n) {
        const StiffestRow most = stiffest_row(reader, find_tool(index, table), each_n);
        StiffestNode node{most.stiffness, {}};
        if (most.chunk >= 0 && !index.tools[tool].compliance.empty()) {
          node.row = contact_row(reader.compliance(tool, most.chunk), most.row, 1.0);
        }
        return node;
      });
}

}  // namespace palpate
