// A plate whose contacts know how stiff they are sideways, for tests that look at
// friction. The spring is the same at every place and depth.
#pragma once

#include "formats/database/response_database.h"
#include "tests/support/sample_bodies.h"

namespace palpate {

inline constexpr double kRubBallM = 0.005;       // radius
inline constexpr double kRubNPerM = 200.0;       // every node's response
inline constexpr double kRubFriction = 0.3;      // mu
inline constexpr double kRubDepthM = 0.01;       // the deepest
inline constexpr double kRubShare = 0.75;        // S, alike in all directions
inline constexpr double kRubPreslidingM = 1e-3;  // where nobody knows S

/// K = S N / d = kRubShare kRubNPerM. @param by_body without it K = mu N / presliding.
[[nodiscard]] inline ResponseDatabase rubbing_plate(bool by_body = true) {
  ResponseDatabase database = sample_database(
      plate(0.1, 20),
      ball(kRubBallM, kRubFriction,
           by_body ? kRubFriction * kRubDepthM / kRubShare : kRubPreslidingM),
      [](Eigen::Index, double d) {
        return kRubNPerM * d;
      },
      kRubDepthM);
  if (by_body) {
    ResponseTable& table = database.tools[0];
    const auto nodes = static_cast<Eigen::Index>(table.nodes());
    ContactTable& contact = table.contact;
    contact.lateral.resize(nodes, 3 * static_cast<Eigen::Index>(kContactDepths));
    for (Eigen::Index i = 0; i < contact.lateral.cols(); ++i) {
      contact.lateral.col(i).setConstant(i % 3 == 1 ? 0.0F
                                                    : static_cast<float>(kRubShare));
    }
    contact.lateral_error.setConstant(nodes, 1, 0.01F);
  }
  return database;
}

}  // namespace palpate
