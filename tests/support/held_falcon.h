// An emulated Falcon in a hand that rests in the middle of its workspace, and a driver
// that bears the pauses of a test machine.
#pragma once

#include "runtime/emulation/emulated_falcon.h"

namespace palpate {

inline FalconModelConfig held_falcon() {
  FalconModelConfig config;
  config.hand = {.surface_m = falcon_centre_m(), .press_m = 0.0, .deeper_m = 0.0};
  config.start_m = config.hand.at(0.0).position_m;
  return config;
}

/// With its firmware in it.
inline EmulatedFalconConfig held_loaded_falcon() {
  EmulatedFalconConfig config;
  config.model = held_falcon();
  config.model.loaded = true;
  return config;
}

inline FalconConfig patient_driver() {
  FalconConfig config;
  config.firmware = emulated_firmware();
  config.homing_s = 5.0;
  config.answer_s = 0.05;
  return config;
}

}  // namespace palpate
