// How a node is pressed, and what is tried next where that did not suffice. This is the
// whole policy of fall-backs of presses, known without a mesh. (The mesher decides how
// a mesh is made where the first try fails. The contact decides how a press takes a
// step.)
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpate {

/// At which samples of a path a nonlinear press is solved; between them the linear one
/// is corrected by what those around differ by.
enum class SolvedDepths {
  kFew,      ///< four, and on a near-singular path those on the way to the hard ones
  kBetween,  ///< one before each of those, and the last: tells what correcting makes
  kEvery,
};

struct Recipe {
  double times_finer = 1.0;  ///< [-] than the mesh that the budget asks for
  SolvedDepths depths = SolvedDepths::kFew;
  bool stiff = false;  ///< contact, from the first step on
  /// [-] As NonlinearOptions', which holds where this is 0.
  double near_gradient = 0.0;
};

/// Why a recipe was tried.
enum class Reason {
  kFirst,
  kNoMesh,         ///< the one asked for cannot be made: coarser
  kTouchesLate,    ///< gaps are averaged over hats of contact nodes: smaller hats
  kFailed,         ///< at a sharp edge large elements are distorted less: larger ones
  kFarExcess,      ///< laws matter beyond the near field: wider
  kBetweenDepths,  ///< a few depths do not tell those between them: every one
  kOutsideBudget,  ///< a linear press by its own estimate: finer mesh
};

/// What a press came to.
struct Outcome {
  std::size_t samples = 0;  ///< of the path, first touch among them
  bool failed = false;      ///< the path ends early, or is missing
  bool late = false;        ///< touches_late()
  bool near_singular = false;
  double between_error = 0.0;        ///< [-] Indentation::path_error
  double far_excess_relative = 0.0;  ///< [-] as NonlinearIndentation's
  double near_gradient = 0.0;        ///< [-] as NonlinearIndentation's
  double error_relative = 0.0;       ///< [-] estimated; only kOutsideBudget asks
};

struct Attempt {
  Recipe recipe = {};
  Reason reason = Reason::kFirst;
  Outcome outcome = {};
  bool taken = true;  ///< rather than what was there before
};

/// What attempts are judged by.
struct PressPolicy {
  Recipe first = {};
  bool nonlinear = false;
  double far_excess_max = 0.0;   ///< [-] as NonlinearOptions'
  double depth_error_max = 0.0;  ///< [-] as NonlinearOptions'
};

/// Whether it is tried on the mesh of the attempt before; else on one that is made for
/// the node alone.
[[nodiscard]] bool keeps_mesh(Reason reason);

/// What is tried after these, recipe and reason; none where the last taken does, or
/// nothing else is known. @param tried at least one, in order.
[[nodiscard]] std::optional<Attempt> next(std::span<const Attempt> tried,
                                          const PressPolicy& policy);

/// Whether an attempt for this reason is rather taken than what was there before.
[[nodiscard]] bool is_better(const Outcome& before, Reason reason,
                             const Outcome& again);

/// Place of the last that was taken. @param tried at least one.
[[nodiscard]] std::size_t last_taken(std::span<const Attempt> tried);

/// Whether what was taken is from a mesh that was made for the node alone.
[[nodiscard]] bool is_alone(std::span<const Attempt> tried);

/// What was tried after the first, with reasons, one line; empty: the first did.
/// "touches late: mesh 2 times finer; failed: mesh 2 times coarser, not taken"
[[nodiscard]] std::string history_text(std::span<const Attempt> tried);

}  // namespace palpate
