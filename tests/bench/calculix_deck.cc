// Writes a CalculiX deck: a cylinder of neo-Hookean gel, held at its bottom, a rigid
// sphere pressed into the middle of its top. And the same surface as OBJ, for us.
//
// calculix_deck TETS DECK.inp SURFACE.obj
//
// Our mesh is theirs: tetrahedralise() and make_quadratic() of the surface; C3D10 has
// our node order. The sphere is made of straight tets from its centre to the triangles
// of a fine icosphere's lower part, every node of it prescribed: CalculiX has no
// analytical rigid surfaces. Deck in mm, N, MPa: CalculiX's contact tolerances suit
// them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/os.h>

#include "formats/mesh/obj_writer.h"
#include "precompute/fem/quadratic_mesh.h"
#include "precompute/material/material.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/tets/tetrahedralise.h"
#include "tests/support/study_bodies.h"

namespace palpate {
namespace {

constexpr double kRadius = 0.020;  // [m] of the cylinder
constexpr double kHeight = 0.020;  // [m]
constexpr double kBall = 0.005;    // [m] radius
constexpr double kDepth = 0.005;   // [m]
constexpr double kYoung = 5000.0;  // [Pa]
constexpr double kPoisson = 0.45;
constexpr double kSlave = 0.010;  // [m] the top is in contact search up to this radius
constexpr double kMm = 1e3;       // [mm/m]
constexpr double kMpa = 1e-6;     // [MPa/Pa]
// [Pa/m] Pressure over overlap: the largest pressure, about E, overlaps by 20 um.
constexpr double kPenalty = kYoung / 20e-6;
constexpr int kBallLevels = 4;  // triangles of 0.35 mm

struct Gel {
  SurfaceMesh surface;
  QuadraticMesh mesh;
};

Gel make_gel(int rings) {
  Gel gel;
  gel.surface = cylinder(kRadius, kHeight, rings);
  TetOptions options;
  options.edge_max_m = kRadius / rings;
  gel.mesh = make_quadratic(tetrahedralise(gel.surface, options), gel.surface.triangle);
  return gel;
}

// The fineness whose number of tets comes closest to the wanted.
Gel gel_of(Eigen::Index wanted) {
  const auto miss = [wanted](const Gel& gel) {
    return std::abs(gel.mesh.tet.rows() - wanted);
  };
  Gel best = make_gel(2);
  for (int rings = 3; rings <= 40; ++rings) {
    Gel next = make_gel(rings);
    const bool past = next.mesh.tet.rows() > wanted;
    if (miss(next) < miss(best)) {
      best = std::move(next);
    }
    if (past) {
      break;
    }
  }
  return best;
}

void write_gel(fmt::ostream& deck, const QuadraticMesh& mesh) {
  deck.print("*NODE, NSET=GEL\n");
  for (Eigen::Index i = 0; i < mesh.position_m.rows(); ++i) {
    const auto p = mesh.position_m.row(i) * kMm;
    deck.print("{}, {:.12g}, {:.12g}, {:.12g}\n", i + 1, p.x(), p.y(), p.z());
  }
  deck.print("*ELEMENT, TYPE=C3D10, ELSET=GEL\n");
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    deck.print("{}", t + 1);
    for (int k = 0; k < 10; ++k) {
      deck.print(", {}", mesh.tet(t, k) + 1);
    }
    deck.print("\n");
  }
  const NeoHookean law = neo_hookean(kYoung, kPoisson);
  deck.print(
      "*MATERIAL, NAME=GEL\n*HYPERELASTIC, NEO HOOKE\n{:.12g}, {:.12g}\n"
      "*SOLID SECTION, ELSET=GEL, MATERIAL=GEL\n",
      0.5 * law.shear_modulus_pa * kMpa, 2.0 / (law.bulk_modulus_pa * kMpa));
  deck.print("*NSET, NSET=BOTTOM\n");
  for (Eigen::Index i = 0; i < mesh.position_m.rows(); ++i) {
    if (mesh.position_m(i, 2) < 1e-9) {
      deck.print("{},\n", i + 1);
    }
  }
}

// Faces S1 to S4 of a CalculiX tet, opposite to its corners 4, 3, 1, 2.
void write_top(fmt::ostream& deck, const QuadraticMesh& mesh) {
  constexpr std::array<std::array<int, 3>, 4> kFaces{
      {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
  deck.print("*SURFACE, NAME=TOP, TYPE=ELEMENT\n");
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    for (std::size_t face = 0; face < 4; ++face) {
      bool on_top = true;
      double nearest_m = kRadius;
      for (const int corner : kFaces[face]) {
        const auto p = mesh.position_m.row(mesh.tet(t, corner));
        on_top = on_top && p.z() > kHeight - 1e-9;
        nearest_m = std::min(nearest_m, p.head<2>().norm());
      }
      if (on_top && nearest_m < kSlave) {
        deck.print("{}, S{}\n", t + 1, face + 1);
      }
    }
  }
}

// A sphere's lower part about the origin, all vertices in use. They are scaled so that
// the icosphere has the sphere's area: flat triangles would lie inside it otherwise.
SurfaceMesh lower_ball() {
  const SurfaceMesh whole = icosphere(1.0, kBallLevels);
  double area = 0.0;
  std::vector<std::int32_t> number(static_cast<std::size_t>(whole.position_m.rows()),
                                   -1);
  SurfaceMesh ball{Points(whole.position_m.rows(), 3),
                   Triangles(whole.triangle.rows(), 3)};
  std::int32_t vertices = 0;
  Eigen::Index triangles = 0;
  for (Eigen::Index t = 0; t < whole.triangle.rows(); ++t) {
    Eigen::Matrix3d corner;
    for (int k = 0; k < 3; ++k) {
      corner.col(k) = whole.position_m.row(whole.triangle(t, k));
    }
    area += 0.5 *
            (corner.col(1) - corner.col(0)).cross(corner.col(2) - corner.col(0)).norm();
    if (corner.row(2).sum() > 0.5) {  // higher than 10 degrees above the equator
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      std::int32_t& index = number[static_cast<std::size_t>(whole.triangle(t, k))];
      if (index < 0) {
        index = vertices++;
        ball.position_m.row(index) = corner.col(k);
      }
      ball.triangle(triangles, k) = index;
    }
    ++triangles;
  }
  ball.position_m.conservativeResize(vertices, 3);
  ball.triangle.conservativeResize(triangles, 3);
  ball.position_m *= kBall * std::sqrt(4.0 * std::numbers::pi / area);
  return ball;
}

// The ball touches the middle of the top.
void write_ball(fmt::ostream& deck, const QuadraticMesh& mesh) {
  const SurfaceMesh ball = lower_ball();
  const Eigen::Index nodes = mesh.position_m.rows();
  const Eigen::Index tets = mesh.tet.rows();
  const Eigen::Index centre = nodes + ball.position_m.rows() + 1;
  deck.print("*NODE, NSET=BALL\n");
  for (Eigen::Index i = 0; i < ball.position_m.rows(); ++i) {
    const auto p = ball.position_m.row(i) * kMm;
    deck.print("{}, {:.12g}, {:.12g}, {:.12g}\n", nodes + i + 1, p.x(), p.y(),
               p.z() + kMm * (kHeight + kBall));
  }
  deck.print("{}, 0, 0, {:.12g}\n", centre, kMm * (kHeight + kBall));
  deck.print("*ELEMENT, TYPE=C3D4, ELSET=BALL\n");
  for (Eigen::Index t = 0; t < ball.triangle.rows(); ++t) {
    // A tet's fourth corner sees the first three counter-clockwise; from the centre the
    // triangle's run clockwise.
    deck.print("{}, {}, {}, {}, {}\n", tets + t + 1, nodes + ball.triangle(t, 0) + 1,
               nodes + ball.triangle(t, 2) + 1, nodes + ball.triangle(t, 1) + 1,
               centre);
  }
  deck.print(
      "*MATERIAL, NAME=STEEL\n*ELASTIC\n1, 0.3\n"
      "*SOLID SECTION, ELSET=BALL, MATERIAL=STEEL\n"
      "*SURFACE, NAME=BALL, TYPE=ELEMENT\nBALL, S1\n");
}

void write_steps(fmt::ostream& deck) {
  deck.print(
      "*SURFACE INTERACTION, NAME=TOUCH\n"
      "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{:.12g}\n"
      "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE\nTOP, BALL\n",
      kPenalty * kMpa / kMm);
  deck.print(
      "*BOUNDARY\nBOTTOM, 1, 3\n"
      "*TIME POINTS, NAME=TENTHS, GENERATE\n0.1, 1., 0.1\n"
      "*STEP, NLGEOM, INC=1000\n*STATIC\n0.1, 1., 1e-5, 0.1\n"
      "*BOUNDARY\nBALL, 1, 2\nBALL, 3, 3, {:.12g}\n"
      "*NODE PRINT, NSET=BALL, TOTALS=ONLY, TIME POINTS=TENTHS\nRF\n"
      "*NODE PRINT, NSET=BOTTOM, TOTALS=ONLY, TIME POINTS=TENTHS\nRF\n"
      "*END STEP\n",
      -kDepth * kMm);
}

void run(Eigen::Index wanted, const std::string& deck_file,
         const std::string& obj_file) {
  const Gel gel = gel_of(wanted);
  auto deck = fmt::output_file(deck_file);
  write_gel(deck, gel.mesh);
  write_top(deck, gel.mesh);
  write_ball(deck, gel.mesh);
  write_steps(deck);
  write_obj(gel.surface, obj_file, "gel cylinder of the CalculiX deck");
  fmt::print("{} quadratic tets, {} nodes, {} surface vertices\n", gel.mesh.tet.rows(),
             gel.mesh.position_m.rows(), gel.surface.position_m.rows());
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print(stderr, "usage: {} TETS DECK.inp SURFACE.obj\n", argv[0]);
    return 2;
  }
  try {
    palpate::run(std::stol(argv[1]), argv[2], argv[3]);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", argv[0], error.what());
    return 1;
  }
}
