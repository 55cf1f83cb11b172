// One node's fault - in a press, a ratio, a correction, an interpolation, a worker, a
// checkpoint - costs that node, and nothing else: the build ends with a file.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/base/sha256.h"
#include "formats/database/work_unit.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/build/build.h"
#include "precompute/process/fault_point.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/organ_scene.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// What a database holds of a node, by its index in the user's mesh.
struct Stored {
  int origin = 0;
  int flags = 0;
  std::string failure;
  std::vector<double> numbers;  // direction, offset, error, depths, forces
};
using Database = std::map<std::int32_t, Stored>;

Database stored(const ResponseDatabase& database) {
  const ResponseTable& table = database.tools.front();
  Database nodes;
  for (std::int64_t i = 0; i < table.nodes(); ++i) {
    const auto n = static_cast<std::size_t>(i);
    Stored node{table.origin[n], table.flags[n], {}, {}};
    if (!table.failure.empty() && table.failure[n] >= 0) {
      node.failure = table.failure_reason[static_cast<std::size_t>(table.failure[n])];
    }
    for (int axis = 0; axis < 3; ++axis) {
      node.numbers.push_back(table.direction(i, axis));
    }
    node.numbers.push_back(table.touch_offset_m[n]);
    node.numbers.push_back(table.error_relative[n]);
    const CurveView curve = table.curve(i);
    node.numbers.insert(node.numbers.end(), curve.depth_m.begin(), curve.depth_m.end());
    node.numbers.insert(node.numbers.end(), curve.force_n.begin(), curve.force_n.end());
    nodes.emplace(static_cast<std::int32_t>(i), std::move(node));
  }
  return nodes;
}

class BuildFaults : public testing::Test {
 protected:
  BuildFaults() { write_obj(organ(2), folder_ / "organ.obj", "an organ"); }
  ~BuildFaults() override { set_fault_maker({}); }

  Scene scene(const std::string& law) const {
    std::string ball = kBallOnTop;
    ball.replace(ball.find("0.040"), 5, fmt::format("{:.3f}", reach_from_m_));
    std::ofstream(folder_ / "scene.toml")
        << organ_on_table(law) << ball << "refine = \"global\"\nverify = " << verify_
        << "\n";
    return read_scene(folder_ / "scene.toml");
  }

  BuildReport build_one(const std::string& law, bool solve_all, bool resume = false) {
    Progress quiet(nullptr);
    return build(scene(law),
                 {.output = folder_ / "out.h5",
                  .resume = resume,
                  .solve_all = solve_all,
                  .precision = Precision::kFloat64,
                  .workers = 1},
                 quiet);
  }

  // What a build without a fault makes; once for all tests of this file.
  struct Sound {
    BuildReport report;
    std::int32_t first_ratio = -1;  // vertex at which the first ratio is taken
  };
  const Sound& sound(const std::string& law, bool solve_all) {
    static std::map<std::pair<std::string, bool>, Sound> made;
    const std::pair key(law, solve_all);
    if (!made.contains(key)) {
      std::int32_t first = -1;
      set_fault_maker([&](FaultPlace at, std::int32_t vertex, std::span<double>) {
        first = at == FaultPlace::kRatio && first < 0 ? vertex : first;
      });
      const BuildReport report = build_one(law, solve_all);
      made[key] = {report, first};
      set_fault_maker({});
    }
    return made.at(key);
  }

  // A vertex of the sound build whose response is of that origin.
  static std::int32_t vertex_of(const BuildReport& report, ResponseOrigin origin,
                                std::size_t which = 5) {
    const auto& all = report.assembly.database.tools.front().origin;
    for (std::size_t v = 0; v < all.size(); ++v) {
      if (all[v] == static_cast<std::uint8_t>(origin) && which-- == 0) {
        return static_cast<std::int32_t>(v);
      }
    }
    return -1;
  }

  // Builds with the fault; all but the vertex must be the same bits as without.
  void expect_only(const std::string& law, ResponseOrigin origin, FaultPlace place,
                   const std::function<void(std::span<double>)>& fault,
                   const std::string& reason, bool solve_all = true) {
    const BuildReport& whole = sound(law, solve_all).report;
    ASSERT_EQ(whole.assembly.failed, 0);
    const std::int32_t bad = vertex_of(whole, origin);
    ASSERT_GE(bad, 0);
    int met = 0;
    set_fault_maker([&](FaultPlace at, std::int32_t vertex, std::span<double> numbers) {
      if (at == place && vertex == bad) {
        ++met;
        fault(numbers);
      }
    });
    fs::remove(folder_ / "out.h5");  // better than what replaces it
    const BuildReport spoilt = build_one(law, solve_all);
    EXPECT_GT(met, 0);
    EXPECT_EQ(spoilt.assembly.failed, 1);
    const Database before = stored(whole.assembly.database);
    const Database after = stored(spoilt.assembly.database);
    EXPECT_EQ(after.at(bad).origin, 0);
    EXPECT_NE(after.at(bad).flags & kFailed, 0);
    EXPECT_NE(after.at(bad).failure.find(reason), std::string::npos)
        << after.at(bad).failure;
    for (const auto& [vertex, node] : before) {
      if (vertex != bad) {
        EXPECT_EQ(after.at(vertex).numbers, node.numbers) << vertex;
        EXPECT_EQ(after.at(vertex).flags, node.flags) << vertex;
      }
    }
    EXPECT_NO_THROW((void)read_database(folder_ / "out.h5"));
    EXPECT_FALSE(fs::exists(folder_ / "out.h5.partial"));
  }

