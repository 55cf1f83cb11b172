// The driver, and the tools as users run them, with libusb as it is, on a bus of
// umockdev's.
#include "tests/umockdev/usb_bus.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "formats/database/response_database.h"
#include "runtime/attach/usb_choice.h"
#include "runtime/emulation/emulated_haply.h"
#include "tests/support/held_falcon.h"
#include "tests/support/run_tool.h"
#include "tests/support/sample_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

struct Falcon {
  FalconModel model;
  FtdiChip chip{model, kFalconIdentity, {}};

  explicit Falcon(const FalconModelConfig& config) : model(config) {}
  UsbSocket& plug(UsbBus& bus, const UsbPlace& place) {
    return bus.plug(chip, chip.descriptors(), place);
  }
};

// An Arduino Due's native port, with its interface of the abstract control model.
std::vector<std::uint8_t> board_descriptors() {
  return {18,   1,    0x00, 0x02, 2,  0,  0,  64,   0x41,
          0x23, 0x3E, 0,    0,    1,  0,  0,  0,    1,   //
          9,    2,    55,   0,    2,  1,  0,  0xC0, 50,  //
          9,    4,    0,    0,    1,  2,  2,  1,    0,   //
          7,    5,    0x82, 3,    8,  0,  16,            //
          9,    4,    1,    0,    2,  10, 0,  0,    0,   //
          7,    5,    0x83, 2,    64, 0,  0,             //
          7,    5,    0x02, 2,    64, 0,  0};
}

class UsbBusTest : public testing::Test {
 protected:
  void SetUp() override {
    bus_ = std::make_unique<UsbBus>();
    if (!bus_->seen()) {
      GTEST_SKIP() << "not under umockdev: run it by ctest, or by umockdev-wrapper";
    }
  }
  [[nodiscard]] UsbBus& bus() { return *bus_; }

 private:
  std::unique_ptr<UsbBus> bus_;
};

bool is_falcon(const UsbDevice& device) {
  return !haptic_device_name(device.vendor, device.product).empty();
}

