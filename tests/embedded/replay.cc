// The fast step over a recorded trajectory, elements by wire: the same source for the
// host and for a Cortex-M. Reads SCRIPT, writes what left for the device to RESULT.
//
//   replay SCRIPT RESULT
//
// SCRIPT: model (u32), ticks (u32), tool's radius [m] and time of a tick [s] (f64
// each); per tick: bytes of wire (u32), these bytes, position (3 x f64). RESULT: per
// tick force, depth, stored, tank, dissipated, shift (8 x f64), triangle and fault (2 x
// i32).
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "runtime/element/element_wire.h"
#include "runtime/fast/fast_step.h"
#include "tests/embedded/board.h"

namespace palpate {
namespace {

constexpr std::size_t kPieceBytes = 64;  // as a full-speed USB packet

// Not on the stack: that is measured.
FastState fast;
ElementReceiver receiver;
Element element;

struct Result {
  double force_n[3];
  double depth_m;
  double stored_j;
  double tank_j;
  double dissipated_j;
  double shift_m;
  std::int32_t triangle;
  std::int32_t fault;
};

bool read(std::FILE* file, void* to, std::size_t bytes) {
  return std::fread(to, 1, bytes, file) == bytes;
}

bool take_in(std::FILE* script) {
  std::uint32_t left = 0;
  if (!read(script, &left, sizeof left)) {
    return false;
  }
  while (left > 0) {
    static std::byte piece[kPieceBytes];
    const std::size_t taken = left < kPieceBytes ? left : kPieceBytes;
    if (!read(script, piece, taken)) {
      return false;
    }
    left -= static_cast<std::uint32_t>(taken);
    for (std::span<const std::byte> bytes(piece, taken); !bytes.empty();) {
      if (receive(receiver, bytes, element)) {
        accept(fast, element);
      }
    }
  }
  return true;
}

Result result_of(const FastCommand& command) {
  Result result{};
  for (int i = 0; i < 3; ++i) {
    result.force_n[i] = static_cast<double>(command.force_n(i));
  }
  result.depth_m = static_cast<double>(command.depth_m);
  result.stored_j = command.stored_j;
  result.tank_j = command.tank_j;
  result.dissipated_j = command.dissipated_j;
  result.shift_m = static_cast<double>(command.rest_offset_m);
  result.triangle = contact(fast).triangle;
  result.fault = command.fault;
  return result;
}

// Cost of the ticks, in instructions where the board can count them.
struct Cost {
  std::uint64_t sum = 0;
  std::uint32_t most = 0;
  std::uint32_t ticks = 0;
  std::uint32_t contacts = 0;
};

bool run(std::FILE* script, std::FILE* result, Cost& cost) {
  std::uint32_t head[2] = {0, 0};
  double config[2] = {0.0, 0.0};
  if (!read(script, head, sizeof head) || head[0] >= kLocalModels.size() ||
      !read(script, config, sizeof config)) {
    return false;
  }
  fast.config.model = kLocalModels[head[0]];
  fast.config.tool_radius_m = static_cast<Real>(config[0]);
  const auto dt_s = static_cast<Real>(config[1]);
  for (std::uint32_t tick = 0; tick < head[1]; ++tick) {
    double position[3];
    if (!take_in(script) || !read(script, position, sizeof position)) {
      return false;
    }
    FastSample sample;
    for (int i = 0; i < 3; ++i) {
      sample.position_m(i) = static_cast<Real>(position[i]);
    }
    board::count_begin();
    const FastCommand command = step(fast, sample, dt_s);
    const std::uint32_t instructions = board::count_end();
    cost.sum += instructions;
    cost.most = instructions > cost.most ? instructions : cost.most;
    cost.contacts += command.in_contact ? 1 : 0;
    ++cost.ticks;
    const Result line = result_of(command);
    if (std::fwrite(&line, 1, sizeof line, result) != sizeof line) {
      return false;
    }
  }
  return true;
}

// Of 51 x 64 differences 1 - x, x in [2^-e, 2^(1-e)), e from 2 to 52, how many are not
// the nearest double, by integers: x is m 2^-(52+e), the difference a multiple of
// 2^-53.
int wrong_differences() {
  int wrong = 0;
  std::uint64_t state = 88172645463325252U;
  for (int e = 2; e <= 52; ++e) {
    for (int i = 0; i < 64; ++i) {
      state ^= state << 13;  // Marsaglia's xorshift
      state ^= state >> 7;
      state ^= state << 17;
      const std::uint64_t m = (state >> 12) | std::uint64_t{1} << 52;
      const std::uint64_t rest = m & ((std::uint64_t{1} << (e - 1)) - 1);
      const std::uint64_t half = std::uint64_t{1} << (e - 2);
      std::uint64_t nearest = (std::uint64_t{1} << 53) - (m >> (e - 1));
      nearest -= rest > half || (rest == half && nearest % 2 == 1) ? 1 : 0;
      const std::uint64_t bits =
          (m & ((std::uint64_t{1} << 52) - 1)) | std::uint64_t(1023 - e) << 52;
      double x = 0.0;
      std::memcpy(&x, &bits, sizeof x);
      const volatile double one = 1;
      wrong += one - x == std::ldexp(static_cast<double>(nearest), -53) ? 0 : 1;
    }
  }
  return wrong;
}

void print(const Cost& cost) {
  const WireCounts& wire = receiver.counts;
  std::printf("ticks %lu contact %lu\n", static_cast<unsigned long>(cost.ticks),
              static_cast<unsigned long>(cost.contacts));
  std::printf(
      "wire accepted %lu lost %lu late %lu repeated %lu broken %lu\n",
      static_cast<unsigned long>(wire.accepted), static_cast<unsigned long>(wire.lost),
      static_cast<unsigned long>(wire.late), static_cast<unsigned long>(wire.repeated),
      static_cast<unsigned long>(wire.broken));
  std::printf("created_pj %lu\n",
              static_cast<unsigned long>(fast.ledger.created_j * double(1e12)));
  std::printf("state_bytes %lu\n", static_cast<unsigned long>(sizeof fast));
  std::printf("wrong_differences %d\n", wrong_differences());
  if (cost.ticks > 0 && cost.sum > 0) {
    std::printf("instructions mean %lu most %lu\n",
                static_cast<unsigned long>(cost.sum / cost.ticks),
                static_cast<unsigned long>(cost.most));
    std::printf("stack_bytes %lu\n", static_cast<unsigned long>(board::stack_used()));
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const char* script_name = argc > 1 ? argv[1] : "script.bin";
  const char* result_name = argc > 2 ? argv[2] : "result.bin";
  std::FILE* script = std::fopen(script_name, "rb");
  std::FILE* result = std::fopen(result_name, "wb");
  palpate::Cost cost;
  const bool done =
      script != nullptr && result != nullptr && palpate::run(script, result, cost);
  if (script != nullptr) {
    std::fclose(script);
  }
  if (result == nullptr || std::fclose(result) != 0 || !done) {
    std::printf("replay: %s cannot be replayed into %s\n", script_name, result_name);
    return 2;
  }
  palpate::print(cost);
  return 0;
}
