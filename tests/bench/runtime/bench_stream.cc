#include "tests/bench/runtime/bench_stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/realtime/clock.h"
#include "runtime/realtime/deadlines.h"
#include "runtime/slow/file_elements.h"
#include "tests/bench/runtime/large_plate.h"

namespace palpate {
namespace {

constexpr double kToolHeightM = 0.003;  // a ball of 5 mm, pressed 2 mm deep

// A line of /proc/self/status, in bytes: "VmRSS" now, "VmHWM" the peak.
std::size_t memory_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(name + ":", 0) == 0) {
      return static_cast<std::size_t>(std::stoull(line.substr(name.size() + 1))) * 1024;
    }
  }
  return 0;
}

void drop_from_page_cache(const std::filesystem::path& file) {
  const int fd = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool dropped =
      fd >= 0 && fsync(fd) == 0 && posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED) == 0;
  if (fd >= 0) {
    close(fd);
  }
  if (!dropped) {
    throw InputError(
        fmt::format("{}: cannot be dropped from the page cache", file.string()));
  }
}

void bring_into_page_cache(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 65536> block{};
  while (in.read(block.data(), block.size())) {
  }
}

// Straight on over a plate, reflected at its border.
class Path {
 public:
  Path(const Eigen::AlignedBox3d& plate, double speed_m_per_s)
      : plate_(plate),
        at_(plate.center()),
        velocity_(speed_m_per_s * Eigen::Vector3d(0.8, 0.6, 0.0)) {
    at_.z() = kToolHeightM;
  }

  Eigen::Vector3d advance(double dt_s) {
    at_ += dt_s * velocity_;
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      if (at_[axis] < plate_.min()[axis] || at_[axis] > plate_.max()[axis]) {
        velocity_[axis] =
            std::copysign(velocity_[axis], plate_.center()[axis] - at_[axis]);
      }
    }
    return at_;
  }
  [[nodiscard]] const Eigen::Vector3d& start_m() const { return at_; }

 private:
  Eigen::AlignedBox3d plate_;
  Eigen::Vector3d at_;
  Eigen::Vector3d velocity_;
};

struct Plate {
  double triangle_m;
  Eigen::AlignedBox3d box;
};

// The two plates by the boxes of their chunks, a margin off their borders.
std::array<Plate, 2> plates_of(const std::filesystem::path& file) {
  const DatabaseIndex index = read_index(file);
  if (index.provenance.writer != kStreamBodyWriter) {
    throw InputError(
        fmt::format("{}: not a file that this bench wrote (--keep)", file.string()));
  }
  const std::int64_t side = plate_side(index.nodes());
  const double low_x = index.box_min_m.col(0).minCoeff();
  const double high_x = index.box_max_m.col(0).maxCoeff();
  const auto plate = [side](double edge_m, double from_x) {
    const double length_m = edge_m * static_cast<double>(side - 1);
    const double margin_m = 0.05 * length_m;
    return Plate{
        edge_m,
        {Eigen::Vector3d(from_x + margin_m, margin_m, 0.0),
         Eigen::Vector3d(from_x + length_m - margin_m, length_m - margin_m, 0.0)}};
  };
  return {plate(kFineTriangleM, low_x),
          plate(kCoarseTriangleM,
                high_x - kCoarseTriangleM * static_cast<double>(side - 1))};
}

StreamBenchRow run_over(const std::filesystem::path& file, const Plate& plate,
                        bool cold, const StreamBenchOptions& options) {
  if (cold) {
    drop_from_page_cache(file);
  } else {
    bring_into_page_cache(file);
  }
  Path path(plate.box, options.speed_m_per_s);
  StreamedElements stream(file, {.budget_bytes = options.budget_bytes}, path.start_m(),
                          true);
  const auto fifo = std::make_unique<ElementFifo>();
  MonotonicClock clock;
  Deadlines deadlines(clock.now_ns(), options.slow_hz);
  StreamBenchRow row{.triangle_m = plate.triangle_m, .cold = cold};
  ToolState tool;
  std::int64_t last_ns = clock.now_ns();
  const std::int64_t end_ns = last_ns + std::llround(options.seconds * 1e9);
  while (last_ns < end_ns) {
    clock.sleep_until_ns(deadlines.next_ns());
    tool.time_ns = clock.now_ns();
    row.missed_deadlines += deadlines.begin(tool.time_ns);
    tool.position_m = path.advance(static_cast<double>(tool.time_ns - last_ns) / 1e9);
    last_ns = tool.time_ns;
    ++tool.sequence;
    stream.update(tool, tool.time_ns, *fifo);
    row.update_max_ms = std::max(
        row.update_max_ms, static_cast<double>(clock.now_ns() - tool.time_ns) / 1e6);
    while (const Element* element = fifo->front()) {
      if (element->active) {
        tool.triangle = element->triangle;
        tool.in_contact = true;
      }
      fifo->pop();
    }
  }
  stream.stop();
  const StreamReport report = stream.report();
  if (!report.fault.empty()) {
    throw FormatError(report.fault);
  }
  row.updates = report.updates;
  row.starved = report.starved;
  row.chunks_loaded = report.cache.loaded;
  row.hit_share = static_cast<double>(report.cache.hits) /
                  static_cast<double>(std::max<std::int64_t>(1, report.cache.wanted));
  row.load_median_ms = report.cache.load_time.percentile_ns(0.5) / 1e6;
  row.load_p99_ms = report.cache.load_time.percentile_ns(0.99) / 1e6;
  row.budget_used_bytes = report.cache.bytes_max;
  return row;
}

