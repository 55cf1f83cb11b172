// The measures against closed forms, on renderers whose faults are known exactly.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "runtime/bench/bench_table1.h"
#include "tests/peers/peer_row.h"
#include "tests/peers/peer_table.h"
#include "tests/support/test_data.h"

namespace palpate::peers {
namespace {

namespace fs = std::filesystem;

// A ball on a plate z = 0 that answers with k d along z.
constexpr double kRadiusM = 0.005;
constexpr double kStiffness = 100.0;
constexpr double kDepthMaxM = 0.004;
constexpr double kWayM = 0.008;  // of the cycle
constexpr double kLowM = 0.001;
constexpr double kDeepM = 0.003;
// Faults.
constexpr double kLie = 1.1;     // times the true force
constexpr double kJumpN = 0.02;  // sideways where x > 0
constexpr double kTwist = 7.0;   // [N/m] force along x per depth: no potential
constexpr double kHumN = 0.03;   // sideways: a sine of the ticks
constexpr double kHumHz = 20.0;
constexpr double kSwayN = 0.3;  // likewise, slowly
constexpr double kSwayHz = 2.5;
constexpr double kTrueHumN = 0.01;  // of the dense truth
constexpr double kTrueHumHz = 10.0;

struct FaultyTool {
  std::string fault;
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  int ticks = 0;
};

FaultyTool& faulty(peer* p) {
  return *reinterpret_cast<FaultyTool*>(p);
}

const char* variant(int index) {
  constexpr const char* kNames[] = {"true",      "lies",    "jumps", "twists",
                                    "allocates", "refuses", "hums",  "sways"};
  return index < 8 ? kNames[index] : nullptr;
}

peer* open(const char*, const char*, const char* name, double, char* error,
           size_t error_bytes) {
  if (std::strcmp(name, "refuses") == 0) {
    std::snprintf(error, error_bytes, "not today");
    return nullptr;
  }
  return reinterpret_cast<peer*>(new FaultyTool{name});
}

void pose(peer* p, const double position_m[3], const double[4]) {
  faulty(p).at_m = Eigen::Vector3d(position_m);
  ++faulty(p).ticks;
}

double sine(double amplitude, double hz, int tick) {
  return amplitude * std::sin(2.0 * std::numbers::pi * hz * kHandTickS * tick);
}

void force(peer* p, double force_n[3]) {
  const FaultyTool& tool = faulty(p);
  const double depth = std::max(0.0, kRadiusM - tool.at_m.z());
  Eigen::Vector3d f(0.0, 0.0, kStiffness * depth);
  if (tool.fault == "lies") {
    f *= kLie;
  } else if (tool.fault == "jumps" && depth > 0.0 && tool.at_m.x() > 0.0) {
    f.y() = kJumpN;
  } else if (tool.fault == "twists") {
    f.x() = kTwist * depth;
  } else if (tool.fault == "hums" && depth > 0.0) {
    f.y() = sine(kHumN, kHumHz, tool.ticks);
  } else if (tool.fault == "sways" && depth > 0.0) {
    f.y() = sine(kSwayN, kSwayHz, tool.ticks);
    f.z() += sine(0.1 * f.z(), kHumHz, tool.ticks);  // not sideways
  } else if (tool.fault == "allocates") {
    // Volatile, or the compiler leaves both away.
    for (int i = 0; i < 2; ++i) {
      void* volatile memory = std::malloc(16);  // NOLINT
      std::free(memory);                        // NOLINT
    }
  }
  Eigen::Map<Eigen::Vector3d>{force_n} = f;
}

void slow(peer*) {}
void close(peer* p) {
  delete &faulty(p);
}

const Renderer kFaulty{"faulty", variant, open, pose, force, slow, close};

// Squares of 4 mm, each cut in two; one line of vertices is x = 0.
SurfaceMesh plate() {
  constexpr int kSquares = 10;
  SurfaceMesh mesh;
  mesh.position_m.resize((kSquares + 1) * (kSquares + 1), 3);
  mesh.triangle.resize(2 * kSquares * kSquares, 3);
  Eigen::Index t = 0;
  for (int i = 0; i <= kSquares; ++i) {
    for (int j = 0; j <= kSquares; ++j) {
      const int v = i * (kSquares + 1) + j;
      mesh.position_m.row(v) << 0.004 * (i - 5), 0.004 * (j - 5), 0.0;
      if (i < kSquares && j < kSquares) {
        const int next = v + kSquares + 1;
        mesh.triangle.row(t++) << v, next, next + 1;
        mesh.triangle.row(t++) << v, next + 1, v + 1;
      }
    }
  }
  return mesh;
}

class HandFile {
 public:
  HandFile(const fs::path& scene, const std::string& name)
      : poses_(scene / "hands" / (name + ".csv")),
        truth_(scene / "truth" / (name + ".csv")) {
    poses_ << "x_m,y_m,z_m,nx,ny,nz\n";
    truth_ << "tick,fx_n,fy_n,fz_n\n";
  }

