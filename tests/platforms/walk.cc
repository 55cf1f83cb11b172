// walk DATABASE [TICKS [TOOL]]: presses a body along one path with every passive model,
// and prints what was felt, so that platforms can be compared bit for bit. The path is
// made of sums, products, quotients and square roots alone, which round alike
// everywhere. Standard output: MODEL CONTACTS DIGEST FORCE WORK, the digest (FNV-1a) of
// the bits of every tick's force. Standard error: how long the start took, and the
// median of a tick.
#include "palpate.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace {

using Point = std::array<double, 3>;
using Clock = std::chrono::steady_clock;

constexpr int kLegTicks = 200;
constexpr int kSlowTicks = 10;
constexpr double kTickS = 0.001;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Knuth's MMIX generator: [0, 1), of the upper 32 bits.
class Random {
 public:
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 32) * 0x1p-32;
  }
  std::size_t below(std::size_t n) {
    return static_cast<std::size_t>(next() * static_cast<double>(n));
  }

 private:
  std::uint64_t state_ = 62;
};

class Surface {
 public:
  explicit Surface(const palpate_body* body) {
    std::size_t vertices = 0;
    std::size_t triangles = 0;
    palpate_mesh_count(body, &vertices, &triangles);
    vertex_.resize(3 * vertices);
    triangle_.resize(3 * triangles);
    palpate_mesh_get(body, vertex_.data(), triangle_.data());
    for (std::size_t i = 0; i < vertices; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        size_ = std::fmax(size_, std::fabs(vertex_[3 * i + k] - vertex_[k]));
      }
    }
  }

  Point above() const { return {0.0, 0.0, size_}; }

  // Above or below the middle of a triangle that is near, by a share of the body's
  // size.
  Point near(const Point& from, Random& random) const {
    std::size_t best = 0;
    double nearest = HUGE_VAL;
    for (int i = 0; i < 16; ++i) {
      const std::size_t t = random.below(triangle_.size() / 3);
      const double distance = squared(less(middle(t), from));
      if (distance < nearest) {
        nearest = distance;
        best = t;
      }
    }
    const Point normal = cross(less(corner(best, 1), corner(best, 0)),
                               less(corner(best, 2), corner(best, 0)));
    const double height = size_ * (0.12 * random.next() - 0.04);
    const double scale = height / std::sqrt(squared(normal));
    Point at = middle(best);
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] += scale * normal[k];
    }
    return at;
  }

 private:
  static Point less(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  }
  static Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0]};
  }
  static double squared(const Point& a) {
    return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
  }
  Point corner(std::size_t t, std::size_t c) const {
    const double* const p =
        &vertex_[3 * static_cast<std::size_t>(triangle_[3 * t + c])];
    return {p[0], p[1], p[2]};
  }
  Point middle(std::size_t t) const {
    Point sum{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Point p = corner(t, c);
      for (std::size_t k = 0; k < 3; ++k) {
        sum[k] += p[k] / 3.0;
      }
    }
    return sum;
  }

  std::vector<double> vertex_;
  std::vector<std::int32_t> triangle_;
  double size_ = 0.0;
};

struct Felt {
  std::uint64_t digest = 14695981039346656037u;
  int contacts = 0;
  double force = 0.0;
  double tick_s = 0.0;

  void take(const double force_n[3]) {
    unsigned char bytes[3 * sizeof(double)];
    std::memcpy(bytes, force_n, sizeof bytes);
    for (const unsigned char byte : bytes) {
      digest = (digest ^ byte) * 1099511628211u;
    }
    force += std::fabs(force_n[0]) + std::fabs(force_n[1]) + std::fabs(force_n[2]);
  }
};

// @return false: a fault
bool walk(palpate_body* body, palpate_tool* tool, const Surface& surface, int ticks,
          Felt& felt) {
  // From clear of the body. Of a tool that begins inside, the rest offset recovers as
  // the tank allows: on a body with dents that doubles last digits from tick to tick.
  Random random;
  Point from{};
  Point to = surface.above();
  std::vector<double> tick_s;  // means between slow steps
  Clock::time_point start = Clock::now();
  for (int tick = 0; tick < ticks; ++tick) {
    const int along = tick % kLegTicks;
    if (along == 0) {
      from = to;
      to = surface.near(from, random);
    }
    Point at{};
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] = from[k] + (to[k] - from[k]) * along / kLegTicks;
    }
    double force_n[3];
    const int status = palpate_force(tool, at.data(), nullptr, kTickS, force_n);
    if (status < 0) {
      std::printf("tick %d: %s\n", tick, palpate_fault_name(status));
      return false;
    }
    felt.contacts += status == PALPATE_CONTACT;
    felt.take(force_n);
    if (tick % kSlowTicks == 0) {
      tick_s.push_back(seconds_since(start) / kSlowTicks);
      if (palpate_slow_step(body) < 0) {
        return false;
      }
      start = Clock::now();
    }
  }
  const auto median = tick_s.begin() + static_cast<std::ptrdiff_t>(tick_s.size() / 2);
  std::nth_element(tick_s.begin(), median, tick_s.end());
  felt.tick_s = *median;
  return true;
}

// @return false where the body has not that model
bool run(const char* file, const char* tool_name, const char* model, int ticks) {
  palpate_options options;
  palpate_options_init(&options);
  options.flags = PALPATE_OWN_SLOW_STEPS;
  options.model = model;
  options.tool_name = tool_name;
  char error[256];
  const Clock::time_point start = Clock::now();
  palpate_body* const body = palpate_open(file, &options, error, sizeof error);
  const double opened_s = seconds_since(start);
  palpate_tool* const tool =
      body == nullptr ? nullptr : palpate_tool_open(body, error, sizeof error);
  if (tool == nullptr) {
    std::printf("%s %s\n", model, error);
    palpate_close(body);
    return false;
  }
  Felt felt;
  const bool whole = walk(body, tool, Surface(body), ticks, felt);
  palpate_state state;
  state.struct_size = sizeof state;
  palpate_state_get(tool, &state);
  std::printf("%s %d %016llx %.17g %.17g\n", model, felt.contacts,
              static_cast<unsigned long long>(felt.digest), felt.force, state.work_j);
  std::fprintf(stderr, "%s opened in %.4f s, %.0f ns a tick\n", model, opened_s,
               1e9 * felt.tick_s);
  palpate_close(body);
  return whole;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: walk DATABASE [TICKS [TOOL]]\n");
    return 2;
  }
  const int ticks = argc > 2 ? std::atoi(argv[2]) : 20000;
  const char* const tool_name = argc > 3 ? argv[3] : nullptr;
  int walked = 0;
  for (const char* model :
       {"potential", "facets", "element", "energy-tank", "equal-energy"}) {
    walked += run(argv[1], tool_name, model, ticks) ? 1 : 0;
  }
  return walked == 0;
}
