#include "runtime/attach/device_choice.h"

#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

template <typename Call>
std::string input_error(const Call& call) {
  try {
    static_cast<void>(call());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string choice_error(const DeviceRequest& request) {
  return input_error([&] {
    return choose_device(request);
  });
}

TEST(DeviceChoice, OfAnUnknownNameListsTheKnown) {
  const std::string text = choice_error({.name = "falkon"});
  for (const char* known : {"falcon", "haply-2diy", "emulated-falcon"}) {
    EXPECT_NE(text.find(known), std::string::npos) << text;
  }
}

TEST(DeviceChoice, RefusesWhatTheDeviceHasNot) {
  EXPECT_NE(choice_error({.name = "emulated-falcon", .plane = "x=0"})
                .find("moves in all three dimensions"),
            std::string::npos);
  EXPECT_NE(choice_error({.name = "emulated-haply", .firmware = "/dev/null"}), "");
  EXPECT_NE(choice_error({.name = "emulated-haply", .plane = "q=0"}), "");
  EXPECT_NE(choice_error({.name = "emulated-falcon", .calibration = 0.0}), "");
  const std::string text = input_error([] {
    return calibration_link({.name = "emulated-haply"}, 0.1);
  });
  EXPECT_NE(text.find("has no factor to calibrate"), std::string::npos) << text;
}

TEST(DeviceChoice, ShowsWhichFirmwareIsLoaded) {
  const ScratchFolder folder;
  std::ofstream(folder / "image.bin", std::ios::binary) << "abc";
  std::string told;
  DeviceRequest request{.name = "emulated-falcon",
                        .firmware = (folder / "image.bin").string()};
  request.tell = [&told](const std::string& text) {
    told += text;
  };
  static_cast<void>(choose_device(request));
  EXPECT_NE(
      told.find("3 bytes, SHA-256 "  // of FIPS 180-2, appendix B.1
                "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"),
      std::string::npos)
      << told;
}

}  // namespace
}  // namespace palpate
