// A streamed body gives what the whole one gives, within its memory, or says that it
// does not.
#include "runtime/slow/file_elements.h"

#include <cstring>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/slow/memory_elements.h"
#include "tests/runtime/slow/drained_fifo.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

constexpr double kRadius = 0.05;

double wavy(Eigen::Index node, double d) {
  return (100.0 + static_cast<double>(node % 17)) * d;
}

ResponseDatabase sphere_body(Precision precision, int samples) {
  ResponseDatabase database = sample_database(
      sphere_surface(kRadius, 5), ball(0.005, 0.3, 5e-4), wavy, 0.01, samples);
  database.storage = {.precision = precision, .chunk_nodes = 64};
  return database;
}

void expect_equal(const ElementNode& a, const ElementNode& b) {
  EXPECT_EQ(a.node, b.node);
  ASSERT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.position_m, b.position_m);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.touch_offset_m, b.touch_offset_m);
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.presliding_m, b.presliding_m);
  EXPECT_EQ(a.depth_m, b.depth_m);
  EXPECT_EQ(a.force_n, b.force_n);
  EXPECT_EQ(a.stiffness_n_per_m, b.stiffness_n_per_m);
  EXPECT_EQ(a.energy_j, b.energy_j);
}

// A tool that wanders over a sphere, in and out of it.
class Walk {
 public:
  ToolState next() {
    std::normal_distribution<double> normal;
    heading_ +=
        0.3 * Eigen::Vector3d(normal(random_), normal(random_), normal(random_));
    heading_.normalize();
    at_ = (at_ + 0.05 * heading_).normalized();
    state_.sequence += 1;
    state_.time_ns += 10'000'000;
    state_.in_contact = state_.sequence % 50 > 10;
    state_.position_m = at_ * (kRadius + (state_.in_contact ? 0.003 : 0.012));
    return state_;
  }
  void enter(std::int32_t triangle) { state_.triangle = triangle; }

 private:
  std::mt19937 random_{42};
  Eigen::Vector3d heading_ = Eigen::Vector3d::UnitX();
  Eigen::Vector3d at_ = Eigen::Vector3d::UnitZ();
  ToolState state_;
};

class StreamedSphere : public testing::Test {
 protected:
  void write(Precision precision, int samples) {
    write_database(file_, sphere_body(precision, samples));
    options_.budget_bytes = 3 * least_budget(read_index(file_), {});
  }
  // Walks, compares what both send; counts of what was streamed.
  StreamReport compare_on_a_walk(int steps) {
    const ResponseDatabase whole = read_database(file_);
    const ElementStream stream(whole, whole.tools[0], options_.force_scale);
    Walk walk;
    StreamedElements streamed(file_, options_, {0, 0, kRadius}, false);
    for (int i = 0; i < steps; ++i) {
      const ToolState tool = walk.next();
      streamed.update(tool, i, *fifo_);
      const std::vector<Element> sent = drain(*fifo_);
      if (!sent.empty()) {
        walk.enter(sent.front().triangle);
        EXPECT_NEAR(distance(stream.search(), whole, sent.front(), tool),
                    stream.search().nearest(tool.position_m).distance_m, 1e-15);
      }
      for (const Element& element : sent) {
        const Element expected = stream.element(element.triangle);
        EXPECT_EQ(element.neighbour, expected.neighbour);
        for (std::size_t j = 0; j < 3; ++j) {
          expect_equal(element.node[j], expected.node[j]);
        }
      }
      streamed_bytes_max_ =
          std::max(streamed_bytes_max_, streamed.report().cache.bytes);
    }
    return streamed.report();
  }