StreamBenchReport run_on(const std::filesystem::path& file,
                         const StreamBenchOptions& options) {
  const std::size_t empty_bytes = memory_bytes("VmHWM");
  StreamBenchReport report{.database = file,
                           .speed_m_per_s = options.speed_m_per_s,
                           .budget_bytes = options.budget_bytes};
  const std::array<Plate, 2> plates = plates_of(file);
  {
    const DatabaseIndex index = read_index(file);
    report.nodes = index.nodes();
    report.file_bytes = index.bytes;
  }
  for (const bool cold : {false, true}) {
    for (const Plate& plate : {plates[1], plates[0]}) {
      report.rows.push_back(run_over(file, plate, cold, options));
    }
  }
  report.resident_bytes = memory_bytes("VmHWM") - empty_bytes;
  return report;
}

void check_stream_bench(const StreamBenchOptions& options) {
  if (!(options.seconds > 0.0 && options.seconds <= 3600.0) ||
      !(options.slow_hz >= 1.0 && options.slow_hz <= 10000.0) ||
      !(options.speed_m_per_s >= 0.0 && options.speed_m_per_s <= 100.0) ||
      options.samples < 2) {
    throw InputError(fmt::format(
        "{} s at {} m/s and {} Hz with {} samples, must be (0, 3600] s, [0, 100] m/s, "
        "[1, 10000] Hz and at least 2 samples",
        options.seconds, options.speed_m_per_s, options.slow_hz, options.samples));
  }
}

// A folder that is gone with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name =
        (std::filesystem::temp_directory_path() / "palpate-stream-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw InputError(fmt::format("{}: no folder can be made there", name));
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

StreamBenchReport run_stream_bench(const StreamBenchOptions& options) {
  check_stream_bench(options);
  if (!options.database.empty()) {
    return run_on(options.database, options);
  }
  const TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "stream.h5";
  if (options.keep) {
    file = std::filesystem::absolute(fmt::format("stream-{}.h5", options.nodes));
  }
  write_stream_body(file, options.nodes, options.samples);
  return run_on(file, options);
}

std::string table_text(const StreamBenchReport& report) {
  constexpr double kMib = static_cast<double>(kMebibyte);
  std::string text = fmt::format(
      "{}: {} nodes, {:.0f} MiB\n"
      "resident at most {:.1f} MiB above the empty program (budget {:.0f} MiB), tool "
      "at "
      "{:g} m/s\n\n"
      "{:>9} {:>6} {:>8} {:>8} {:>8} {:>8} {:>7} {:>10} {:>9} {:>11}\n",
      report.database.string(), report.nodes,
      static_cast<double>(report.file_bytes) / kMib,
      static_cast<double>(report.resident_bytes) / kMib,
      static_cast<double>(report.budget_bytes) / kMib, report.speed_m_per_s, "triangle",
      "cache", "updates", "starved", "skipped", "loaded", "hits", "load p50", "p99",
      "longest step");
  for (const StreamBenchRow& row : report.rows) {
    text += fmt::format(
        "{:>6.0f} mm {:>6} {:>8} {:>8} {:>8} {:>8} {:>5.1f} % {:>7.2f} ms {:>6.2f} ms "
        "{:>8.2f} ms\n",
        row.triangle_m * 1e3, row.cold ? "cold" : "warm", row.updates, row.starved,
        row.missed_deadlines, row.chunks_loaded, 100.0 * row.hit_share,
        row.load_median_ms, row.load_p99_ms, row.update_max_ms);
  }
  return text;
}

std::string to_json(const StreamBenchReport& report) {
  nlohmann::json rows = nlohmann::json::array();
  for (const StreamBenchRow& row : report.rows) {
    rows.push_back({{"triangle_m", row.triangle_m},
                    {"cold", row.cold},
                    {"updates", row.updates},
                    {"starved", row.starved},
                    {"missed_deadlines", row.missed_deadlines},
                    {"chunks_loaded", row.chunks_loaded},
                    {"hit_share", row.hit_share},
                    {"load_median_ms", row.load_median_ms},
                    {"load_p99_ms", row.load_p99_ms},
                    {"update_max_ms", row.update_max_ms},
                    {"budget_used_bytes", row.budget_used_bytes}});
  }
  return json_text(nlohmann::json{{"database", report.database.string()},
                                  {"nodes", report.nodes},
                                  {"file_bytes", report.file_bytes},
                                  {"speed_m_per_s", report.speed_m_per_s},
                                  {"budget_bytes", report.budget_bytes},
                                  {"resident_bytes", report.resident_bytes},
                                  {"rows", rows}},
                   2);
}

}  // namespace palpate