  void go(double x, double depth, int ticks) {
    for (int i = 1; i <= ticks; ++i, ++tick_) {
      const double share = static_cast<double>(i) / ticks;
      const double d = depth_ + share * (depth - depth_);
      poses_ << fmt::format("{},{},{},0,0,1\n", x_ + share * (x - x_), 0.0011,
                            kRadiusM - d);
      truth_ << fmt::format("{},0,0,{}\n", tick_, kStiffness * std::max(0.0, d));
    }
    x_ = x;
    depth_ = depth;
  }

 private:
  std::ofstream poses_;
  std::ofstream truth_;
  double x_ = -0.004;
  double depth_ = -0.001;
  int tick_ = 0;
};

class Peers : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "hands");
    fs::create_directories(folder_ / "truth");
    write_obj(plate(), folder_ / "surface.obj", "a plate");
    std::ofstream(folder_ / "scene.txt") << fmt::format(
        "tool_radius_m {}\ndepth_max_m {}\nsite_m 0 0 0\nsite_normal 0 0 "
        "1\ntyped_stiffness_n_per_m {}\n",
        kRadiusM, kDepthMaxM, kStiffness);
    HandFile press(folder_, "press");
    press.go(-0.004, kDepthMaxM, 200);
    press.go(-0.004, -0.001, 200);
    HandFile slide(folder_, "slide-20");
    slide.go(-0.004, kLowM, 100);
    slide.go(0.004, kLowM, 400);
    slide.go(0.004, -0.001, 100);
    std::ofstream dense(folder_ / "truth" / "slide-20-dense.csv");
    dense << "tick,fx_n,fy_n,fz_n\n";
    for (int tick = 99; tick <= 499; tick += 25) {
      dense << fmt::format("{},{},{},{}\n", tick, sine(kTrueHumN, kTrueHumHz, tick),
                           sine(kTrueHumN, kSwayHz, tick), kStiffness * kLowM);
    }
    for (const bool back : {false, true}) {
      HandFile cycle(folder_, back ? "cycle-back" : "cycle");
      cycle.go(-0.004, back ? kDeepM : kLowM, 100);
      cycle.go(-0.004 + kWayM, back ? kDeepM : kLowM, 100);
      cycle.go(-0.004 + kWayM, back ? kLowM : kDeepM, 100);
      cycle.go(-0.004, back ? kLowM : kDeepM, 100);
      cycle.go(-0.004, -0.001, 100);
    }
  }
  std::vector<PeerRow> rows(const Renderer& renderer = kFaulty) {
    return measure(renderer, read_peer_scene(folder_),
                   {.stability = false, .times = false});
  }

  ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
};

// Of rounding alone: sums of some hundred numbers of order one.
constexpr double kRounding = 1e-12;

TEST_F(Peers, ForceErrorIsWhatTheSpringLies) {
  const auto all = rows();
  EXPECT_LT(all[0].error.contact_relative, kRounding);
  EXPECT_NEAR(all[1].error.contact_relative, kLie - 1.0, kRounding);
  EXPECT_NEAR(all[1].error.along_relative, kLie - 1.0, kRounding);
  // Sideways forces are off, but not along the true one.
  EXPECT_GT(all[3].error.contact_relative, 0.99 * kTwist / kStiffness);
  EXPECT_LT(all[3].error.along_relative, kRounding);
}

