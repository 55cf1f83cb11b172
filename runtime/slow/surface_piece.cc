#include "runtime/slow/surface_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/response/tool_support.h"
#include "runtime/slow/chunk_choice.h"
#include "runtime/slow/node_memory.h"
#include "runtime/slow/node_puncture.h"

namespace palpate {
bool is_complete(const LoadedChunks& chunks, const LoadedChunk& chunk) {
  return std::ranges::all_of(chunk.needs, [&](std::int64_t other) {
    return chunks.contains(other);
  });
}

SurfacePiece::SurfacePiece(const DatabaseIndex& index, LoadedChunks chunks,
                           double force_scale)
    : index_(index),
      chunks_(std::move(chunks)),
      force_scale_(force_scale),
      complete_(static_cast<std::size_t>(index.chunks()), 0) {
  place_nodes();
  add_triangles();
  search_.emplace(mesh_);
  find_surrounded();
}

void SurfacePiece::place_nodes() {
  part_begin_.push_back(0);
  for (const auto& [k, chunk] : chunks_) {
    complete_[static_cast<std::size_t>(k)] = is_complete(chunks_, *chunk) ? 1 : 0;
    part_.push_back(chunk.get());
    part_begin_.push_back(part_begin_.back() +
                          static_cast<std::int32_t>(chunk->body.position_m.rows()));
  }
  mesh_.position_m.resize(part_begin_.back(), 3);
  for (std::size_t i = 0; i < part_.size(); ++i) {
    const Points& position = part_[i]->body.position_m;
    mesh_.position_m.middleRows(part_begin_[i], position.rows()) = position;
  }
}

std::int32_t SurfacePiece::local(std::int64_t file_node) const noexcept {
  const auto after = std::upper_bound(part_.begin(), part_.end(), file_node,
                                      [](std::int64_t node, const LoadedChunk* chunk) {
                                        return node < chunk->body.node_begin;
                                      });
  const auto part = static_cast<std::size_t>(after - part_.begin()) - 1;
  return part_begin_[part] +
         static_cast<std::int32_t>(file_node - part_[part]->body.node_begin);
}

void SurfacePiece::add_triangles() {
  struct Triangle {
    std::int32_t source;
    Eigen::Vector3i node;
  };
  std::vector<Triangle> all;
  for (const auto& [k, chunk] : chunks_) {
    if (!has_complete(k)) {
      continue;
    }
    const Triangles& triangle = chunk->body.triangle;
    for (Eigen::Index t = 0; t < triangle.rows(); ++t) {
      all.push_back(
          {chunk->body.source_triangle[static_cast<std::size_t>(t)],
           {local(triangle(t, 0)), local(triangle(t, 1)), local(triangle(t, 2))}});
    }
  }
  // The source's order: where two triangles are equally near, a search takes the same
  // one as in the whole body.
  std::sort(all.begin(), all.end(), [](const Triangle& a, const Triangle& b) {
    return a.source < b.source;
  });
  mesh_.triangle.resize(static_cast<Eigen::Index>(all.size()), 3);
  source_triangle_.reserve(all.size());
  for (std::size_t t = 0; t < all.size(); ++t) {
    source_triangle_.push_back(all[t].source);
    mesh_.triangle.row(static_cast<Eigen::Index>(t)) = all[t].node.transpose();
  }
}

// A node that lies in the box of a chunk which is not complete may have triangles
// there.
void SurfacePiece::find_surrounded() {
  surrounded_.assign(static_cast<std::size_t>(mesh_.position_m.rows()), 1);
  const Eigen::AlignedBox3d whole = bounding_box(mesh_);
  for (std::int64_t k = 0; k < index_.chunks(); ++k) {
    const Eigen::AlignedBox3d box = chunk_box(index_, k);
    if (has_complete(k) || !box.intersects(whole)) {
      continue;
    }
    std::size_t part = 0;
    for (const auto& [own, chunk] : chunks_) {
      const Eigen::Index begin = part_begin_[part];
      const Eigen::Index end = part_begin_[++part];
      if (!box.intersects(chunk_box(index_, own))) {
        continue;
      }
      for (Eigen::Index i = begin; i < end; ++i) {
        if (box.contains(Eigen::Vector3d(mesh_.position_m.row(i).transpose()))) {
          surrounded_[static_cast<std::size_t>(i)] = 0;
        }
      }
    }
  }
}

std::int32_t SurfacePiece::row_of(std::int32_t source) const noexcept {
  const auto found =
      std::lower_bound(source_triangle_.begin(), source_triangle_.end(), source);
  return found != source_triangle_.end() && *found == source
             ? static_cast<std::int32_t>(found - source_triangle_.begin())
             : -1;
}

bool SurfacePiece::is_surrounded(std::int32_t row) const noexcept {
  for (Eigen::Index j = 0; j < 3; ++j) {
    if (surrounded_[static_cast<std::size_t>(mesh_.triangle(row, j))] == 0) {
      return false;
    }
  }
  return true;
}

double SurfacePiece::missing_distance_m(const Eigen::Vector3d& p_m) const noexcept {
  double nearest2 = std::numeric_limits<double>::infinity();
  for (std::int64_t k = 0; k < index_.chunks(); ++k) {
    if (!has_complete(k)) {
      nearest2 = std::min(nearest2, chunk_box(index_, k).squaredExteriorDistance(p_m));
    }
  }
  return std::sqrt(nearest2);
}

SurfacePiece::Place SurfacePiece::place(std::int32_t node) const noexcept {
  const auto after = std::upper_bound(part_begin_.begin(), part_begin_.end(), node);
  const auto part = static_cast<std::size_t>(after - part_begin_.begin()) - 1;
  return {part_[part], node - part_begin_[part]};
}

Element SurfacePiece::element(std::int32_t row) const {
  Element message;
  message.triangle = source_triangle_[static_cast<std::size_t>(row)];
  message.touch_height_m = nominal_height_m(part_.front()->table.tool);
  message.memory = tool_memory(part_.front()->table.viscoelasticity);
  for (std::size_t j = 0; j < 3; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const Place at = place(mesh_.triangle(row, column));
    const auto thinned = at.chunk->thinned.find(at.row);
    message.node[j] = thinned != at.chunk->thinned.end()
                          ? thinned->second
                          : node_message(at.chunk->rows(force_scale_), at.row);
    message.node[j].node = at.chunk->body.source_node[static_cast<std::size_t>(at.row)];
    if (message.memory.terms > 0 || message.memory.yields) {
      message.memory.node[j] =
          node_memory(at.chunk->table.viscoelasticity, at.row, message.node[j]);
    }
    message.puncture[j] = node_puncture(at.chunk->table.puncture, at.row, force_scale_);
    const std::int32_t across = search_->neighbours()(row, column);
    message.neighbour[j] =
        across < 0 ? -1 : source_triangle_[static_cast<std::size_t>(across)];
  }
  return message;
}

ElementRows SurfacePiece::compliance(std::int32_t row) const {
  ElementRows rows;
  for (std::size_t j = 0; j < 3; ++j) {
    const Place at = place(mesh_.triangle(row, static_cast<Eigen::Index>(j)));
    const ComplianceTable& table = at.chunk->table.compliance;
    if (!table.empty()) {
      rows[j] = contact_row(table, at.row, force_scale_);
    }
  }
  return rows;
}

}  // namespace palpate
