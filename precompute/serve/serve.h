// Computes a scene's responses in the order in which hands need them, and hands them
// out while it does (formats/service/SERVICE.md).
#pragma once

#include <filesystem>
#include <optional>

#include "formats/scene/scene.h"
#include "formats/stored/storage_options.h"
#include "precompute/process/progress.h"
#include "precompute/surface/repair.h"

namespace palpate {

struct ServeOptions {
  std::filesystem::path output;  ///< the database; "OUTPUT.partial" is beside it
  std::filesystem::path socket;  ///< where others join
  RepairMode repair = RepairMode::kOff;
  std::optional<Precision> precision = {};
  int workers = 0;  ///< [0, inf) threads; 0: one for each core
  /// Units of another scene in OUTPUT.partial, and a database of another scene, are
  /// dropped instead of refused.
  bool anew = false;
  double patience_s = 600.0;  ///< [s] as BuildOptions
};

/// Returns when the database is whole and those who joined have been notified. The
/// database has the bytes that build() gives. What is done is kept in OUTPUT.partial; a
/// kill loses what is under way. Several services may share one output, each with a
/// socket of its own. Each unit is computed by one of them.
/// @throws InputError if somebody listens at the socket, or what is there belongs to
/// another scene. ResourceError if a build, not a service, works on the output; and as
/// build(). Those who have joined receive the reason.
void serve(const Scene& scene, const ServeOptions& options, Progress& progress);

}  // namespace palpate