TEST_F(Peers, JumpAtAnEdgeIsItsSize) {
  const auto all = rows();
  EXPECT_GT(all[2].jumps.edges, 2);
  EXPECT_LT(all[0].jumps.largest_n, kRounding);
  EXPECT_NEAR(all[2].jumps.largest_n, kJumpN, kRounding);
  EXPECT_LT(all[2].jumps.mean_n, kJumpN);  // other edges have none
}

TEST_F(Peers, TurnAtAnEdgeIsTheJumpsAngle) {
  const auto all = rows();
  const double turn = std::atan2(kJumpN, kStiffness * kLowM);
  EXPECT_LT(all[0].jumps.turn_rad, kRounding);
  EXPECT_NEAR(all[2].jumps.turn_rad, turn, kRounding);
  EXPECT_NEAR(all[2].jumps.turn_anywhere_rad, turn, kRounding);
  // A twist that is always there turns nothing.
  EXPECT_LT(all[3].jumps.turn_rad, kRounding);
}

// All sines here have whole numbers of periods in the slide's 0.4 s.
TEST_F(Peers, RoughnessIsThatOfASineAboveFiveHertz) {
  // Of one period the window brings a sixth of the squares to two: to 5 Hz.
  constexpr double kSwaysShare = 1.0 / 6.0;
  const auto all = rows();
  const Roughness smooth = roughness(all[0].sideways);
  const Roughness hums = roughness(all[6].sideways);
  const Roughness sways = roughness(all[7].sideways);
  const double true_n = kTrueHumN * std::sqrt(0.5 * (1.0 + kSwaysShare));
  EXPECT_LT(smooth.rendered_n, kRounding);
  EXPECT_NEAR(smooth.true_n, true_n, kRounding);
  EXPECT_NEAR(hums.rendered_n, kHumN * std::sqrt(0.5), kRounding);
  EXPECT_NEAR(hums.ratio, kHumN * std::sqrt(0.5) / true_n, kRounding);
  EXPECT_NEAR(sways.rendered_n, kSwayN * std::sqrt(0.5 * kSwaysShare), kRounding);
}

TEST_F(Peers, TruthThatIsNotDenseHasNoRoughness) {
  fs::remove(folder_ / "truth" / "slide-20-dense.csv");
  const auto all = rows();
  EXPECT_TRUE(std::isnan(roughness(all[6].sideways).ratio));
  EXPECT_EQ(spectrum_picture(all, all[0].scene), "");
}

TEST_F(Peers, CreatedEnergyIsThatOfTheTwist) {
  const auto all = rows();
  EXPECT_LT(all[0].created_cycle_j, kRounding);
  EXPECT_LT(all[0].created_path_j, kRounding);
  // Once around, either way: kTwist times the area in the plane of x and depth.
  EXPECT_NEAR(all[3].created_cycle_j, kTwist * kWayM * (kDeepM - kLowM), kRounding);
  // The slide is pushed along at a constant depth; pressing and lifting gives nothing.
  EXPECT_NEAR(all[3].created_path_j, kTwist * kLowM * kWayM, kRounding);
}

TEST_F(Peers, RepeatsToTheBitAndTellsRenderersApart) {
  const auto first = rows();
  const auto second = rows();
  EXPECT_EQ(first[0].digest, second[0].digest);
  EXPECT_NE(first[0].digest, first[1].digest);
}

TEST_F(Peers, MissingIsSaid) {
  EXPECT_EQ(rows()[5].missing, "not today");
  EXPECT_NE(table_markdown(rows()).find("faulty refuses: not today"),
            std::string::npos);
}

// Of a line of CSV whose quoted fields hold no quotes.
int columns(const std::string& line) {
  int count = 1;
  bool quoted = false;
  for (const char c : line) {
    quoted = quoted != (c == '"');
    count += c == ',' && !quoted ? 1 : 0;
  }
  return count;
}

