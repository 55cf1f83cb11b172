#include "tests/peers/nodule_search.h"

#include <algorithm>
#include <limits>

#include "tests/peers/measures.h"

namespace palpate::peers {
namespace {

double distance_m(const PressPlace& a, const PressPlace& b) {
  return (a.at_m - b.at_m).norm();
}

// Distance of neighbours: median over the places of that to the nearest.
double step_m(std::span<const PressPlace> raster) {
  std::vector<double> nearest;
  for (const PressPlace& a : raster) {
    double least = std::numeric_limits<double>::infinity();
    for (const PressPlace& b : raster) {
      if (&a != &b) {
        least = std::min(least, distance_m(a, b));
      }
    }
    nearest.push_back(least);
  }
  return median(std::move(nearest));
}

// [-] of every place.
std::vector<double> deviations(std::span<const PressPlace> raster,
                               std::span<const double> force_n, double within_m) {
  std::vector<double> result;
  for (std::size_t i = 0; i < raster.size(); ++i) {
    std::vector<double> around;
    for (std::size_t j = 0; j < raster.size(); ++j) {
      if (distance_m(raster[i], raster[j]) < within_m) {
        around.push_back(force_n[j]);
      }
    }
    const double usual = median(std::move(around));
    result.push_back(usual > 0.0 ? force_n[i] / usual - 1.0 : 0.0);
  }
  return result;
}

}  // namespace

std::vector<StiffPlace> stiff_places(std::span<const PressPlace> raster,
                                     std::span<const double> force_n) {
  const double step = step_m(raster);
  const std::vector<double> deviation =
      deviations(raster, force_n, kAroundSteps * step);
  std::vector<StiffPlace> finds;
  for (std::size_t i = 0; i < raster.size(); ++i) {
    bool peak = deviation[i] > kNoticed;
    for (std::size_t j = 0; peak && j < raster.size(); ++j) {
      peak = distance_m(raster[i], raster[j]) > kPeakSteps * step ||
             deviation[j] < deviation[i] || (deviation[j] == deviation[i] && j >= i);
    }
    if (peak) {
      finds.push_back({i, deviation[i]});
    }
  }
  std::stable_sort(finds.begin(), finds.end(), [](const auto& a, const auto& b) {
    return a.deviation > b.deviation;
  });
  return finds;
}

NoduleFind find_nodule(const PeerScene& scene, std::span<const double> force_n) {
  const auto from_nodule_m = [&](const StiffPlace& find) {
    if (!scene.nodule_m) {
      return std::numeric_limits<double>::infinity();
    }
    const PressPlace& place = scene.raster[find.place];
    const Eigen::Vector3d d = place.at_m - *scene.nodule_m;
    return (d - d.dot(place.outward) * place.outward).norm();
  };
  const auto finds = stiff_places(scene.raster, force_n);
  const auto all =
      deviations(scene.raster, force_n, kAroundSteps * step_m(scene.raster));
  NoduleFind result{.distance_m = std::numeric_limits<double>::quiet_NaN(),
                    .largest_deviation = *std::max_element(all.begin(), all.end())};
  const double touches_m = scene.nodule_radius_m + scene.radius_m;
  if (!finds.empty() && scene.nodule_m) {
    result.distance_m = from_nodule_m(finds.front());
    result.found = result.distance_m < touches_m;
  }
  for (const StiffPlace& find : finds) {
    result.false_finds += from_nodule_m(find) < touches_m ? 0 : 1;
  }
  return result;
}

}  // namespace palpate::peers
