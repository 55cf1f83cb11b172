#include "tests/bench/runtime/bench_search.h"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/mesh/surface_search.h"
#include "runtime/realtime/clock.h"
#include "runtime/realtime/step_histogram.h"

namespace palpate {
namespace {

constexpr double kEdgeM = 0.001;
constexpr double kWaveM = 0.004;
constexpr double kWavelengthM = 0.06;
constexpr double kOffM = 0.01;  // first contacts: the tool over and under the surface
constexpr double kSlideM = 0.001;  // 0.1 m/s at 100 Hz

double height_m(double x_m, double y_m) {
  constexpr double kNumber = 2.0 * 3.14159265358979323846 / kWavelengthM;
  return kWaveM * std::sin(kNumber * x_m) * std::cos(kNumber * y_m);
}

SurfaceMesh wavy_surface(std::int64_t triangles) {
  const auto cells = static_cast<std::int32_t>(
      std::ceil(std::sqrt(static_cast<double>(triangles) / 2.0)));
  const std::int32_t side = cells + 1;
  SurfaceMesh mesh;
  mesh.position_m.resize(Eigen::Index{side} * side, 3);
  mesh.triangle.resize(2 * Eigen::Index{cells} * cells, 3);
  for (std::int32_t i = 0; i < side; ++i) {
    for (std::int32_t j = 0; j < side; ++j) {
      const double x_m = kEdgeM * i;
      const double y_m = kEdgeM * j;
      mesh.position_m.row(Eigen::Index{i} * side + j) << x_m, y_m, height_m(x_m, y_m);
    }
  }
  Eigen::Index t = 0;
  for (std::int32_t i = 0; i < cells; ++i) {
    for (std::int32_t j = 0; j < cells; ++j) {
      const std::int32_t v = i * side + j;
      mesh.triangle.row(t++) << v, v + side, v + 1;
      mesh.triangle.row(t++) << v + 1, v + side, v + side + 1;
    }
  }
  return mesh;
}

class Timer {
 public:
  Timer() {
    StepHistogram empty;
    for (int i = 0; i < 10'000; ++i) {
      const std::int64_t begin_ns = clock_.now_ns();
      empty.add(clock_.now_ns() - begin_ns);
    }
    own_ns_ = std::llround(empty.percentile_ns(0.5));
  }

  template <typename Query>
  SurfacePoint time(StepHistogram& histogram, const Query& query) {
    const std::int64_t begin_ns = clock_.now_ns();
    const SurfacePoint point = query();
    histogram.add(clock_.now_ns() - begin_ns - own_ns_);
    return point;
  }

 private:
  MonotonicClock clock_;
  std::int64_t own_ns_ = 0;
};

SearchBenchRow time_search(std::int64_t triangles, int queries) {
  const SurfaceMesh mesh = wavy_surface(triangles);
  MonotonicClock clock;
  const std::int64_t begin_ns = clock.now_ns();
  const SurfaceSearch search(mesh);
  SearchBenchRow row{.triangles = mesh.triangle.rows(),
                     .build_s = static_cast<double>(clock.now_ns() - begin_ns) /
                                kNanosecondsPerSecond};
  const double side_m = mesh.position_m.col(0).maxCoeff();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  StepHistogram first;
  StepHistogram slide;
  StepHistogram press;
  Timer timer;
  for (int i = 0; i < queries; ++i) {
    Eigen::Vector3d p(side_m * unit(random), side_m * unit(random), 0.0);
    p.z() = height_m(p.x(), p.y()) + kOffM * (2.0 * unit(random) - 1.0);
    SurfacePoint point = timer.time(first, [&] {
      return search.nearest(p);
    });
    p = point.position_m;
    const double angle = 6.28 * unit(random);
    p += kSlideM * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    point = timer.time(slide, [&] {
      return search.walk(p, point.triangle);
    });
    p = point.position_m - Eigen::Vector3d(0.0, 0.0, 0.001);
    point = timer.time(press, [&] {
      return search.walk(p, point.triangle);
    });
  }
  row.first_median_ns = first.percentile_ns(0.5);
  row.first_p999_ns = first.percentile_ns(0.999);
  row.slide_median_ns = slide.percentile_ns(0.5);
  row.slide_p999_ns = slide.percentile_ns(0.999);
  row.press_median_ns = press.percentile_ns(0.5);
  row.press_p999_ns = press.percentile_ns(0.999);
  return row;
}

}  // namespace

std::vector<SearchBenchRow> run_search_bench(const SearchBenchOptions& options) {
  std::vector<SearchBenchRow> rows;
  for (const std::int64_t triangles : options.triangles) {
    if (triangles < 2 || triangles > 100'000'000 || options.queries < 1) {
      throw InputError(
          fmt::format("{} triangles and {} queries, must be 2 to 10^8 and at least 1",
                      triangles, options.queries));
    }
    rows.push_back(time_search(triangles, options.queries));
  }
  return rows;
}

std::string table_text(const std::vector<SearchBenchRow>& rows) {
  std::string text = fmt::format("{:>10} {:>8} {:>20} {:>20} {:>20}\n", "triangles",
                                 "tree", "first contact", "slide 1 mm", "press 1 mm");
  const auto both = [](double median_ns, double p999_ns) {
    return fmt::format("{:>8.2f} {:>8.2f} us", median_ns / 1e3, p999_ns / 1e3);
  };
  for (const SearchBenchRow& row : rows) {
    text += fmt::format("{:>10} {:>6.2f} s {:>20} {:>20} {:>20}\n", row.triangles,
                        row.build_s, both(row.first_median_ns, row.first_p999_ns),
                        both(row.slide_median_ns, row.slide_p999_ns),
                        both(row.press_median_ns, row.press_p999_ns));
  }
  return text + "median and 99.9th percentile\n";
}

std::string to_json(const std::vector<SearchBenchRow>& rows) {
  nlohmann::ordered_json json;
  json["rows"] = nlohmann::ordered_json::array();
  for (const SearchBenchRow& row : rows) {
    json["rows"].push_back({{"triangles", row.triangles},
                            {"build_s", row.build_s},
                            {"first_median_ns", row.first_median_ns},
                            {"first_p999_ns", row.first_p999_ns},
                            {"slide_median_ns", row.slide_median_ns},
                            {"slide_p999_ns", row.slide_p999_ns},
                            {"press_median_ns", row.press_median_ns},
                            {"press_p999_ns", row.press_p999_ns}});
  }
  return json_text(json, 2);
}

}  // namespace palpate
