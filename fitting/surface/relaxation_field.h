// Relaxation that differs over a body, from probes that were held. Fields are Gaussian,
// of the shares of force that are gone at a few times. Fields are used where they
// predict unseen places better than one median for all nodes does.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "fitting/surface/field_parameters.h"
#include "fitting/surface/probe.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {

/// Places with a hold that a field needs at least.
constexpr std::size_t kHeldPlacesMin = 20;
/// The field is taken where the squares of what it misses, weighed, are smaller than
/// those of one value for all nodes. The squares must be smaller by more than so many
/// standard errors (Breiman et al. 1984, 3.4.3: the simpler of two within one). The
/// standard errors follow from the scatter of the sums over patches of neighbours.
constexpr double kFieldGainMin = 1.0;

struct RelaxationFieldReport {
  bool taken = false;            ///< else the median
  std::string reason;            ///< one line with its numbers; empty: nothing was held
  std::size_t places = 0;        ///< with a hold
  std::size_t left_out = 0;      ///< of them, which the others contradict
  std::vector<double> time_s;    ///< (K) of the shares
  std::size_t patches = 0;       ///< of neighbouring places
  double field_rms = 0.0;        ///< [-] off at places left out in turn, by the field
  double common_rms = 0.0;       ///< [-] by median or mean of all, whichever is better
  double coverage = 0.0;         ///< [-] of these shares by 95 % intervals of the field
  double gain_over_error = 0.0;  ///< [-] over its standard error; kFieldGainMin
  double common_times_error = 0.0;          ///< [-] of held_shares.h
  std::vector<FieldParameters> parameters;  ///< (K) most probable, by share
  double error_median = 0.0;                ///< [-] of the nodes', where taken
};

struct RelaxationField {
  Viscoelasticity relaxation;  ///< with n rows where the field is taken
  RelaxationFieldReport report;
};

/// The times are those that miss least of all probes. Presses at one place are joined,
/// and places that the others contradict left out (probe_repeats.h, probe_screen.h).
/// Length, sd and nugget are found for each share, and averaged over as for forces. The
/// nugget is in the errors where repeats tell it from repeatability. g of a node:
/// nearest_terms(). error_relative of a node: standard deviation of the share of force
/// that is gone. The variance is the largest one at `time_s`, plus the square of what
/// the common times miss. 95 % of nodes should have true shares within 1.96 times
/// error_relative.
/// @param held probes whose press and hold were fitted together. @param common what
/// they say in common: returned as it is where no field is taken. Empty: nothing.
[[nodiscard]] RelaxationField relaxation_field(
    const SurfaceMesh& body, const std::vector<const SurfaceProbe*>& held,
    const Viscoelasticity& common);

/// One line for people; empty where nothing was held.
[[nodiscard]] std::string describe(const RelaxationFieldReport& report);

}  // namespace palpate
