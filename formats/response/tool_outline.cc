#include "formats/response/tool_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/base/reproducible.h"

namespace palpate {
namespace {

using Point = Eigen::Vector2d;

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kQuarter = 0.5 * std::numbers::pi;

class Outline {
 public:
  // Angles from straight down, counter-clockwise.
  void arc(const Point& centre, double radius_m, double from_rad, double to_rad) {
    if (!(radius_m > 0.0)) {
      return;
    }
    const int steps = static_cast<int>(std::ceil((to_rad - from_rad) / kArcStepRad));
    OutlinePiece piece;
    for (int i = 0; i <= steps; ++i) {
      const double angle = from_rad + (to_rad - from_rad) * i / steps;
      // Exactly on the axis at its ends.
      const double s =
          angle == 0.0 || angle == kHalfTurn ? 0.0 : reproducible::sin(angle);
      piece.push_back(centre + radius_m * Point(s, -reproducible::cos(angle)));
    }
    pieces.push_back(piece);
  }

  void line(const Point& from, const Point& to) {
    if (from != to) {
      pieces.push_back({from, to});
    }
  }

  std::vector<OutlinePiece> pieces;
};

// A cylinder under a ball of the edge's radius.
void punch(const ToolShape& tool, double end_m, Outline& outline) {
  const double R = tool.radius_m, edge = tool.edge_radius_m;
  outline.line({0.0, 0.0}, {R - edge, 0.0});
  outline.arc({R - edge, edge}, edge, 0.0, kQuarter);
  outline.line({R, edge}, {R, std::max(end_m, edge)});
  outline.line({R, std::max(end_m, edge)}, {0.0, std::max(end_m, edge)});
}

// A sharp cone, its apex at the centre of the tip's ball, under that ball.
void cone(const ToolShape& tool, double end_m, Outline& outline) {
  const double tip = tool.tip_radius_m, alpha = tool.half_angle_rad;
  const bool endless = !(tool.length_m > 0.0);
  const double height_m =
      endless ? std::min(end_m, 0.5 * end_m / reproducible::tan(alpha)) : tool.length_m;
  const Point apex(0.0, tip);
  const Point rim = apex + height_m * Point(reproducible::tan(alpha), 1.0);
  const Point out = tip * Point(reproducible::cos(alpha), -reproducible::sin(alpha));
  outline.arc(apex, tip, 0.0, kQuarter - alpha);
  outline.line(apex + out, rim + out);
  if (endless) {
    outline.line(rim + out, {0.0, rim.y() + out.y()});
    return;
  }
  outline.arc(rim, tip, kQuarter - alpha, kHalfTurn);
  outline.line(rim + Point(0.0, tip), {0.0, rim.y() + tip});
}

}  // namespace

std::vector<OutlinePiece> tool_outline_m(const ToolShape& tool, double end_m) {
  Outline outline;
  if (tool.kind == "sphere") {
    outline.arc({0.0, 0.0}, tool.radius_m, 0.0, kHalfTurn);
  } else if (tool.kind == "capsule") {
    const Point upper(0.0, tool.length_m);
    outline.arc({0.0, 0.0}, tool.radius_m, 0.0, kQuarter);
    outline.line({tool.radius_m, 0.0}, upper + Point(tool.radius_m, 0.0));
    outline.arc(upper, tool.radius_m, kQuarter, kHalfTurn);
  } else if (tool.kind == "flat-punch") {
    punch(tool, end_m, outline);
  } else if (tool.kind == "cone") {
    cone(tool, end_m, outline);
  }
  return outline.pieces;
}

}  // namespace palpate
