// Writes a trajectory with the elements that a slow process would have sent, as
// replay.cc reads it. On the wire some frames are lost, repeated, late and broken.
//
//   script MODEL SCALAR TICKS SCRIPT    SCALAR: double or single, of the frames
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <string_view>
#include <vector>

#include "runtime/bench_body.h"
#include "runtime/fast/element_wire.h"
#include "runtime/fast/local_model.h"

namespace palpate {
namespace {

constexpr int kTicksPerSlow = 20;

template <typename Frame>
class Sender {
 public:
  // The frames of one slow update, as they arrive.
  std::vector<std::byte> send(std::vector<Element> elements) {
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      elements[i].sequence = ++sequence_;
      elements[i].active = i == 0;
      encode(elements[i], 1, frames.emplace_back());
    }
    const auto pick = [&] {
      return random_() % frames.size();
    };
    switch (random_() % 5) {
      case 0:
        frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(pick()));
        break;
      case 1:
        frames.push_back(frames[pick()]);
        break;
      case 2:
        std::swap(frames[pick()], frames[pick()]);
        break;
      case 3:
        frames[pick()][random_() % sizeof(Frame)] ^= std::byte{0x40};
        break;
      default:
        break;
    }
    std::vector<std::byte> bytes;
    for (const Frame& frame : frames) {
      bytes.insert(bytes.end(), frame.begin(), frame.end());
    }
    return bytes;
  }

 private:
  std::mt19937 random_{1};
  std::uint64_t sequence_ = 0;
};

template <typename T>
void put(std::ofstream& out, const T* values, std::size_t count) {
  out.write(reinterpret_cast<const char*>(values),
            static_cast<std::streamsize>(count * sizeof(T)));
}

template <typename Frame>
void write_script(LocalModel model, int ticks, std::ofstream& out) {
  const BenchBody body = make_bench_body({.wave_m = 0.004,
                                          .contrast = 9.0,
                                          .tilt_rad = 0.2,
                                          .friction_max = 1.0,
                                          .touch_offset_m = 3e-4});
  const std::uint32_t head[2] = {static_cast<std::uint32_t>(model),
                                 static_cast<std::uint32_t>(ticks)};
  put(out, head, 2);
  Sender<Frame> sender;
  int tick = 0;
  for (const Eigen::Vector3d& x :
       make_bench_walk(body, {.ticks = ticks, .tool_radius_m = 0.005})) {
    std::vector<std::byte> wire;
    if (tick++ % kTicksPerSlow == 0) {
      wire = sender.send(body.around(x));
    }
    const auto bytes = static_cast<std::uint32_t>(wire.size());
    put(out, &bytes, 1);
    put(out, wire.data(), wire.size());
    put(out, x.data(), 3);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const auto model = argc == 5 ? palpate::local_model(argv[1]) : std::nullopt;
  const std::string_view scalar = argc == 5 ? argv[2] : "";
  if (!model || (scalar != "double" && scalar != "single")) {
    std::fprintf(stderr, "usage: script MODEL double|single TICKS SCRIPT\n");
    return 2;
  }
  std::ofstream out(argv[4], std::ios::binary);
  const int ticks = std::atoi(argv[3]);
  if (scalar == "double") {
    palpate::write_script<palpate::DoubleFrame>(*model, ticks, out);
  } else {
    palpate::write_script<palpate::SingleFrame>(*model, ticks, out);
  }
  return out.flush() ? 0 : 2;
}
