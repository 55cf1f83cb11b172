// From a scene to its response database, by units that survive kills and can be shared
// out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/database/work_unit.h"
#include "formats/scene/scene.h"
#include "formats/stored/storage_options.h"
#include "precompute/body/scene_body.h"
#include "precompute/build/folder_lock.h"
#include "precompute/press/scene_solver.h"
#include "precompute/process/progress.h"

namespace palpate {

struct BuildOptions {
  std::filesystem::path output;
  int shard = 0;        ///< [0, shards)
  int shards = 1;       ///< units are dealt out in turn
  bool resume = false;  ///< go on from units that an earlier run left beside `output`
  bool solve_all = false;                   ///< every node, none interpolated
  RepairMode repair = RepairMode::kOff;     ///< of the body's mesh file
  std::optional<Precision> precision = {};  ///< none: the cheapest (choose_precision)
  int workers = 0;  ///< [0, inf) threads; 0: one for each core. The bytes are the same
  /// [s] Longest wait for memory, processes and room on the disk that are wanting. With
  /// `resume`, also for the end of another build of the output.
  double patience_s = 600.0;
  FolderUse folder_use = FolderUse::kAlone;  ///< of what is kept beside `output`
};

struct BuildReport {
  std::int64_t nodes = 0;     ///< surface vertices of the body
  std::int64_t tets = 0;      ///< of the shared mesh; 0 where there is none
  std::int64_t unknowns = 0;  ///< degrees of freedom of the shared mesh
  std::int64_t units = 0;
  std::int64_t resumed = 0;       ///< units that an earlier run had solved
  Assembly assembly;              ///< of all units; empty for one shard of several
  double node_spacing_m = 0.0;    ///< [m] of the contact nodes, shared mesh
  double min_dihedral_deg = 0.0;  ///< [deg] smallest angle between faces of a tet
  double seconds = 0.0;
  std::int64_t peak_memory_bytes = 0;
  std::vector<std::string> notes;
};

/// Solves the units of this shard, each kept as soon as it is done, and writes the
/// output. The output is the database, or for one shard of several a file for
/// `palpate-db merge`. Every number is checked where a stage hands it on. A node
/// without an answer is stored as failed, with its reason, and the others are written.
/// With `resume`, an output that another run has finished meanwhile is taken as it is.
/// An output of the same plan that holds more responses stays.
/// @throws ResourceError where memory, processes, disk or another build's end were
/// waited for in vain. Nothing is written then, and what was solved is kept.
/// @throws InputError if units of an earlier run are there and `resume` is not given.
/// Also if these units belong to another scene, body or version. Also as read_body()
/// and require_meshable(), before anything is computed.
/// @throws NumericalError if no node at all has a response, or the output is better.
BuildReport build(const Scene& scene, const BuildOptions& options, Progress& progress);

}  // namespace palpate
