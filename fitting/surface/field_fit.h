// From measured curves at scattered points of a body to a response at every node.
//
// Each curve's fitted law gives log forces at depths common to all. Each depth's log
// forces are a surface field (gaussian_field.h) with one set of parameters, after bad
// probes are screened. Exponentials of the fields are the nodes' curves.
#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fitting/surface/field_patches.h"
#include "fitting/surface/probe.h"
#include "fitting/surface/probe_screen.h"
#include "fitting/surface/relaxation_field.h"
#include "formats/database/response_database.h"

namespace palpate {

/// A probe that is not behind the field.
struct LeftOutProbe {
  std::string name;
  std::string reason;  ///< one line
};

/// What leaving each place out says of one depth, with the parameters of all places and
/// after screening. The score is of the interpolation, not of the whole fit
/// (PatchScore).
struct DepthScore {
  double depth_m = 0.0;
  std::size_t probes = 0;    ///< places
  double rms = 0.0;          ///< [-] of log force, left out against predicted
  double coverage = 0.0;     ///< [-] share within 95 % intervals
  double nearest_rms = 0.0;  ///< [-] of the nearest other probe instead
};

struct SurfaceFitReport {
  FieldParametersReport parameters;
  std::vector<DepthScore> depth;  ///< of all but the first two
  std::vector<LeftOutProbe> left_out;
  PatchScore patches;    ///< at a quarter and at all of the depth; none without options
  std::size_t runs = 0;  ///< all: behind the field, or in left_out
  std::size_t probes = 0;  ///< behind the field
  std::size_t places = 0;  ///< where they are
  /// [-] of log force at the full depth, between presses at one place. NaN where
  /// repeats do not state the repeatability: then the nugget may be repeatability, or
  /// roughness, or both
  double repeatability = std::numeric_limits<double>::quiet_NaN();
  std::map<std::string, std::size_t> laws;  ///< of those, by name
  std::size_t far_nodes = 0;                ///< beyond kFarLengths of every probe
  std::size_t straightened = 0;   ///< nodes whose force would have fallen with depth
  double attachment_max_m = 0.0;  ///< [m] farthest probe from the surface
  double error_median = 0.0;      ///< [-] of the nodes' relative errors
  ResponseRelaxation relaxation;  ///< what holds showed; empty without
  Viscoelasticity
      viscoelasticity;  ///< the database's, rendered; else empty and the ...
                        ///< ... database has `relaxation`
  RelaxationFieldReport relaxation_field;  ///< whether the nodes have g of their own
};

struct SurfaceFit {
  ResponseDatabase database;
  SurfaceFitReport report;
};

constexpr int kCommonDepths = 12;
constexpr double kFarLengths = 2.0;  ///< beyond, nodes are flagged as extrapolated
constexpr std::size_t kProbesMin = 8;

struct SurfaceFitOptions {
  bool patches = false;  ///< predict left-out patches: up to ten more fits
};

/// Common depths are D (k / 12)^2, k = 1 to 12, D the depth that nine of ten probes
/// reach. Probes that do not reach a depth say nothing there. Log forces and their
/// errors are those of each probe's law (probe.h). Forces that would fall with depth
/// are held. Presses at one place are joined (probe_repeats.h). Where presses state the
/// repeatability, the nugget is roughness of the surface and in the nodes' errors,
/// since a press there will meet it. Where presses do not, the nugget is in none of the
/// errors. Fields are averaged over the parameters that the data allow. Origins are
/// measured at nodes that have a probe, interpolated elsewhere; error_relative is the
/// largest standard deviation of log force over the deeper half. Directions deviate
/// from the normals as the probes' do, each within half a length. Relaxation is kept by
/// probe, and for the nodes by keep_relaxation().
/// @param body closed or open, every vertex in a triangle, outside out.
/// @throws InputError for fewer than kProbesMin usable probes or places, and a probe
/// farther from the surface than a tenth of the body's diagonal. NumericalError as
/// FieldModel.
[[nodiscard]] SurfaceFit fit_surface(const SurfaceMesh& body, const ToolShape& tool,
                                     std::span<const SurfaceProbe> probes,
                                     const SurfaceFitOptions& options = {});

/// A human's report: parameters, left-out figures, probes left out.
[[nodiscard]] std::string describe(const SurfaceFitReport& report);

}  // namespace palpate