TEST_F(Peers, EveryLineOfTheTableHasEveryColumn) {
  auto all = rows();
  all.front().renderer = "a, b";
  std::istringstream text(table_csv(all));
  std::string head;
  std::getline(text, head);
  int lines = 0;
  for (std::string line; std::getline(text, line); ++lines) {
    EXPECT_EQ(columns(line), columns(head)) << line;
  }
  EXPECT_EQ(lines, static_cast<int>(all.size()));
}

TEST_F(Peers, AllocationsAreCounted) {
  const PeerScene scene = read_peer_scene(folder_);
  const Hand* hands[] = {scene.find("press")};
  EXPECT_EQ(step_times(kFaulty, "allocates", scene, folder_, hands).allocations, 2.0);
  EXPECT_EQ(step_times(kFaulty, "true", scene, folder_, hands).allocations, 0.0);
}

// The bench of the paper's table asks the same of a plain wall, by its own loop; its
// raise and its bisection end within 0.2 %, this one's within 1 %. A renderer that
// answers with more force is the same wall at another gain.
TEST_F(Peers, StableStiffnessIsThatOfAPlainWall) {
  const PeerScene scene = read_peer_scene(folder_);
  const LeaningDevice pencat = leaning_devices().front();
  Table1Options options;
  options.fast_hz = pencat.fast_hz;
  options.wall = WallShape::kLinear;
  options.settle_s = 2.0;
  options.watch_s = 4.0;
  const double wall =
      largest_stable_stiffness(options, LocalModel::kSingle, options.fast_hz);
  const auto plain = largest_stable_stiffness(kFaulty, "true", scene, folder_, pencat);
  const auto lying = largest_stable_stiffness(kFaulty, "lies", scene, folder_, pencat);
  EXPECT_NEAR(plain.rest_n_per_m, kStiffness, 1e-6);
  EXPECT_NEAR(plain.stiffness_n_per_m, wall, 0.02 * wall);
  EXPECT_NEAR(lying.stiffness_n_per_m, plain.stiffness_n_per_m, 0.02 * wall);
}

TEST_F(Peers, NoduleIsFoundWhereItIs) {
  PeerScene scene = read_peer_scene(folder_);
  std::vector<double> force_n;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) {
      scene.raster.push_back({{0.004 * i, 0.004 * j, 0.0}, {0.0, 0.0, 1.0}, 1.0});
      force_n.push_back(1.0 + 0.01 * i);
    }
  }
  scene.nodule_m = Eigen::Vector3d(0.013, 0.016, -0.01);
  scene.nodule_radius_m = 0.003;
  EXPECT_FALSE(find_nodule(scene, force_n).found);
  EXPECT_EQ(find_nodule(scene, force_n).false_finds, 0);
  force_n[3 * 9 + 4] *= 1.5;
  const NoduleFind find = find_nodule(scene, force_n);
  EXPECT_TRUE(find.found);
  EXPECT_NEAR(find.distance_m, 0.001, 1e-12);
  EXPECT_NEAR(find.largest_deviation, 0.5, 0.05);
  force_n[8 * 9 + 8] *= 2.0;  // far away, and stiffer
  EXPECT_FALSE(find_nodule(scene, force_n).found);
  EXPECT_EQ(find_nodule(scene, force_n).false_finds, 1);
}

// An entrant written after the page alone: on a plate it is right.
TEST_F(Peers, ExampleEntrantIsRightOnAPlate) {
  const Renderer example =
      load_renderer(fs::path(PEERS_LIBRARIES) / "peer_nearest_vertex.so");
  const auto all = rows(example);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].renderer, "nearest_vertex penalty");
  EXPECT_EQ(all[0].missing, "");
  EXPECT_LT(all[0].error.contact_relative, kRounding);
}

TEST_F(Peers, WrongFilesAreNamed) {
  std::ofstream(folder_ / "hands" / "press.csv") << "x_m,y_m,z_m\n1,2\n";
  try {
    (void)read_peer_scene(folder_);
    FAIL();
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find("press.csv:2"), std::string::npos);
  }
  EXPECT_THROW((void)load_renderer("/lib/x86_64-linux-gnu/libm.so.6"), InputError);
}

}  // namespace
}  // namespace palpate::peers
