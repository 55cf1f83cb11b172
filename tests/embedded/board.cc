// Start of a Cortex-M of QEMU's MPS2 boards, its instruction counter and stack gauge.
#include "tests/embedded/board.h"

#include <cstddef>
#include <cstdlib>

extern "C" {
extern std::uint32_t stack_top;
extern std::uint32_t stack_bottom;
int main(int argc, char** argv);
void initialise_monitor_handles(void);
void __libc_init_array(void);
void _init(void) {}
void _fini(void) {}
[[noreturn]] void reset(void);
[[noreturn]] void fault(void);

[[gnu::section(".vectors"), gnu::used]] const void* const kVectors[16] = {
    &stack_top,
    reinterpret_cast<const void*>(&reset),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault)};
}

namespace {

volatile std::uint32_t& reg(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

constexpr std::uintptr_t kCpacr = 0xE000ED88;
constexpr std::uintptr_t kSysTickControl = 0xE000E010;
constexpr std::uintptr_t kSysTickReload = 0xE000E014;
constexpr std::uintptr_t kSysTickValue = 0xE000E018;
constexpr std::uint32_t kSysTickMask = 0xFFFFFF;
constexpr std::uint32_t kPaint = 0xA5A5A5A5;

// An instruction lasts 1024 ns, a tick of the 25 MHz system clock 40 ns.
constexpr std::uint32_t kTicksPer10Instructions = 256;

std::uint32_t begun;
std::uint32_t least_free_words = 0xFFFFFFFF;

std::uint32_t* stack_pointer() {
  std::uint32_t* at = nullptr;
  asm volatile("mov %0, sp" : "=r"(at));
  return at;
}

}  // namespace

namespace palpate::board {

void count_begin() noexcept {
  // Paints what is free, but for this function's own frame.
  for (std::uint32_t* at = &stack_bottom; at < stack_pointer() - 64; ++at) {
    *at = kPaint;
  }
  reg(kSysTickReload) = kSysTickMask;
  reg(kSysTickControl) = 5;
  begun = reg(kSysTickValue);
}

std::uint32_t count_end() noexcept {
  const std::uint32_t ticks = (begun - reg(kSysTickValue)) & kSysTickMask;
  std::uint32_t free_words = 0;
  for (std::uint32_t* at = &stack_bottom; *at == kPaint; ++at) {
    ++free_words;
  }
  least_free_words = free_words < least_free_words ? free_words : least_free_words;
  return ticks * 10 / kTicksPer10Instructions;
}

std::uint32_t stack_used() noexcept {
  // From here, a frame or two above the step's caller, down to what was never touched.
  const auto words =
      static_cast<std::uint32_t>(stack_pointer() - (&stack_bottom + least_free_words));
  return 4 * words;
}

}  // namespace palpate::board

void reset() {
  reg(kCpacr) = reg(kCpacr) | (0xFU << 20);  // both coprocessors of the FPU
  asm volatile("dsb\nisb");
  initialise_monitor_handles();
  __libc_init_array();
  std::exit(main(0, nullptr));
}

void fault() {
  std::_Exit(3);
}
