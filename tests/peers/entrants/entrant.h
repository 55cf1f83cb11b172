// The six functions of renderer.h around a class of C++: PEERS_ENTRANT(Class). The
// class has:
//
//   static constexpr const char* kVariants[] = {..., nullptr};
//   Class(scene folder, own folder, variant, tick_s)   throws std::exception
//   void pose(position), Eigen::Vector3d force(), void slow()
#pragma once

#include <cstdio>
#include <exception>
#include <filesystem>
#include <iterator>
#include <string>

#include <Eigen/Core>

#include "tests/peers/renderer.h"

// NOLINTBEGIN(cppcoreguidelines-macro-usage)
#define PEERS_ENTRANT(Class)                                                 \
  struct peer {                                                              \
    Class it;                                                                \
  };                                                                         \
  const char* peer_variant(int index) {                                      \
    constexpr int kCount = static_cast<int>(std::size(Class::kVariants));    \
    return index >= 0 && index < kCount ? Class::kVariants[index] : nullptr; \
  }                                                                          \
  peer* peer_open(const char* scene, const char* own, const char* variant,   \
                  double tick_s, char* error, size_t error_bytes) {          \
    try {                                                                    \
      return new peer{Class(scene, own, variant, tick_s)};                   \
    } catch (const std::exception& failure) {                                \
      std::snprintf(error, error_bytes, "%s", failure.what());               \
      return nullptr;                                                        \
    }                                                                        \
  }                                                                          \
  void peer_pose(peer* p, const double position_m[3], const double[4]) {     \
    p->it.pose(Eigen::Vector3d(position_m));                                 \
  }                                                                          \
  void peer_force(peer* p, double force_n[3]) {                              \
    Eigen::Map<Eigen::Vector3d>{force_n} = p->it.force();                    \
  }                                                                          \
  void peer_slow(peer* p) {                                                  \
    p->it.slow();                                                            \
  }                                                                          \
  void peer_close(peer* p) {                                                 \
    delete p;                                                                \
  }
// NOLINTEND(cppcoreguidelines-macro-usage)