  static double distance(const SurfaceSearch&, const ResponseDatabase& whole,
                         const Element& element, const ToolState& tool) {
    Eigen::Matrix3d corner;
    for (Eigen::Index j = 0; j < 3; ++j) {
      corner.row(j) =
          whole.body.position_m.row(whole.body.triangle(element.triangle, j));
    }
    return nearest_in_triangle(corner, tool.position_m).distance_m;
  }

  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_ / "sphere.h5";
  const std::unique_ptr<ElementFifo> fifo_ = std::make_unique<ElementFifo>();
  CacheOptions options_;
  std::size_t streamed_bytes_max_ = 0;
};

TEST_F(StreamedSphere, GivesBitForBitWhatTheWholeBodyGivesAlongARandomWalk) {
  write(Precision::kFloat64, 21);
  const StreamReport report = compare_on_a_walk(1500);
  EXPECT_EQ(report.updates, 1500);
  EXPECT_EQ(report.starved, 0);
  EXPECT_EQ(report.fault, "");
  EXPECT_GT(report.cache.loaded, read_index(file_).chunks());
  EXPECT_GT(report.cache.evicted, 0);
}

TEST_F(StreamedSphere, GivesTheSameFromRoundedAndThinnedAndScaledCurves) {
  write(Precision::kFloat32, 70);
  options_.force_scale = 0.37;
  const StreamReport report = compare_on_a_walk(100);
  EXPECT_EQ(report.starved, 0);
  EXPECT_GT(report.cache.loss.nodes, 0);
}

TEST_F(StreamedSphere, NeverExceedsItsBudget) {
  write(Precision::kFloat64, 21);
  for (const double share : {1.0, 1.3, 3.0}) {
    const std::size_t least = least_budget(read_index(file_), {});
    options_.budget_bytes =
        static_cast<std::size_t>(share * static_cast<double>(least));
    const StreamReport report = compare_on_a_walk(200);
    EXPECT_LE(report.cache.bytes_max, options_.budget_bytes);
    EXPECT_LE(streamed_bytes_max_, options_.budget_bytes);
    EXPECT_GT(report.cache.bytes_max, 0U);
  }
}

TEST_F(StreamedSphere, RefusesABudgetBelowOneNeighbourhoodInOneSentence) {
  write(Precision::kFloat64, 21);
  options_.budget_bytes = least_budget(read_index(file_), {}) - 1;
  try {
    const StreamedElements streamed(file_, options_, {0, 0, kRadius}, false);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("does not hold a neighbourhood"), std::string::npos) << what;
    EXPECT_NE(what.find("sphere.h5"), std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos);
  }
  options_.budget_bytes += 1;
  EXPECT_NO_THROW(StreamedElements(file_, options_, {0, 0, kRadius}, false));
}

TEST_F(StreamedSphere, CountsStarvedUpdatesAndSendsNothingForThem) {
  write(Precision::kFloat64, 21);
  StreamedElements streamed(file_, options_, {0, 0, kRadius}, false);
  ToolState tool{.sequence = 1, .position_m = {0, 0, 1.1 * kRadius}};
  EXPECT_GT(streamed.update(tool, 0, *fifo_), 9U);
  drain(*fifo_);
  streamed.stop();  // what is on the other side is never loaded
  tool.position_m = {0, 0, -1.1 * kRadius};
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(streamed.update(tool, i, *fifo_), 0U);
  }
  EXPECT_TRUE(drain(*fifo_).empty());
  EXPECT_EQ(streamed.report().starved, 5);
  EXPECT_EQ(streamed.report().updates, 6);
  tool.position_m.x() = std::nan("");
  EXPECT_EQ(streamed.update(tool, 9, *fifo_), 0U);
  EXPECT_EQ(streamed.report().updates, 6);
}

