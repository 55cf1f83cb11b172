// The driver of the Haply against its model, libusb between them.
#include "runtime/emulation/emulated_haply.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/device/threaded_device.h"

namespace palpate {
namespace {

HaplyModelConfig held() {
  HaplyModelConfig config;
  config.hand = {.surface_m = {0.0, 0.08, 0.0},
                 .normal = {0.0, 1.0, 0.0},
                 .press_m = 0.0,
                 .deeper_m = 0.0};
  config.start_m = config.hand.at(0.0).position_m;
  return config;
}

HaplyConfig haply_driver() {
  HaplyConfig config;
  config.answer_s = 0.05;  // a test machine may pause
  return config;
}

TEST(EmulatedHaply, IsSetUpRendersAndIsLeftWithoutTorque) {
  HaplyModelConfig config = held();
  config.split_bytes = 4;
  const auto haply = std::make_shared<EmulatedHaply>(config, UsbFaults{});
  const auto link = EmulatedHaply::link(haply, haply_driver());
  link->open();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  int answered = 0;
  for (int i = 0; i < 50; ++i) {
    answered += link->transact({0.0, 0.5, 9.0}, position) == LinkStatus::kOk ? 1 : 0;
  }
  EXPECT_GT(answered, 25);
  EXPECT_NEAR(position.x(), 0.0, 1e-3);
  EXPECT_NEAR(position.y(), 0.09, 0.02);
  EXPECT_EQ(position.z(), 0.0);
  link->close();
  EXPECT_EQ(haply->model().torque_nm(), (std::array<double, 2>{}));
  EXPECT_GT(haply->model().tool().rendered_work_j(), 0.0);  // it was pushed
  EXPECT_TRUE(haply->kernel_driver_back());
}

TEST(EmulatedHaply, UnpluggedAtAnyByteIsALossWithAName) {
  for (int byte = 1; byte <= 600; byte += 7) {  // 86 of them
    const auto haply = std::make_shared<EmulatedHaply>(
        held(), UsbFaults{.unplug_at_byte = byte, .unplug_is_io_error = byte % 2 == 0});
    const auto link = EmulatedHaply::link(haply, haply_driver());
    std::string why;
    try {
      link->open();
      Eigen::Vector3d position;
      for (int k = 0; k < 200 && why.empty(); ++k) {
        if (link->transact({0.1, 0.1, 0.0}, position) == LinkStatus::kLost) {
          why = link->failure();
        }
      }
    } catch (const DeviceError& error) {
      why = error.what();
    }
    EXPECT_FALSE(why.empty()) << byte;
  }
}

TEST(EmulatedHaply, ABoardThatDoesNotAnswerIsNotOpened) {
  HaplyConfig config = haply_driver();
  config.answer_s = 0.002;
  const auto link = EmulatedHaply::link(
      std::make_shared<EmulatedHaply>(held(), UsbFaults{.silent_from_byte = 0}),
      config);
  EXPECT_THROW(link->open(), DeviceError);
}

TEST(EmulatedHaply, AsksWhereTheArmsStandBeforeItsSetUpAtEveryOpen) {
  const auto haply = std::make_shared<EmulatedHaply>(held(), UsbFaults{});
  HaplyConfig config = haply_driver();
  int asked = 0;
  bool answers = true;
  config.ask = [&](const std::string& text) {
    ++asked;
    EXPECT_NE(text.find("against their stops"), std::string::npos) << text;
    EXPECT_EQ(haply->model().torque_nm(), (std::array<double, 2>{}));
    if (!answers) {
      throw DeviceError("nobody there");
    }
  };
  const auto link = EmulatedHaply::link(haply, config);
  link->open();
  link->open();  // as after a reconnection
  EXPECT_EQ(asked, 2);
  answers = false;
  EXPECT_THROW(link->open(), DeviceError);
  Eigen::Vector3d position;
  EXPECT_TRUE(haply->kernel_driver_back());
}

TEST(EmulatedHaply, SaysWhatItSendsWhereItsMotorsSaturate) {
  const auto haply = std::make_shared<EmulatedHaply>(held(), UsbFaults{});
  HaplyConfig config = haply_driver();
  config.force_max_n = 50.0;  // more than 0.123 N m give
  const auto link = EmulatedHaply::link(haply, config);
  link->open();
  Eigen::Vector3d position;
  for (int i = 0; i < 5; ++i) {
    ASSERT_NE(link->transact({0.0, 0.3, 0.0}, position), LinkStatus::kLost);
  }
  EXPECT_NEAR(link->sent_n().y(), 0.3, 1e-9);
  ASSERT_NE(link->transact({0.0, 40.0, 0.0}, position), LinkStatus::kLost);
  EXPECT_GT(link->sent_n().y(), 0.5);
  EXPECT_LT(link->sent_n().y(), 20.0);
  EXPECT_NEAR(link->sent_n().x(), 0.0, 0.1 * link->sent_n().y());  // same direction
}

// A board that answers whole, and wrong.
class LyingHaply : public HaplyModel {
 public:
  using HaplyModel::HaplyModel;
  bool lies = false;
  bool for_good = false;
  [[nodiscard]] int receive(std::span<std::uint8_t> packet,
                            std::int64_t now_ns) override {
    const int got = HaplyModel::receive(packet, now_ns);
    if (lies && got == static_cast<int>(kHaplyReplyBytes)) {
      const auto reply = encode_angles(kHaplyId, {150.0, -20.0});
      std::copy(reply.begin(), reply.end(), packet.begin());
      lies = for_good;
    }
    return got;
  }
};

// It on a bus, and the driver.
struct Lied {
  LyingHaply board{held()};
  FaultyUsb bus{board, UsbFaults{}};
  std::unique_ptr<EmulatedUsb> usb;
  HaplyLink link{haply_driver(),
                 [this] {
                   usb = std::make_unique<EmulatedUsb>(bus);
                   return usb->descriptor();
                 },
                 [this](int) {
                   usb.reset();
                 }};
};

TEST(EmulatedHaply, AnglesThatJumpForGoodAreALossWithZeroForce) {
  Lied lied;
  lied.link.open();
  Eigen::Vector3d position_m;
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(lied.link.transact({0.0, 0.3, 0.0}, position_m), LinkStatus::kOk);
  }
  lied.board.for_good = true;
  lied.board.lies = true;
  LinkStatus status = LinkStatus::kOk;
  for (int i = 0; i < 1000 && status != LinkStatus::kLost; ++i) {
    status = lied.link.transact({0.0, 0.3, 0.0}, position_m);
    EXPECT_TRUE(i == 0 || lied.board.torque_nm() == (std::array<double, 2>{})) << i;
  }
  EXPECT_EQ(status, LinkStatus::kLost);
  EXPECT_EQ(lied.link.failure(), "its angles jump or fit no position");
}

TEST(EmulatedHaply, OneWholeWrongReplyMovesNothing) {
  Lied lied;
  LyingHaply& board = lied.board;
  HaplyLink& link = lied.link;
  link.open();
  Eigen::Vector3d before;
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(link.transact(Eigen::Vector3d::Zero(), before), LinkStatus::kOk);
  }
  board.lies = true;
  Eigen::Vector3d at = before;
  EXPECT_EQ(link.transact(Eigen::Vector3d::Zero(), at), LinkStatus::kMissed);
  EXPECT_EQ(at, before);
  EXPECT_EQ(link.transact({0.0, 0.3, 0.0}, at), LinkStatus::kOk);
  EXPECT_EQ(link.sent_n().norm(), 0.0);  // none before the next whole reply
  EXPECT_LT((at - before).norm(), 5e-3);
}

TEST(EmulatedHaply, LinksThatCannotBeAreRefused) {
  HaplyConfig config = haply_driver();
  config.links.driven_m = -1.0;
  EXPECT_THROW(HaplyLink(config, nullptr, nullptr), InputError);
}

}  // namespace
}  // namespace palpate
