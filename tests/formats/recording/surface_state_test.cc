#include "formats/recording/surface_state.h"

#include <cmath>
#include <fstream>
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
          .tool = {{"ball", {{0, 0.001, 0.003}, {7, 0.0, 0.002}}},
                   {"a tip", {{2'000'000'000, 1.0 / 3.0, 0.0}}},
                   {"unused", {}}}};
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
    broken.tool["ball"].push_back(row);
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
  const std::vector<YieldedRow> rows = surface_of(state(), hands);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[1], (YieldedRow{7, 0.0, 0.002, 0}));
  EXPECT_EQ(rows[3], (YieldedRow{7, 0.0, 0.002, 2}));
  SurfaceState pressed = state();
  put_surface({{3, 0.5, 0.1, 0}, {7, 0.1, 0.3, 0}, {4, 0.2, 0.0, 1}, {7, 0.2, 0.1, 2}},
              hands, pressed);
  EXPECT_EQ(pressed.tool["ball"],
            (std::vector<YieldedRow>{{3, 0.5, 0.1}, {7, 0.2, 0.3}}));
  EXPECT_EQ(pressed.tool["new"], (std::vector<YieldedRow>{{4, 0.2, 0.0}}));
  EXPECT_EQ(pressed.tool["a tip"], state().tool["a tip"]);
  put_surface({}, hands, pressed);
  EXPECT_TRUE(pressed.tool["ball"].empty());
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
    header.surface.push_back({2 * i, 1e-6 * i, 2e-6 * i});
  }
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
  header.surface = {{4, 0.1, 0.2, 0}, {9, 0.0, 0.1, 0}, {4, 0.3, 0.0, 2}};
  RecordingWriter several(folder / "b.h5", header);
  several.finish({});
  EXPECT_EQ(read_recording(folder / "b.h5").header.surface, header.surface);
  for (const YieldedRow& broken : {YieldedRow{4, 0.1, 0.1, 2}, {5, 0.1, 0.1, 1}}) {
    header.surface.push_back(broken);
    RecordingWriter other(folder / "c.h5", header);
    other.finish({});
    EXPECT_NE(refusal([&] {
                (void)read_recording(folder / "c.h5");
              }),
              "");
    header.surface.pop_back();
  }
}

}  // namespace
}  // namespace palpate
