// `runtime_bench signs`: hunts for places of a stored body where the smooth field has
// an energy below zero, or pulls.
//
// Places are drawn evenly over the elements of which a node responds, and over the
// depths. Half of the places are within a hundredth of an element's edge or corner. A
// pull is a force against the normal between the nodes' there, of more than a millionth
// of the node's largest.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/database/response_database.h"

namespace palpate {

struct SignsBenchOptions {
  std::int64_t places = 1'000'000;
  unsigned seed = 1;
  /// [-] >= 0: every node's forces are multiplied by e^(+-discord). A node's direction
  /// leans by up to 45 degrees, and one node of ten does not respond. 0: the body as it
  /// is.
  double discord = 0.0;
  /// [1, inf) so many bodies that have nothing but the surface in common, one after the
  /// other. With more than one, every node has a curve, a first touch and a tilt by
  /// depth of its own. All three are at random within the rules of databases; places
  /// are shared out.
  std::int64_t databases = 1;
};

struct SignsBenchReport {
  std::int64_t places = 0;    ///< in contact, where the field is sound
  std::int64_t unsound = 0;   ///< where the nearest point of the facets is taken
  std::int64_t negative = 0;  ///< places with U < 0
  std::int64_t pulls = 0;
  double lowest_j = 0.0;      ///< [J] of U
  double worst_pull_n = 0.0;  ///< [N]
};

/// @param table of the database; both are changed where there is discord.
[[nodiscard]] SignsBenchReport run_signs_bench(ResponseDatabase database,
                                               const std::string& tool,
                                               const SignsBenchOptions& options);

[[nodiscard]] std::string table_text(const SignsBenchReport& report);

/// Gives every node of a table its own factor of forces and its own lean, and takes the
/// response from a share of them. @param lean_rad at most.
/// @param own_curves forces that rise by chance, touches and tilts too. Where curves
/// fall to nothing no force keeps the tool off while energies of neighbours differ.
/// What is left of the force may point a little inwards.
void make_discordant(ResponseDatabase& database, ResponseTable& table,
                     double log_factor, double lean_rad, double silent_share,
                     std::uint64_t seed, bool own_curves = false);

}  // namespace palpate
