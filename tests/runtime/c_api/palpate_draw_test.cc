// What hosts draw: contacts with their forces, and how the surface gives way, through
// palpate_draw.h and palpate.hpp.
#include "runtime/c_api/palpate_draw.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "runtime/c_api/palpate.hpp"
#include "tests/support/padded_host.h"
#include "tests/support/run_tool.h"

namespace palpate {
namespace {

constexpr double kFieldM = 0.004;  // depth at which fields are stored

Eigen::Vector3d vec(const double (&v)[3]) {
  return Eigen::Vector3d(v);
}

class PalpateDraw : public PaddedHost {
 protected:
  static palpate_options in_millimetres(const char* tool) {
    palpate_options all = options(tool);
    all.metres_per_unit = 0.001;
    all.newtons_per_unit = 0.01;
    return all;
  }

  // Two modes: all sinks along -z, and vertex i goes i um along x. @param every only
  // every so manieth node has a field.
  void store_fields(Eigen::Index every) {
    ResponseDatabase database = read_database(file_);
    const Eigen::Index n = database.body.position_m.rows();
    for (ResponseTable& table : database.tools) {
      DisplacementField& field = table.displacement;
      field.basis = RowMajorMatrixF::Zero(3 * n, 2);
      for (Eigen::Index i = 0; i < n; ++i) {
        field.basis(3 * i + 2, 0) = -1.0F;
        field.basis(3 * i, 1) = 1e-6F * static_cast<float>(i);
      }
      std::vector<std::array<float, 2>> rows;
      for (Eigen::Index i = 0; i < n; i += every) {
        field.node.push_back(static_cast<std::int32_t>(i));
        field.depth_m.push_back(kFieldM);
        field.error_relative.push_back(0.0);
        rows.push_back({sink(i), 2.0F});
      }
      field.coefficient.resize(static_cast<Eigen::Index>(rows.size()), 2);
      for (std::size_t j = 0; j < rows.size(); ++j) {
        field.coefficient.row(static_cast<Eigen::Index>(j)) << rows[j][0], rows[j][1];
      }
    }
    write_database(file_, database);
  }
  static float sink(Eigen::Index node) { return 1e-3F * static_cast<float>(node % 7); }

