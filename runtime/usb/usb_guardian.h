// What a guardian process (guardian.h) does with a USB device: zero force, through the
// kernel's usbfs alone.
//
// A guardian shares the renderer's open usbfs file, and with it the claim of the
// interface. When the renderer is killed, the file stays open in the guardian. The
// guardian writes the command, gives the interface back to the kernel's driver and
// ends.
#pragma once

namespace palpate {

/// [s] without an exchange until the guardian steps in, and 1/8 more.
constexpr double kGuardianPatienceS = 0.1;

/// As Guardian::ZeroForce: async-signal-safe. Idle motors, LEDs off.
void zero_falcon(int descriptor, bool last) noexcept;

/// As Guardian::ZeroForce: async-signal-safe. Zero torques.
void zero_haply(int descriptor, bool last) noexcept;

/// As Guardian::ZeroForce: async-signal-safe.
void zero_inverse3(int descriptor, bool last) noexcept;

}  // namespace palpate