std::string refusal(const std::string& where) {
  try {
    static_cast<void>(
        choose_usb_device(find_usb_devices(), "falcon", where, is_falcon));
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "";
}

TEST_F(UsbBusTest, TheToolListsAFalconAndABoard) {
  Falcon falcon(held_falcon());
  HaplyModel haply({});
  falcon.plug(bus(), {.port = 2, .address = 9});
  bus().plug(haply, board_descriptors(), {.port = 4, .address = 11});
  const ToolRun run = run_tool_process("palpate-run", {"devices"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const char* line :
       {"0403:cb48 bus 1 address 9: Novint Falcon: ready\n",
        "2341:003e bus 1 address 11: serial board, may be a Haply (its numbers do "
        "not tell): ready\n"}) {
    EXPECT_NE(run.out.find(line), std::string::npos) << run.out;
  }
}

TEST_F(UsbBusTest, OfTwoAlikeOneIsChosenByItsPort) {
  Falcon left(held_falcon());
  Falcon right(held_falcon());
  left.plug(bus(), {.port = 2, .address = 9});
  UsbSocket& socket = right.plug(bus(), {.port = 3, .address = 4});
  EXPECT_NE(refusal("").find("2 are attached"), std::string::npos) << refusal("");
  EXPECT_EQ(choose_usb_device(find_usb_devices(), "falcon", "1-3", is_falcon).address,
            4);
  bus().unplug(socket);
  EXPECT_EQ(refusal(""), "");
  EXPECT_NE(refusal("1-3").find("none is attached at 1-3 (2 USB devices seen; "
                                "elsewhere: 1:9, port 1-2"),
            std::string::npos)
      << refusal("1-3");
}

// Root may open everything: looks as somebody else.
TEST_F(UsbBusTest, ANodeThatMayNotBeOpenedIsSaidToBe) {
  Falcon falcon(held_falcon());
  const UsbSocket& socket = falcon.plug(bus(), {});
  const std::string node = bus().root() + socket.node();
  const bool root = ::geteuid() == 0;
  ASSERT_EQ(::chmod(node.c_str(), 0), 0);
  ASSERT_EQ(::chmod(bus().root().c_str(), 0777), 0);  // sockets of its own
  for (const auto& at :
       std::filesystem::recursive_directory_iterator(bus().root() + "/ioctl")) {
    std::filesystem::permissions(at, std::filesystem::perms::all);
  }
  ASSERT_TRUE(!root || ::seteuid(65534) == 0);
  const std::string text = describe(find_usb_devices());
  const std::string why = refusal("");
  ASSERT_TRUE(!root || ::seteuid(0) == 0);
  EXPECT_NE(text.find("no permission; allow it by a udev rule"), std::string::npos)
      << text;
  EXPECT_NE(why.find("no permission to open it (1:2, port 1-1)"), std::string::npos)
      << why;
}

std::function<int()> opener(const UsbSocket& socket) {
  return [node = socket.node()] {
    return ::open(node.c_str(), O_RDWR | O_CLOEXEC);
  };
}

void close_file(int file) {
  ::close(file);
}

std::unique_ptr<FalconLink> link_to(const UsbSocket& socket,
                                    const FalconConfig& config = patient_driver()) {
  return std::make_unique<FalconLink>(config, opener(socket), close_file);
}

std::array<std::int16_t, 3> motors(const UsbSocket& socket, const Falcon& falcon) {
  return socket.locked([&] {
    return falcon.model.command().motor;
  });
}

TEST_F(UsbBusTest, AFalconBootsLoadsHomesRendersAndIsLeftAsItWasFound) {
  Falcon falcon(held_falcon());
  const UsbSocket& socket = falcon.plug(bus(), {});
  const auto link = link_to(socket);
  link->open();
  EXPECT_FALSE(socket.kernel_driver());
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  int answered = 0;
  for (int i = 0; i < 300; ++i) {
    const LinkStatus status = link->transact({0.0, 0.0, 1.0}, position);
    ASSERT_NE(status, LinkStatus::kLost) << link->failure();
    answered += status == LinkStatus::kOk ? 1 : 0;
  }
  EXPECT_GE(answered, 250);
  EXPECT_NEAR(position.z(), held_falcon().start_m.z(), 0.02);
  EXPECT_NE(motors(socket, falcon), (std::array<std::int16_t, 3>{}));
  link->close();
  EXPECT_EQ(motors(socket, falcon), (std::array<std::int16_t, 3>{}));
  EXPECT_TRUE(socket.kernel_driver());
  EXPECT_FALSE(falcon.model.driven_unhomed());
}

TEST_F(UsbBusTest, AFalconThatIsUnpluggedIsALossWithAName) {
  FalconModelConfig config = held_falcon();
  config.loaded = true;
  Falcon falcon(config);
  UsbSocket& socket = falcon.plug(bus(), {});
  const auto link = link_to(socket);
  link->open();
  Eigen::Vector3d position;
  for (int i = 0; i < 50; ++i) {
    ASSERT_NE(link->transact({0.0, 0.0, 1.0}, position), LinkStatus::kLost);
  }
  bus().unplug(socket);
  LinkStatus status = LinkStatus::kOk;
  for (int i = 0; i < 20 && status != LinkStatus::kLost; ++i) {
    status = link->transact({0.0, 0.0, 1.0}, position);
  }
  EXPECT_EQ(status, LinkStatus::kLost);
  EXPECT_EQ(link->failure(), "unplugged, or its wire is broken");
  link->close();
  EXPECT_NE(refusal("").find("none is attached"), std::string::npos);
}

TEST_F(UsbBusTest, ABoardTakesTorquesAndIsLeftWithoutOne) {
  HaplyModelConfig config;
  config.hand.surface_m = config.start_m;
  HaplyModel haply(config);
  const UsbSocket& socket = bus().plug(haply, board_descriptors(), {});
  HaplyConfig driver;
  driver.answer_s = 0.05;
  HaplyLink link(driver, opener(socket), close_file);
  link.open();
  EXPECT_FALSE(socket.kernel_driver());
  Eigen::Vector3d position;
  int answered = 0;
  for (int i = 0; i < 100; ++i) {
    answered += link.transact({0.0, 0.5, 0.0}, position) == LinkStatus::kOk ? 1 : 0;
  }
  EXPECT_GE(answered, 80);
  const auto torque = [&] {
    return socket.locked([&] {
      return haply.torque_nm();
    });
  };
  EXPECT_NE(torque(), (std::array<double, 2>{}));
  link.close();
  EXPECT_EQ(torque(), (std::array<double, 2>{}));
  EXPECT_TRUE(socket.kernel_driver());
}

// Pushes, and is killed with the motors driven, between two exchanges: a request that
// is cut short would leave half of it in umockdev's connection.
[[noreturn]] void push_and_be_killed(const UsbSocket& socket) {
  try {
    FalconConfig config = patient_driver();
    config.guarded = true;
    const auto link = link_to(socket, config);
    link->open();
    Eigen::Vector3d position;
    for (int i = 0; i < 100; ++i) {
      static_cast<void>(link->transact({0.0, 0.0, 1.0}, position));
    }
    ::kill(::getpid(), SIGKILL);
  } catch (const DeviceError& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  ::_exit(1);
}

TEST_F(UsbBusTest, AfterAKillTheGuardianTakesTheForceAndGivesTheFalconBack) {
  FalconModelConfig config = held_falcon();
  config.loaded = true;
  config.trace_max = 10'000;
  Falcon falcon(config);
  const UsbSocket& socket = falcon.plug(bus(), {});
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    push_and_be_killed(socket);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status;
  for (int i = 0; i < 5000 && !socket.kernel_driver(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(socket.kernel_driver());  // only the guardian's last act gives it back
  const std::vector<MotorRecord> trace = socket.locked([&] {
    return falcon.model.trace();
  });
  const auto driven = std::count_if(trace.begin(), trace.end(), [](const auto& record) {
    return record.force_n > 0.0;
  });
  EXPECT_GT(driven, 50);
  EXPECT_EQ(trace.back().force_n, 0.0);
  EXPECT_EQ(falcon.model.command().leds, 0);
}

// A tool that renders a soft plate.
class RenderingTool : public UsbBusTest {
 protected:
  void SetUp() override {
    UsbBusTest::SetUp();
    write_database(database_, sample_database(
                                  plate(0.1, 4), ball(0.005, 0.0, 1e-4),
                                  [](Eigen::Index, double depth_m) {
                                    return 100.0 * depth_m;
                                  },
                                  0.02));
    std::ofstream(firmware_, std::ios::binary) << kEmulatedFirmware;
  }

  // Until it ends, or until `now`.
  [[nodiscard]] ToolRun render(const std::function<bool()>& now) const {
    return kill_tool_process(
        "palpate-run",
        {"device", "--device", "falcon", "--firmware", firmware_, "--homing-s", "20",
         "--seconds", "10", "--limit-stiffness", database_},
        now);
  }

  [[nodiscard]] static bool renders(const UsbSocket& socket, const Falcon& falcon) {
    return socket.locked([&] {
      return falcon.model.homed() && falcon.model.commands() > 500;
    });
  }

 private:
  ScratchFolder folder_;
  std::string database_ = (folder_ / "plate.h5").string();
  std::string firmware_ = (folder_ / "image.bin").string();
};

TEST_F(RenderingTool, EndsWithANameWhenTheFalconIsUnplugged) {
  Falcon falcon(held_falcon());
  UsbSocket& socket = falcon.plug(bus(), {});
  bool unplugged = false;
  const ToolRun run = render([&] {
    if (!unplugged && renders(socket, falcon)) {
      unplugged = true;
      bus().unplug(socket);
    }
    return false;
  });
  EXPECT_TRUE(unplugged);
  EXPECT_EQ(run.exit_code, 5) << run.err << run.out;
  EXPECT_NE(run.err.find("unplugged"), std::string::npos) << run.err;
  EXPECT_FALSE(falcon.model.driven_unhomed());
}

}  // namespace
}  // namespace palpate

// A guardian closes all files but its own two, and with them umockdev's connection,
// through which alone the device can be reached here.
extern "C" int close_range(unsigned /*first*/, unsigned /*last*/,
                           int /*flags*/) noexcept {
  return 0;
}
