#include "formats/recording/surface_state.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <span>

#include <gtest/gtest.h>

#include "formats/recording/recording.h"
#include "formats/recording/recording_writer.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/said.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

SurfaceState state() {
  return {.writer = "palpate-run 0.1.0",
          .database = "organ.h5",
          .database_sha256 = std::string(64, 'a'),
          .tool = {{"ball", {.yielded = {{0, 0.001, 0.003}, {7, 0.0, 0.002}}}},
                   {"a tip", {.yielded = {{2'000'000'000, 1.0 / 3.0, 0.0}}}},
                   {"unused", {}}}};
}

ChannelRow channel(double x_m, double depth_m) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {.entry_m = {x_m, 1.0 / 3.0, -0.02},
          .axis = {0.6, 0.0, 0.8},
          .depth_m = depth_m,
          .layer = 1,
          .layer_depth_m = {0.0, 0.002, 0.01, kNone, kNone, kNone},
          .layer_material = {2, 0, 7, -1, -1, -1}};
}

SurfaceState punctured() {
  SurfaceState with = state();
  with.tool["ball"].channels = {channel(0.1, 0.005), channel(0.2, 0.004)};
  with.tool["a needle"].channels = {channel(0.3, 0.0)};
  return with;
}

TEST(SurfaceStateFile, ReadsWhatWasWritten) {
  const ScratchFolder folder;
  write_surface_state(folder / "s.h5", state());
  const SurfaceState read = read_surface_state(folder / "s.h5");
  EXPECT_EQ(read.writer, state().writer);
  EXPECT_EQ(read.database, state().database);
  EXPECT_EQ(read.tool, state().tool);
  EXPECT_EQ(read_surface_state(folder / "s.h5", std::string(64, 'a'), "organ.h5").tool,
            state().tool);
}

TEST(SurfaceStateFile, ReadsTheChannelsThatWereWritten) {
  const ScratchFolder folder;
  write_surface_state(folder / "s.h5", punctured());
  EXPECT_EQ(read_surface_state(folder / "s.h5").tool, punctured().tool);
  EXPECT_NE(punctured().tool, state().tool);
}

TEST(SurfaceStateFile, OfAnotherBodyIsRefusedByName) {
  const ScratchFolder folder;
  write_surface_state(folder / "s.h5", state());
  const std::string said = refusal([&] {
    (void)read_surface_state(folder / "s.h5", std::string(64, 'b'), "liver.h5");
  });
  EXPECT_NE(said.find("is the surface of another body, organ.h5 (aaaaaaaaaaaa...), "
                      "must be of liver.h5 (bbbbbbbbbbbb...)"),
            std::string::npos)
      << said;
}

TEST(SurfaceStateFile, BrokenRowsAreRefused) {
  const ScratchFolder folder;
  const auto said = [&](const YieldedRow& row) {
    SurfaceState broken = state();
    broken.tool["ball"].yielded.push_back(row);
    write_surface_state(folder / "s.h5", broken);
    return refusal([&] {
      (void)read_surface_state(folder / "s.h5");
    });
  };
  EXPECT_NE(said({7, 0.1, 0.1}).find("/tools/ball/site has 7 after 7"),
            std::string::npos);
  EXPECT_NE(said({8, -0.1, 0.1}).find("site 8 has a depth of -0.1 m"),
            std::string::npos);
  EXPECT_NE(said({8, 0.1, std::nan("")}).find("site 8 has a depth of nan m"),
            std::string::npos);
}

// Rows of tables by name, and back: two hands' tables of one name are one there.
TEST(SurfaceState, IsThatOfEachTableOfResponses) {
  const std::vector<std::string> hands{"ball", "new", "ball"};
  const std::vector<YieldedRow> rows = surface_of(state(), hands).yielded;
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[1], (YieldedRow{7, 0.0, 0.002, 0}));
  EXPECT_EQ(rows[3], (YieldedRow{7, 0.0, 0.002, 2}));
  SurfaceState pressed = state();
  put_surface({.yielded = {{3, 0.5, 0.1, 0},
                           {7, 0.1, 0.3, 0},
                           {4, 0.2, 0.0, 1},
                           {7, 0.2, 0.1, 2}}},
              hands, pressed);
  EXPECT_EQ(pressed.tool["ball"].yielded,
            (std::vector<YieldedRow>{{3, 0.5, 0.1}, {7, 0.2, 0.3}}));
  EXPECT_EQ(pressed.tool["new"].yielded, (std::vector<YieldedRow>{{4, 0.2, 0.0}}));
  EXPECT_EQ(pressed.tool["a tip"], state().tool["a tip"]);
  put_surface({}, hands, pressed);
  EXPECT_TRUE(pressed.tool["ball"].empty());
}

// Both hands began with one channel; one went on, and cut another.
TEST(SurfaceState, OfOneChannelTheDeeperCounts) {
  const std::vector<std::string> hands{"ball", "ball"};
  const KeptSurface rows = surface_of(punctured(), hands);
  ASSERT_EQ(rows.channels.size(), 4U);
  EXPECT_EQ(rows.channels[3].table, 1);
  KeptSurface after = rows;
  after.channels[3].depth_m = 0.02;
  after.channels[3].layer = 2;
  after.channels.push_back(channel(0.4, 0.001));
  after.channels.back().table = 1;
  SurfaceState state = punctured();
  put_surface(after, hands, state);
  ChannelRow deeper = channel(0.2, 0.02);
  deeper.layer = 2;
  EXPECT_EQ(
      state.tool["ball"].channels,
      (std::vector<ChannelRow>{channel(0.1, 0.005), deeper, channel(0.4, 0.001)}));
  EXPECT_EQ(state.tool["a needle"], punctured().tool["a needle"]);
}

TEST(SurfaceStateFile, ForeignAndDamagedFilesAreRefused) {
  const ScratchFolder folder;
  const auto said = [&] {
    return refusal([&] {
      (void)read_surface_state(folder / "s.h5");
    });
  };
  EXPECT_NE(said(), "");  // missing
  std::ofstream(folder / "s.h5") << "text";
  EXPECT_NE(said(), "");
  write_surface_state(folder / "s.h5", state());
  std::string bytes = bytes_of(folder / "s.h5");
  // The 0.001 of the first dent, once.
  const double dent_m = 0.001;
  const std::string wanted(reinterpret_cast<const char*>(&dent_m), sizeof dent_m);
  const std::size_t at = bytes.find(wanted);
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  std::ofstream(folder / "s.h5", std::ios::binary) << bytes;
  EXPECT_NE(said().find("is damaged"), std::string::npos) << said();
}

TEST(SurfaceStateFile, ARecordingHoldsWhatTheSurfaceWas) {
  const ScratchFolder folder;
  RecordingHeader header{.writer = "palpate-run 0.1.0",
                         .database = "organ.h5",
                         .database_sha256 = std::string(64, 'a'),
                         .tool = "ball",
                         .model = "element",
                         .clock = "real",
                         .device = "simulated",
                         .fast_hz = 2000.0,
                         .slow_hz = 100.0};
  for (std::int32_t i = 0; i < 1500; ++i) {
    header.surface.yielded.push_back({2 * i, 1e-6 * i, 2e-6 * i});
  }
  header.surface.channels = punctured().tool["ball"].channels;
  RecordingWriter writer(folder / "a.h5", header);
  const TickRecord tick{};
  writer.append(std::span(&tick, 1));
  // As a crash leaves it, it is there as well.
  fs::copy(folder / "a.h5.partial", folder / "cut.h5");
  writer.finish({});
  EXPECT_EQ(read_recording(folder / "a.h5").header.surface, header.surface);
  EXPECT_EQ(read_recording(folder / "cut.h5").header.surface, header.surface);
  // Of several tables, each has its own sites.
  header.poses = 1.0;
  header.surface = {.yielded = {{4, 0.1, 0.2, 0}, {9, 0.0, 0.1, 0}, {4, 0.3, 0.0, 2}}};
  RecordingWriter several(folder / "b.h5", header);
  several.finish({});
  EXPECT_EQ(read_recording(folder / "b.h5").header.surface, header.surface);
  for (const YieldedRow& broken : {YieldedRow{4, 0.1, 0.1, 2}, {5, 0.1, 0.1, 1}}) {
    header.surface.yielded.push_back(broken);
    RecordingWriter other(folder / "c.h5", header);
    other.finish({});
    EXPECT_NE(refusal([&] {
                (void)read_recording(folder / "c.h5");
              }),
              "");
    header.surface.yielded.pop_back();
  }
}

}  // namespace
}  // namespace palpate
