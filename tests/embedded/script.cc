// Writes a trajectory with the elements that came to it, as replay.cc reads it: of a
// body made for this, where on the wire some frames are lost, repeated, late and
// broken; or the trajectory that palpate-run has recorded on a database.
//
//   script MODEL SCALAR TICKS SCRIPT       SCALAR: double or single, of the frames
//   script RECORDING DATABASE SCALAR TICKS SCRIPT
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "formats/database/response_database.h"
#include "formats/recording/recording.h"
#include "runtime/account/local_model.h"
#include "runtime/bench/bench_body.h"
#include "runtime/element/element_wire.h"
#include "runtime/run/replay.h"
#include "runtime/slow/memory_elements.h"

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

void put_head(LocalModel model, int ticks, double radius_m, double dt_s,
              std::ofstream& out) {
  const std::uint32_t head[2] = {static_cast<std::uint32_t>(model),
                                 static_cast<std::uint32_t>(ticks)};
  const double config[2] = {radius_m, dt_s};
  put(out, head, 2);
  put(out, config, 2);
}

void put_tick(const std::vector<std::byte>& wire, const double* position_m,
              std::ofstream& out) {
  const auto bytes = static_cast<std::uint32_t>(wire.size());
  put(out, &bytes, 1);
  put(out, wire.data(), wire.size());
  put(out, position_m, 3);
}

template <typename Frame>
void write_made(LocalModel model, int ticks, std::ofstream& out) {
  constexpr double kRadiusM = 0.005;
  const BenchBody body = make_bench_body({.wave_m = 0.004,
                                          .contrast = 9.0,
                                          .tilt_rad = 0.2,
                                          .friction_max = 1.0,
                                          .touch_offset_m = 3e-4});
  put_head(model, ticks, kRadiusM, 0.0005, out);
  Sender<Frame> sender;
  int tick = 0;
  for (const Eigen::Vector3d& x :
       make_bench_walk(body, {.ticks = ticks, .tool_radius_m = kRadiusM})) {
    std::vector<std::byte> wire;
    if (tick++ % kTicksPerSlow == 0) {
      wire = sender.send(body.around(x));
    }
    put_tick(wire, x.data(), out);
  }
}

template <typename Frame>
void write_recorded(const Recording& recording, const ResponseDatabase& database,
                    int ticks, std::ofstream& out) {
  const RecordingHeader& header = recording.header;
  const ElementStream stream(database, find_tool(database, header.tool),
                             header.force_scale);
  put_head(fast_config(header).model,
           std::min(ticks, static_cast<int>(recording.tick.size())),
           header.tool_radius_m, 1.0 / header.fast_hz, out);
  auto arrival = recording.arrival.begin();
  for (const TickRecord& tick : recording.tick) {
    if (ticks-- == 0) {
      break;
    }
    std::vector<std::byte> wire;
    for (; arrival != recording.arrival.end() && arrival->tick <= tick.tick;
         ++arrival) {
      Element element = stream.element(arrival->triangle);
      element.sequence = static_cast<std::uint64_t>(arrival->sequence);
      element.active = arrival->active != 0;
      Frame frame;
      encode(element, 1, frame);
      wire.insert(wire.end(), frame.begin(), frame.end());
    }
    put_tick(wire, tick.position_m.data(), out);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const std::string scalar = words.size() < 4 ? "" : words[words.size() - 3];
  if ((words.size() != 4 && words.size() != 5) ||
      (scalar != "double" && scalar != "single")) {
    std::fprintf(
        stderr,
        "usage: script MODEL|RECORDING [DATABASE] double|single TICKS SCRIPT\n");
    return 2;
  }
  std::ofstream out(words.back(), std::ios::binary);
  const int ticks = std::atoi(words[words.size() - 2].c_str());
  try {
    if (words.size() == 5) {
      const auto recording = palpate::read_recording(words[0]);
      const auto database = palpate::read_database(words[1]);
      const auto write = scalar == "double"
                             ? palpate::write_recorded<palpate::DoubleFrame>
                             : palpate::write_recorded<palpate::SingleFrame>;
      write(recording, database, ticks, out);
    } else {
      const auto write = scalar == "double" ? palpate::write_made<palpate::DoubleFrame>
                                            : palpate::write_made<palpate::SingleFrame>;
      write(palpate::local_model(words[0]).value(), ticks, out);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "script: %s\n", error.what());
    return 2;
  }
  return out.flush() ? 0 : 2;
}
