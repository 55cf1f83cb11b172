#include "runtime/view/view_seat.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "formats/response/turn_from_z.h"
#include "runtime/hand/press_site.h"
#include "runtime/view/view_contact.h"

namespace palpate {
namespace {

// How far the tool reaches from its reference point against `outward` [m].
double reach_m(const ToolShape& tool, const Eigen::Quaterniond& turn,
               const Eigen::Vector3d& outward) {
  if (tool.contact.empty()) {
    return drawn_height_m(tool, outward);
  }
  double most = 0.0;
  for (std::size_t i = 0; i < tool.contact.radius_m.size(); ++i) {
    const Eigen::Vector3d centre =
        tool.contact.point_m.row(static_cast<Eigen::Index>(i)).transpose();
    most = std::max(most, tool.contact.radius_m[i] - outward.dot(turn * centre));
  }
  return most;
}

// One to press; without responses yet the highest one.
std::int32_t first_node(const ResponseDatabase& database, const ResponseTable& table) {
  Eigen::Index highest = 0;
  database.body.position_m.col(2).maxCoeff(&highest);
  return table.depth_m.empty() ? static_cast<std::int32_t>(highest)
                               : node_to_press(database, table, std::nullopt);
}

// How far from each other two hands begin.
double apart_m(const std::vector<const ResponseTable*>& tables) {
  double sum = 0.0;
  for (const ResponseTable* table : tables) {
    for (const double side : {-1.0, 1.0}) {
      sum +=
          0.75 * reach_m(table->tool, Eigen::Quaterniond::Identity(), {side, 0.0, 0.0});
    }
  }
  return sum;
}

// The node nearest to where a second hand is apart_m beside the first, on the side
// where the body has one.
std::int32_t node_beside(const ResponseDatabase& database, const ResponseTable& table,
                         std::int32_t first, double apart_m) {
  const Eigen::Vector3d at_m = database.body.position_m.row(first).transpose();
  const Eigen::Quaterniond frame = turn_from_z(database.normal.row(first).transpose());
  std::int32_t best = -1;
  double least_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& side :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0),
        Eigen::Vector3d(0, -1, 0)}) {
    const Eigen::Vector3d wanted_m = at_m + apart_m * (frame * side);
    const std::int32_t node = node_to_press(database, table, wanted_m);
    const double off_m =
        (database.body.position_m.row(node).transpose() - wanted_m).norm();
    if (off_m < least_m) {
      best = node;
      least_m = off_m;
    }
  }
  return best;
}

}  // namespace

double clearance_m(const ResponseTable& table) {
  return std::max(0.005, table.depth_max_m());
}

Eigen::Vector3d lifted_m(const ResponseTable& table, const Eigen::Quaterniond& turn,
                         const Eigen::Vector3d& point_m,
                         const Eigen::Vector3d& normal) {
  return point_m + (reach_m(table.tool, turn, normal) + clearance_m(table)) * normal;
}

std::vector<std::int32_t> nodes_to_begin_over(
    const ResponseDatabase& database, const std::vector<const ResponseTable*>& tables) {
  std::vector<std::int32_t> nodes{first_node(database, *tables.front())};
  for (std::size_t i = 1; i < tables.size(); ++i) {
    nodes.push_back(node_beside(database, *tables[i], nodes.front(), apart_m(tables)));
  }
  return nodes;
}

}  // namespace palpate