  // Down by a centimetre to z, the second hand 20 mm beside the first.
  static Tick press(Body& body, Tool& tool, double z, double unit = 1.0,
                    const Eigen::Isometry3d& world = Eigen::Isometry3d::Identity()) {
    Tick tick;
    for (int i = 0; i <= 1000; ++i) {
      std::array<Pose, 2> poses;
      for (int hand = 0; hand < 2; ++hand) {
        const Eigen::Vector3d at =
            world * Eigen::Vector3d(0.001 + 0.02 * hand, 0.002, z + 1e-5 * (1000 - i));
        const Eigen::Vector4d turn = Eigen::Quaterniond(world.rotation()).coeffs();
        for (std::size_t k = 0; k < 3; ++k) {
          poses[static_cast<std::size_t>(hand)].position[k] =
              at[static_cast<Eigen::Index>(k)] / unit;
        }
        for (std::size_t k = 0; k < 4; ++k) {
          poses[static_cast<std::size_t>(hand)].quat_xyzw[k] =
              turn[static_cast<Eigen::Index>(k)];
        }
      }
      tick = tool.step(poses, 0.001);
      if (i % 10 == 0) {
        (void)body.slow_step();
      }
    }
    return tick;
  }
};

// All that bear something bear the whole force together, each where its sphere is.
TEST_F(PalpateDraw, ContactsBearWhatIsFelt) {
  for (const auto& [name, model] : {std::pair{"ball", "potential"},
                                    {"ball", "facets"},
                                    {"ball", "element"},
                                    {"pads", "potential"},
                                    {"pads", "facets"}}) {
    palpate_options all = in_millimetres(name);
    all.model = model;
    Body body(file_, all);
    Eigen::Isometry3d world = Eigen::Isometry3d::Identity();
    world.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()));
    world.pretranslate(Eigen::Vector3d(0.3, -0.2, 1.0));
    const Eigen::Vector3d origin = 1e3 * world.translation();
    const Eigen::Vector4d turn = Eigen::Quaterniond(world.rotation()).coeffs();
    body.place({origin.x(), origin.y(), origin.z()},
               {turn[0], turn[1], turn[2], turn[3]});
    Tool tool = body.add_tool();
    EXPECT_EQ(tool.contacts().at(0).triangle, -1);
    const Tick tick = press(body, tool, 0.003, 0.001, world);
    ASSERT_TRUE(tick.touches()) << tick.status_name();
    const std::vector<palpate_contact> contacts = tool.contacts();
    ASSERT_EQ(contacts.size(), std::string(name) == "pads" ? 3U : 1U);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Eigen::Vector3d up = world.rotation() * Eigen::Vector3d::UnitZ();
    for (const palpate_contact& contact : contacts) {
      sum += vec(contact.force);
      EXPECT_EQ(contact.touching, 1);
      EXPECT_EQ(contact.hand, 0);
      EXPECT_NEAR(contact.radius, 5.0, 1e-12);
      EXPECT_NEAR((vec(contact.normal) - up).norm(), 0.0, 1e-9);
      // The plate lies at z = 0 of the body.
      const Eigen::Vector3d point = world.inverse() * (1e-3 * vec(contact.point));
      EXPECT_NEAR(point.z(), 0.0, 1e-9);
      const Eigen::Vector3d centre = world.inverse() * (1e-3 * vec(contact.centre));
      EXPECT_NEAR(centre.z(), 0.003, 1e-9);
      EXPECT_NEAR(contact.depth, 2.0, 1e-6);
      EXPECT_GT(contact.own_depth, 1.0);
      EXPECT_EQ(contact.own_depth == contact.depth, contacts.size() == 1);
      EXPECT_NEAR(contact.shares[0] + contact.shares[1] + contact.shares[2], 1.0, 1e-9);
      const Mesh mesh = body.mesh();
      Eigen::Vector3d shared = Eigen::Vector3d::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto vertex = static_cast<std::size_t>(
            mesh.corner[static_cast<std::size_t>(contact.triangle)][k]);
        shared += contact.shares[k] * Eigen::Vector3d(mesh.vertex[vertex].data());
      }
      EXPECT_NEAR((shared - vec(contact.point)).norm(), 0.0, 1e-6);
    }
    const Eigen::Vector3d felt(tick.hand[0].force.data());
    EXPECT_GT(felt.norm(), 1.0);
    EXPECT_NEAR((sum - felt).norm(), 0.0, 1e-9);
    EXPECT_NEAR(tool.state().depth, contacts[0].depth, 1e-9);
  }
}

