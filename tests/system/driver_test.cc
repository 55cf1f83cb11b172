// Devices behind drivers, by the tool that a user runs: the examples for drivers of
// other programs, Haply's service in emulation, and what is said where none answers.
#include <cstdio>
#include <memory>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <poll.h>

#include "formats/base/json_text.h"
#include "formats/database/response_database.h"
#include "runtime/device/socket_device.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/run_tool.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class DeviceTool : public testing::Test {
 protected:
  void SetUp() override {
    write_database(body(), sample_database(
                               sphere_surface(0.04, 2), ball(0.005, 0.3, 5e-4),
                               [](Eigen::Index, double d) {
                                 return 100.0 * d * (0.5 + 50.0 * d);
                               },
                               0.005));
  }

  [[nodiscard]] std::string body() const { return (folder_ / "body.h5").string(); }

  [[nodiscard]] ToolRun render(const std::string& device,
                               std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"device", "--device", device, "--limit-stiffness",
                               "--seconds", "2", "--json", body()});
    return run_tool_process("palpate-run", more);
  }

  // A driver that listens on a socket, and what it prints at its end. An ordinary
  // process may wait for longer than a device may be silent: then once more.
  std::string served(const std::string& driver) {
    const std::string socket = (folder_ / "device").string();
    ToolRun run;
    std::array<char, 200> text{};
    std::size_t size = 0;
    for (int i = 0; i < 4 && run.exit_code != 0; ++i) {
      fs::remove(socket);  // of the driver before
      FILE* pipe = ::popen((driver + " " + socket + " 0 0 0.047").c_str(), "r");
      for (int k = 0; k < 1000 && !fs::exists(socket); ++k) {
        ::poll(nullptr, 0, 5);
      }
      ::poll(nullptr, 0, 50);  // it listens after the file is there
      run = render(socket);
      size = std::fread(text.data(), 1, text.size(), pipe);
      EXPECT_EQ(::pclose(pipe), 0);
    }
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const auto report = parse_json(run.out);
    EXPECT_TRUE(report.is_object() && report.value("contact_ticks", 0) > 100)
        << run.out;
    EXPECT_TRUE(report.value("device_turns", false));
    return {text.data(), size};
  }

  ScratchFolder folder_;
};

double first_number(const std::string& text) {
  double number = 0.0;
  EXPECT_EQ(std::sscanf(text.c_str(), "largest force %lf N", &number), 1) << text;
  return number;
}

TEST_F(DeviceTool, RendersOnTheExampleDriversOfOtherPrograms) {
  const fs::path bin = fs::read_symlink("/proc/self/exe").parent_path();
  for (const std::string& driver :
       {(bin / "c_driver").string(),
        std::string("python3 runtime/device/examples/driver.py")}) {
    const std::string said = served(driver);
    EXPECT_GT(first_number(said), 0.05) << driver;
    EXPECT_NE(said.find("last 0.000 N"), std::string::npos) << said;
  }
}

TEST_F(DeviceTool, RendersOnTheEmulatedInverseService) {
  const ToolRun run = render("emulated-inverse");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("force gate with gain 0.3"), std::string::npos) << run.err;
  const auto report = parse_json(run.out);
  EXPECT_GT(report.value("contact_ticks", 0), 100) << run.out;
}

// Probed, printed, and rendered by what was found.
TEST_F(DeviceTool, WritesWhatAProbeFindsAndRendersByIt) {
  const std::string file = (folder_ / "device.json").string();
  const auto probe = [&](const std::string& axes) {
    return run_tool_process("palpate-run", {"device", "--device", "emulated-inverse3",
                                            "--probe", file, "--probe-axes", axes});
  };
  EXPECT_EQ(probe("xx").exit_code, 2);
  const ToolRun run = probe("x");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("do not touch it: it is pushed to and fro along x"),
            std::string::npos)
      << run.err;
  const ToolRun printed = run_tool_process("palpate-run", {"probe", file, "--json"});
  const auto found = parse_json(printed.out);
  EXPECT_NEAR(found.value("/axes/0/mass_kg"_json_pointer, 0.0), 0.12, 0.012);
  EXPECT_EQ(found.value("device", ""), "emulated-inverse3");
  const ToolRun told = run_tool_process("palpate-run", {"probe", file});
  EXPECT_EQ(told.out.find(run.out), 0U) << told.out;
  EXPECT_NE(told.out.find("at 1000 Hz it holds a stiffness of"), std::string::npos);

  // The bound is then that of its damping and delay, not of the driver's assumption.
  const auto bound = [&](const std::vector<std::string>& more) {
    const ToolRun rendered = render("emulated-inverse3", more);
    EXPECT_EQ(rendered.exit_code, 0) << rendered.err;
    return parse_json(rendered.out).value("delay_bound_n_per_m", 0.0);
  };
  const double damping =
      found.value("/axes/0/damping_n_s_per_m"_json_pointer, 0.0) -
      2.0 * found.value("/axes/0/damping_sd_n_s_per_m"_json_pointer, 0.0);
  const double delay_s = found.value("/axes/0/delay_s"_json_pointer, 0.0) +
                         found.value("/axes/0/delay_resolution_s"_json_pointer, 0.0);
  EXPECT_NEAR(bound({"--probed", file}), damping / (0.5e-3 + delay_s), 1e-6 * damping);
  EXPECT_EQ(render("emulated-inverse", {"--probed", file}).exit_code, 2);
  EXPECT_EQ(render("emulated-inverse3", {"--probed", body()}).exit_code, 3);
  EXPECT_EQ(run_tool_process("palpate-run", {"device", "--device", "emulated-inverse3"})
                .exit_code,
            2);
}

TEST_F(DeviceTool, SaysWhereNoneAnswers) {
  const ToolRun closed = render("haply-inverse:1");
  EXPECT_EQ(closed.exit_code, 5);
  EXPECT_NE(closed.err.find("no Inverse service at 127.0.0.1:1"), std::string::npos)
      << closed.err;
  EXPECT_EQ(render("haply-inverse:99999").exit_code, 2);
  EXPECT_EQ(render("haply-inverse", {"--profile", "a b"}).exit_code, 2);
  EXPECT_EQ(render("haply-inverse", {"--usb", "1:2"}).exit_code, 2);
  EXPECT_EQ(render("/nowhere/at/all").exit_code, 5);
}

}  // namespace
}  // namespace palpate