TEST_F(StreamedSphere, FindsTheSurfaceAgainAfterTheToolOutranIt) {
  write(Precision::kFloat64, 21);
  StreamedElements streamed(file_, options_, {0, 0, kRadius}, false);
  ToolState tool{.sequence = 1, .position_m = {0, 0, 1.1 * kRadius}};
  streamed.update(tool, 0, *fifo_);
  tool.triangle = drain(*fifo_).front().triangle;
  tool.in_contact = true;
  tool.position_m = {0, 0, -1.1 * kRadius};  // the triangle in use is given up
  EXPECT_GT(streamed.update(tool, 1, *fifo_), 9U);
  EXPECT_EQ(streamed.report().starved, 1);
  tool.triangle = drain(*fifo_).front().triangle;
  EXPECT_GT(streamed.update(tool, 2, *fifo_), 9U);
  EXPECT_EQ(streamed.report().starved, 1);
}

TEST_F(StreamedSphere, NamesADamagedChunkAndLeavesTheElementAlone) {
  write(Precision::kFloat64, 21);
  // Damages the forces of a chunk in place.
  const DatabaseIndex index = read_index(file_);
  const std::int64_t chunk = index.chunks() / 2;
  const ResponseTable part = ChunkReader(file_).responses(0, chunk);
  const Eigen::Vector3d place =
      ChunkReader(file_).body(chunk).position_m.row(20).transpose();
  std::fstream bytes(file_, std::ios::in | std::ios::out | std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(bytes)), {});
  const std::string pattern(reinterpret_cast<const char*>(part.force_n.data()),
                            part.force_n.size() * sizeof(double));
  const std::size_t at = all.find(pattern);
  ASSERT_NE(at, std::string::npos);
  const double wrong = 0.5 * part.force_n[5];
  bytes.seekp(static_cast<std::streamoff>(at + 5 * sizeof(double)));
  bytes.write(reinterpret_cast<const char*>(&wrong), sizeof wrong);
  bytes.close();

  StreamedElements streamed(file_, options_, -place, false);
  ToolState tool{.sequence = 1, .position_m = -1.1 * place};
  EXPECT_GT(streamed.update(tool, 0, *fifo_), 9U);
  EXPECT_FALSE(streamed.is_damaged());
  drain(*fifo_);
  tool.position_m = 1.1 * place;
  EXPECT_EQ(streamed.update(tool, 1, *fifo_), 0U);
  EXPECT_TRUE(drain(*fifo_).empty());
  EXPECT_TRUE(streamed.is_damaged());
  EXPECT_EQ(streamed.report().starved, 1);
  EXPECT_EQ(streamed.report().fault.rfind("damaged-chunk: ", 0), 0U);
  EXPECT_NE(streamed.report().fault.find("SHA-256"), std::string::npos);
  tool.position_m = -1.1 * place;
  EXPECT_GT(streamed.update(tool, 2, *fifo_), 9U) << "what is whole goes on";
}

TEST_F(StreamedSphere, SendsOnlyWhatTheWholeBodyGivesWhileItsThreadLoads) {
  write(Precision::kFloat64, 21);
  const ResponseDatabase whole = read_database(file_);
  const ElementStream stream(whole, whole.tools[0]);
  StreamedElements streamed(file_, options_, {0, 0, kRadius}, true);
  Walk walk;
  std::int64_t sent_updates = 0;
  for (int i = 0; i < 2000; ++i) {
    streamed.update(walk.next(), i, *fifo_);
    const std::vector<Element> sent = drain(*fifo_);
    sent_updates += sent.empty() ? 0 : 1;
    for (const Element& element : sent) {
      const Element expected = stream.element(element.triangle);
      EXPECT_EQ(element.neighbour, expected.neighbour);
      EXPECT_EQ(element.node[0].force_n, expected.node[0].force_n);
    }
    if (!sent.empty()) {
      walk.enter(sent.front().triangle);
    }
    std::this_thread::yield();
  }
  streamed.stop();
  const StreamReport report = streamed.report();
  EXPECT_EQ(report.updates, 2000);
  EXPECT_GE(report.starved, 2000 - sent_updates);
  EXPECT_GT(sent_updates, 0);
  EXPECT_LE(report.cache.bytes_max, options_.budget_bytes);
}

}  // namespace
}  // namespace palpate