TEST_F(PalpateDraw, EachHandHasItsOwn) {
  Body body(file_, options("ball"));
  Tool tool = body.add_together("pads");
  const Tick tick = press(body, tool, 0.004);
  ASSERT_TRUE(tick.touches()) << tick.status_name();
  std::array<Eigen::Vector3d, 2> sum{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::array<int, 2> tables{-1, -1};
  const std::vector<palpate_contact> contacts = tool.contacts();
  ASSERT_EQ(contacts.size(), 4U);
  for (const palpate_contact& contact : contacts) {
    const auto hand = static_cast<std::size_t>(contact.hand);
    sum[hand] += vec(contact.force);
    tables[hand] = contact.table;
  }
  EXPECT_EQ(tables, (std::array<int, 2>{0, 1}));
  for (std::size_t hand = 0; hand < 2; ++hand) {
    EXPECT_NEAR((sum[hand] - Eigen::Vector3d(tick.hand[hand].force.data())).norm(), 0.0,
                1e-12);
  }
  EXPECT_GT(sum[0].z(), 0.01);
  EXPECT_GT(sum[1].z(), 1.5 * sum[0].z());
}

// Fields of the corners, by shares, in proportion to what each contact itself sinks.
TEST_F(PalpateDraw, TheSurfaceGivesWayAsStored) {
  store_fields(1);
  for (const char* name : {"ball", "pads"}) {
    Body body(file_, in_millimetres(name));
    body.place({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0, 1.0});  // a quarter turn about z
    Tool tool = body.add_tool();
    Eigen::Isometry3d world = Eigen::Isometry3d::Identity();
    world.linear() << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
    EXPECT_TRUE(tool.displaced(tool.contacts()).empty());
    (void)press(body, tool, 0.003, 0.001, world);
    const std::vector<palpate_contact> contacts = tool.contacts();
    const std::vector<Point> moved = tool.displaced(contacts);
    const Mesh mesh = body.mesh();
    ASSERT_EQ(moved.size(), mesh.vertex.size());
    double sunk = 0.0, along = 0.0;  // [mm], and of vertex 1 along x
    for (const palpate_contact& contact : contacts) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int node = mesh.corner[static_cast<std::size_t>(contact.triangle)][k];
        const double part = contact.shares[k] * 1e-3 * contact.own_depth / kFieldM;
        sunk += part * 1e3 * static_cast<double>(sink(node));
        along += part * 2e-3;
      }
    }
    EXPECT_GT(sunk, 0.1);
    for (std::size_t i : {std::size_t{0}, std::size_t{17}, moved.size() - 1}) {
      EXPECT_NEAR(moved[i][2], -sunk, 1e-6 * sunk) << i;
      EXPECT_NEAR(moved[i][1], along * static_cast<double>(i), 1e-5) << i;
      EXPECT_NEAR(moved[i][0], 0.0, 1e-9);
    }
  }
}