  int verify_ = 0;
  double reach_from_m_ = 0.040;  // places above are reached: 22
  ScratchFolder folder_;
};

void to_nan(std::span<double> numbers) {
  numbers[0] = kNaN;
}

TEST_F(BuildFaults, ANaNFromALinearPressCostsItsNodeAlone) {
  expect_only("linear", ResponseOrigin::kSimulated, FaultPlace::kPress, to_nan,
              "linear press");
}

TEST_F(BuildFaults, AnInfiniteForceOfANonlinearPressCostsItsNodeAlone) {
  reach_from_m_ = 0.044;  // ten
  expect_only(
      "neo-hookean", ResponseOrigin::kSimulated, FaultPlace::kCorrection,
      [](std::span<double> force) {
        force[2] = std::numeric_limits<double>::infinity();
      },
      "nonlinear press");
}

TEST_F(BuildFaults, ANaNInAnInterpolatedResponseCostsItsNodeAlone) {
  expect_only(
      "neo-hookean", ResponseOrigin::kInterpolated, FaultPlace::kInterpolation,
      [](std::span<double> force) {
        force.back() = kNaN;
      },
      "its response was dropped: its force", false);
}

TEST_F(BuildFaults, AWorkerThatDiesCostsItsNodeAlone) {
  expect_only(
      "linear", ResponseOrigin::kSimulated, FaultPlace::kWorker,
      [](std::span<double>) {
        throw std::runtime_error("the floor fell in");
      },
      "the floor fell in");
  expect_only(
      "linear", ResponseOrigin::kSimulated, FaultPlace::kWorker,
      [](std::span<double>) {
        throw 7;
      },
      "unknown exception");
}

TEST_F(BuildFaults, ARatioThatFailsLeavesItsNeighboursTheOthers) {
  const BuildReport& whole = sound("neo-hookean", false).report;
  const std::int32_t bad = sound("neo-hookean", false).first_ratio;
  ASSERT_GT(whole.assembly.interpolated, 0);
  ASSERT_GE(bad, 0);
  int met = 0;
  set_fault_maker([&](FaultPlace at, std::int32_t vertex, std::span<double> numbers) {
    if (at == FaultPlace::kRatio && vertex == bad) {
      ++met;
      to_nan(numbers);
    }
  });
  const BuildReport spoilt = build_one("neo-hookean", false);
  EXPECT_GT(met, 0);
  EXPECT_EQ(spoilt.assembly.failed, 0);  // its own press is sound
  EXPECT_GT(spoilt.assembly.interpolated, 0);
  const ResponseTable& before = whole.assembly.database.tools.front();
  const ResponseTable& after = spoilt.assembly.database.tools.front();
  for (std::int64_t v = 0; v < before.nodes(); ++v) {
    if (!before.curve(v).depth_m.empty()) {
      const double was = before.curve(v).force_n.back();
      EXPECT_NEAR(after.curve(v).force_n.back(), was, v == bad ? 0.0 : 0.1 * was) << v;
    }
  }
}

TEST_F(BuildFaults, EveryNodeFailingIsSaidWithTheReason) {
  set_fault_maker([](FaultPlace at, std::int32_t, std::span<double> numbers) {
    if (at == FaultPlace::kPress) {
      to_nan(numbers);
    }
  });
  try {
    (void)build_one("linear", true);
    FAIL() << "a database without a response was written";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("linear press"), std::string::npos)
        << error.what();
  }
  EXPECT_FALSE(fs::exists(folder_ / "out.h5"));
}

// A unit of an older version, or of a disk that lied: whole by its SHA-256, and wrong.
void spoil_unit(const fs::path& file, std::int32_t vertex) {
  constexpr std::size_t kDigest = 64;
  const std::string kept = bytes_of(file);
  WorkUnitOutcome outcome =
      unit_from_bytes(std::as_bytes(std::span(kept)).subspan(kDigest), file.string());
  for (WorkUnitNode& node : outcome.node) {
    if (node.vertex == vertex) {
      node.response.direction[1] = kNaN;
    }
  }
  const std::vector<std::byte> body = to_bytes(outcome);
  Sha256 sum;
  sum.update(body);
  std::ofstream out(file, std::ios::binary);
  out << sum.hex();
  out.write(reinterpret_cast<const char*>(body.data()),
            static_cast<std::streamsize>(body.size()));
}

TEST_F(BuildFaults, ABadUnitOfACheckpointIsComputedAgain) {
  verify_ = 1;  // a second unit, of a place between vertices
  const BuildReport whole = build_one("linear", true);
  const std::string bytes = bytes_of(folder_ / "out.h5");
  fs::remove(folder_ / "out.h5");
  set_fault_maker([&](FaultPlace at, std::int32_t vertex, std::span<double>) {
    if (at == FaultPlace::kWorker && vertex >= whole.nodes) {  // the check's place
      throw Interrupted();
    }
  });
  EXPECT_THROW((void)build_one("linear", true), Interrupted);
  set_fault_maker({});
  const fs::path unit = folder_ / "out.h5.partial" / "unit-000000";
  ASSERT_TRUE(fs::exists(unit));
  spoil_unit(unit, vertex_of(whole, ResponseOrigin::kSimulated));
  const BuildReport again = build_one("linear", true, true);
  EXPECT_EQ(again.resumed, 0);
  EXPECT_EQ(again.assembly.failed, 0);
  EXPECT_TRUE(bytes_of(folder_ / "out.h5") == bytes);
}

}  // namespace
}  // namespace palpate
