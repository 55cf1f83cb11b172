// A driver in a process of its own between renderer and service: whoever of the three
// is killed, hangs or stops, the tool is let go.
#include <atomic>
#include <csignal>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/attach/device_choice.h"
#include "runtime/bench/cylinder_body.h"
#include "runtime/device/driven_device.h"
#include "runtime/inverse/emulated_inverse.h"
#include "runtime/realtime/clock.h"
#include "runtime/run/reconnect.h"
#include "tests/runtime/inverse/free_tool.h"

namespace palpate {
namespace {

// Forces stay until somebody ends them.
EmulatedInverseConfig patient_config() {
  EmulatedInverseConfig config = free_tool_config();
  config.idle_ns = 60'000'000'000;
  return config;
}

DriverProgram program(const EmulatedInverse& service) {
  const auto bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return {
      .name = "haply-inverse",
      .limits = {.force_max_n = 5.0},
      .command = {(bin / "palpate-run").string(), "driver", "--device",
                  "haply-inverse:" + std::to_string(service.port()), "--events-port",
                  std::to_string(service.events_port()), "--no-sign-test"}};
}

bool is_let_go(const EmulatedInverse& service) {
  return becomes([&] {
    return service.force_n() == Eigen::Vector3d::Zero();
  });
}

// Renders as a fast loop would, until `enough`. @returns how it ended.
DeviceStatus push_until(Device& device, const std::function<bool()>& enough) {
  MonotonicClock clock;
  const std::int64_t until_ns = clock.now_ns() + 5'000'000'000;
  while (!enough() && clock.now_ns() < until_ns) {
    DeviceReading reading;
    if (device.read(reading) == DeviceStatus::kLost ||
        device.write(kPush) == DeviceStatus::kLost) {
      return DeviceStatus::kLost;
    }
    clock.sleep_until_ns(clock.now_ns() + 1'000'000);
  }
  return DeviceStatus::kOk;
}

std::function<bool()> pushed(const EmulatedInverse& service) {
  return [&service] {
    return service.force_n() == kPush;
  };
}

TEST(DriverProcess, RendersAndLetsGoAtTheEnd) {
  EmulatedInverse service(patient_config());
  DrivenDevice device(program(service));
  for (int session = 0; session < 2; ++session) {
    device.open();
    ASSERT_EQ(push_until(device, pushed(service)), DeviceStatus::kOk);
    ASSERT_TRUE(pushed(service)());
    device.close();
    EXPECT_EQ(service.force_n(), Eigen::Vector3d::Zero());
    EXPECT_GE(device.wire()->transactions, 1);
    EXPECT_EQ(device.failure(), "");
  }
}

TEST(DriverProcess, SaysWhyItCannotOpenAndWhyItWasLost) {
  EmulatedInverseConfig wanted = patient_config();
  wanted.in_use = true;
  {
    EmulatedInverse service(wanted);
    DrivenDevice device(program(service));
    try {
      device.open();
      FAIL() << "opened";
    } catch (const DeviceError& error) {
      EXPECT_NE(std::string(error.what()).find("in use by another"), std::string::npos)
          << error.what();
    }
  }
  wanted.in_use = false;
  wanted.faults = {.fault = InverseFault::kUnplugged, .from = 200};
  EmulatedInverse service(wanted);
  DrivenDevice device(program(service));
  device.open();
  EXPECT_EQ(push_until(device,
                       [] {
                         return false;
                       }),
            DeviceStatus::kLost);
  EXPECT_NE(device.failure().find("unplugged"), std::string::npos) << device.failure();
  EXPECT_TRUE(is_let_go(service));
  DrivenDevice nowhere({.name = "x", .command = {"/nowhere/at/all"}});
  EXPECT_THROW(nowhere.open(), DeviceError);
}

TEST(DriverProcess, KilledLetsGo) {
  EmulatedInverse service(patient_config());
  DrivenDevice device(program(service));
  device.open();
  ASSERT_EQ(push_until(device, pushed(service)), DeviceStatus::kOk);
  ::kill(device.driver(), SIGKILL);
  EXPECT_TRUE(is_let_go(service));  // the kernel has closed the session
  EXPECT_EQ(push_until(device,
                       [] {
                         return false;
                       }),
            DeviceStatus::kLost);
  EXPECT_NE(device.failure().find("without a word"), std::string::npos);
}

// Its silence is a fault to the render loop, which then closes it.
TEST(DriverProcess, ThatHangsIsKilled) {
  EmulatedInverse service(patient_config());
  DrivenDevice device(program(service));
  device.open();
  ASSERT_EQ(push_until(device, pushed(service)), DeviceStatus::kOk);
  ::kill(device.driver(), SIGSTOP);
  DeviceReading reading;
  EXPECT_TRUE(becomes([&] {
    return device.read(reading) == DeviceStatus::kLate;
  }));
  device.close();
  EXPECT_EQ(device.driver(), -1);
  EXPECT_TRUE(is_let_go(service));
}

TEST(DriverProcess, ARendererThatFallsSilentLetsGo) {
  EmulatedInverse service(patient_config());
  DrivenDevice device(program(service));
  device.open();
  ASSERT_EQ(push_until(device, pushed(service)), DeviceStatus::kOk);
  EXPECT_TRUE(is_let_go(service));  // nobody writes
}

TEST(DriverProcess, ARendererThatIsKilledLetsGo) {
  EmulatedInverse service(patient_config());
  const pid_t renderer = ::fork();
  if (renderer == 0) {
    DrivenDevice device(program(service));
    device.open();
    static_cast<void>(push_until(device, [] {
      return false;
    }));
    ::_exit(0);
  }
  ASSERT_TRUE(becomes(pushed(service)));
  ::kill(renderer, SIGKILL);
  EXPECT_TRUE(is_let_go(service));
  ::waitpid(renderer, nullptr, 0);
}

TEST(DriverProcess, RendersOnOnceTheServiceIsBack) {
  EmulatedInverseConfig wanted = patient_config();
  auto service = std::make_unique<EmulatedInverse>(wanted);
  wanted.port = service->port();
  wanted.events_port = service->events_port();
  DeviceRequest request{.name = "haply-inverse:" + std::to_string(wanted.port)};
  request.events_port = wanted.events_port;
  request.driver_program = program(*service).command[0];
  request.sign_test = false;
  SimulationOptions options;
  options.duration_s = 1.5;
  options.fast_hz = 1000.0;
  options.real_time = true;
  options.limit_stiffness = true;
  options.attached = choose_device(request);
  std::thread restart([&] {
    EXPECT_TRUE(becomes([&] {
      return service->messages() > 300;
    }));
    service.reset();
    MonotonicClock clock;
    clock.sleep_until_ns(clock.now_ns() + 200'000'000);
    service = std::make_unique<EmulatedInverse>(wanted);
  });
  std::string told;
  const std::atomic<bool> stop = false;
  const auto runs = simulate_and_reconnect(cylinder_body({.friction = 0.0}), options,
                                           {.patience_s = 30.0,
                                            .look_s = 0.05,
                                            .tell =
                                                [&told](const std::string& text) {
                                                  told += text;
                                                }},
                                           stop);
  restart.join();
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].render.fault, Fault::kDeviceLost);
  EXPECT_EQ(runs[1].render.fault, Fault::kNone);
  EXPECT_NE(told.find("the service has stopped"), std::string::npos) << told;
  EXPECT_GT(runs[1].wire->transactions, 100);
}

}  // namespace
}  // namespace palpate