// examples/pressed_body.cc: the vertices as they are drawn, less those at rest.
TEST_F(PalpateDraw, AHostDrawsWhatItPresses) {
  store_fields(1);
  const ToolRun run = run_tool_process("cpp_pressed_host", {file_, "ball", "0.005"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  double up_n = 0.0;
  ASSERT_EQ(std::sscanf(run.out.c_str(), "# contact, %lf N upwards", &up_n), 1)
      << run.out.substr(0, 100);
  EXPECT_GT(up_n, 0.05);
  Body body(file_, options("ball"));
  body.place({0.3, 0.0, 1.0}, {std::sin(0.2), 0.0, 0.0, std::cos(0.2)});
  const Mesh rest = body.mesh();
  std::istringstream lines(run.out.substr(run.out.find('\n') + 1));
  double moved_m = 0.0;
  for (const Point& at : rest.vertex) {
    std::string v;
    Eigen::Vector3d drawn_m;
    lines >> v >> drawn_m.x() >> drawn_m.y() >> drawn_m.z();
    ASSERT_EQ(v, "v");
    moved_m = std::max(moved_m, (drawn_m - Eigen::Vector3d(at.data())).norm());
  }
  EXPECT_GT(moved_m, 5e-4);
  EXPECT_LT(moved_m, 0.1);
}

TEST_F(PalpateDraw, WithoutFieldsNothingIsMadeUp) {
  Body bare(file_, options("pads"));
  Tool tool = bare.add_tool();
  (void)press(bare, tool, 0.003);
  EXPECT_TRUE(tool.displaced(tool.contacts()).empty());
  store_fields(2);  // no triangle has all three
  Body some(file_, options("pads"));
  Tool other = some.add_tool();
  (void)press(some, other, 0.003);
  EXPECT_TRUE(other.displaced(other.contacts()).empty());
}

TEST_F(PalpateDraw, OlderAndNewerHostsHaveTheirOwnStructs) {
  Body body(file_, options("pads"));
  Tool tool = body.add_tool();
  (void)press(body, tool, 0.003);
  const std::vector<palpate_contact> whole = tool.contacts();
  constexpr std::size_t kWide = sizeof(palpate_contact) + 16;
  std::vector<unsigned char> wide(2 * kWide, 0xAA);
  // Room for two of three; what the library does not know is zero.
  EXPECT_EQ(
      palpate_contacts_get(tool.handle(),
                           reinterpret_cast<palpate_contact*>(wide.data()), 2, kWide),
      3);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(std::memcmp(&wide[i * kWide], &whole[i], sizeof whole[i]), 0);
    EXPECT_EQ(wide[(i + 1) * kWide - 1], 0);
  }
  constexpr std::size_t kShort = 24;
  std::vector<unsigned char> few(3 * kShort + 1, 0xAA);
  EXPECT_EQ(
      palpate_contacts_get(tool.handle(),
                           reinterpret_cast<palpate_contact*>(few.data()), 3, kShort),
      3);
  EXPECT_EQ(std::memcmp(&few[2 * kShort], &whole[2], kShort), 0);
  EXPECT_EQ(few.back(), 0xAA);
}

TEST_F(PalpateDraw, OddCallsAreErrors) {
  Body body(file_, options("pads"));
  Tool tool = body.add_tool();
  palpate_contact one{};
  EXPECT_EQ(palpate_contacts_get(nullptr, &one, 1, sizeof one), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_contacts_get(tool.handle(), nullptr, 1, sizeof one),
            PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_contacts_get(tool.handle(), &one, 1, 0), PALPATE_ERROR_INPUT);
  EXPECT_EQ(palpate_contacts_get(tool.handle(), nullptr, 0, sizeof one), 3);
  const auto refused = [&](const palpate_contact& contact) {
    try {
      (void)tool.displaced({contact});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  palpate_contact odd{};
  odd.triangle = 1'000'000;
  EXPECT_NE(refused(odd).find("none of this tool's"), std::string::npos);
  odd = {};
  odd.table = 1;
  EXPECT_NE(refused(odd), "");
  odd = {};
  odd.own_depth = std::nan("");
  EXPECT_NE(refused(odd), "");
  odd = {};
  odd.shares[1] = HUGE_VAL;
  EXPECT_NE(refused(odd), "");
  EXPECT_THROW(Body(file_ + ".none"), Error);
  EXPECT_THROW(body.place({std::nan(""), 0.0, 0.0}), Error);
  palpate_options streamed = options("ball");
  streamed.flags |= PALPATE_STREAMED;
  Body far(file_, streamed);
  Tool follower = far.add_tool();
  EXPECT_TRUE(far.mesh().vertex.empty());
  EXPECT_EQ(palpate_displaced(follower.handle(), &one, 1, sizeof one, one.point, error_,
                              sizeof error_),
            PALPATE_ERROR_INPUT);
  EXPECT_NE(std::string(error_).find("without streaming"), std::string::npos);
}

// Surfaces and clamped forces, by the C++ names.
TEST_F(PalpateDraw, TheRestOfTheInterfaceIsThereInCxx) {
  Body body(file_, options("ball"));
  Tool tool = body.add_tool();
  EXPECT_EQ(tool.hands(), 1U);
  const Tick tick = press(body, tool, 0.003);
  EXPECT_EQ(tool.delivered(tick.hand), 0);
  EXPECT_GT(body.needed_damping(), 0.0);
  const std::vector<Point> forces =
      body.query({{0.001, 0.002, 0.003}, {0.0, 0.0, 1.0}});
  EXPECT_NEAR(forces[0][2], 2e4 * 0.002 * 0.002, 1e-6);
  EXPECT_EQ(forces[1], (Point{0.0, 0.0, 0.0}));
  tool.save_surface(file_ + ".surface");
  tool.load_surface(file_ + ".surface");
  tool.load_surface();
  EXPECT_THROW(tool.load_surface(file_), Error);
  tool.reset();
  EXPECT_EQ(tool.state().ticks, 0U);
}

}  // namespace
}  // namespace palpate
