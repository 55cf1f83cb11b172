// palpate for C++ (C++17, header-only): palpate.h, palpate_draw.h, palpate_needle.h and
// palpate_memory.h with owners, exceptions and arrays.
//
//   palpate::Body body("liver.h5");
//   palpate::Tool tool = body.add_tool();
//   for (;;) {
//     const palpate::Hand hand = tool.step({position}, dt_s).hand[0];  // haptic thread
//   }
//
// Functions of the haptic thread do not throw or allocate, as palpate.h says; others
// throw palpate::Error with the library's line of text. handle() leads to what has no
// name here: services of scenes, HDF5's lock.
#ifndef PALPATE_HPP
#define PALPATE_HPP

#include "palpate_draw.h"
#include "palpate_memory.h"
#include "palpate_needle.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

using Point = std::array<double, 3>;       ///< [host length]
using Quaternion = std::array<double, 4>;  ///< x y z w, of any length; zeros: none

class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Every default.
inline palpate_options default_options() {
  palpate_options options;
  palpate_options_init(&options);
  return options;
}

struct Pose {
  Point position{};
  Quaternion quat_xyzw{};
};

/// On a hand's tool.
struct Hand {
  Point force{};   ///< [host force]
  Point torque{};  ///< [host force x host length] about the reference point
};

/// One tick. Below zero the status is a fault, and all is zero.
struct Tick {
  int status = PALPATE_FREE;  ///< palpate_status
  std::array<Hand, 2> hand;   ///< the second of palpate_together_open() alone
  [[nodiscard]] bool touches() const noexcept { return status == PALPATE_CONTACT; }
  [[nodiscard]] bool failed() const noexcept { return status < 0; }
  [[nodiscard]] const char* status_name() const noexcept {
    return palpate_fault_name(status);
  }
};

struct Mesh {
  std::vector<Point> vertex;                        ///< [host length] in the world
  std::vector<std::array<std::int32_t, 3>> corner;  ///< anticlockwise from outside
};

namespace detail {
using Text = std::array<char, 512>;
inline void require(bool well, const Text& why) {
  if (!well) {
    throw Error(why.data());
  }
}
}  // namespace detail

/// Lives as long as its body, which owns it; copies are the same tool.
class Tool {
 public:
  /// @param handle not null. @param vertices of its body's mesh.
  Tool(palpate_tool* handle, std::size_t hands, std::size_t vertices) noexcept
      : handle_(handle), hands_(hands), vertices_(vertices) {}

  /// Haptic thread. @param poses one for each hand; what is beyond is not read.
  Tick step(const std::array<Pose, 2>& poses, double dt_s) noexcept {
    std::array<palpate_pose, 2> in{};
    std::array<palpate_hand_wrench, 2> out{};
    for (std::size_t i = 0; i < hands_; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        in[i].position[k] = poses[i].position[k];
      }
      for (std::size_t k = 0; k < 4; ++k) {
        in[i].quat_xyzw[k] = poses[i].quat_xyzw[k];
      }
    }
    Tick tick;
    tick.status = palpate_step(handle_, in.data(), hands_, dt_s, out.data());
    for (std::size_t i = 0; i < hands_; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        tick.hand[i].force[k] = out[i].force[k];
        tick.hand[i].torque[k] = out[i].torque[k];
      }
    }
    return tick;
  }
  Tick step(const Pose& pose, double dt_s) noexcept {
    return step(std::array<Pose, 2>{pose, Pose{}}, dt_s);
  }

  /// Haptic thread: what the devices made of the latest tick, where they clamped it.
  int delivered(const std::array<Hand, 2>& made) noexcept {
    std::array<double, 6> force{}, torque{};
    for (std::size_t i = 0; i < 6; ++i) {
      force[i] = made[i / 3].force[i % 3];
      torque[i] = made[i / 3].torque[i % 3];
    }
    return palpate_delivered(handle_, force.data(), torque.data());
  }

  /// As palpate_state_get().
  [[nodiscard]] palpate_state state() const noexcept {
    palpate_state state{};
    state.struct_size = sizeof state;
    palpate_state_get(handle_, &state);
    return state;
  }

  /// Haptic thread, outside a tick; allocates: palpate_contacts_get() does not.
  [[nodiscard]] std::vector<palpate_contact> contacts() const {
    std::vector<palpate_contact> all(64);
    const int count =
        palpate_contacts_get(handle_, all.data(), all.size(), sizeof all[0]);
    all.resize(static_cast<std::size_t>(count));
    return all;
  }

  /// By how much each vertex gives way under those contacts [host length]; empty where
  /// the database stores no field for them. @throws Error
  [[nodiscard]] std::vector<Point> displaced(
      const std::vector<palpate_contact>& contacts) const {
    std::vector<double> flat(3 * vertices_);
    detail::Text why{};
    const int known =
        palpate_displaced(handle_, contacts.data(), contacts.size(),
                          sizeof(palpate_contact), flat.data(), why.data(), why.size());
    detail::require(known >= 0, why);
    std::vector<Point> moved(known > 0 ? vertices_ : 0);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      moved[i] = {flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]};
    }
    return moved;
  }

  /// Haptic thread, outside a tick. @throws Error where the tool is no needle.
  [[nodiscard]] palpate_needle needle() const {
    palpate_needle needle{};
    needle.struct_size = sizeof needle;
    detail::Text why{};
    detail::require(palpate_needle_get(handle_, &needle, why.data(), why.size()) == 0,
                    why);
    return needle;
  }

  /// What it has cut open. @throws Error where the tool is no needle.
  [[nodiscard]] std::vector<palpate_channel> channels() const {
    std::vector<palpate_channel> all(16);
    detail::Text why{};
    const int count = palpate_channels_get(handle_, all.data(), all.size(),
                                           sizeof all[0], why.data(), why.size());
    detail::require(count >= 0, why);
    all.resize(static_cast<std::size_t>(count));
    return all;
  }

  /// What has yielded stays.
  void reset() noexcept { palpate_reset(handle_); }
  /// @throws Error
  void save_surface(const std::string& file) {
    detail::Text why{};
    detail::require(
        palpate_surface_save(handle_, file.c_str(), why.data(), why.size()) == 0, why);
  }
  /// @param file empty: a fresh surface. @throws Error
  void load_surface(const std::string& file = {}) {
    detail::Text why{};
    detail::require(palpate_surface_load(handle_, file.empty() ? nullptr : file.c_str(),
                                         why.data(), why.size()) == 0,
                    why);
  }

  [[nodiscard]] palpate_tool* handle() const noexcept { return handle_; }
  [[nodiscard]] std::size_t hands() const noexcept { return hands_; }

 private:
  palpate_tool* handle_;
  std::size_t hands_;
  std::size_t vertices_;
};

class Body {
 public:
  /// @throws Error
  explicit Body(const std::string& file,
                const palpate_options& options = default_options()) {
    detail::Text why{};
    body_.reset(palpate_open(file.c_str(), &options, why.data(), why.size()));
    detail::require(body_ != nullptr, why);
  }

  /// Of a database's bytes, as palpate_open_memory(). @throws Error
  Body(const void* bytes, std::size_t count,
       const palpate_options& options = default_options()) {
    detail::Text why{};
    body_.reset(
        palpate_open_memory(bytes, count, &options, why.data(), why.size()));
    detail::require(body_ != nullptr, why);
  }

  /// @throws Error
  Tool add_tool() {
    detail::Text why{};
    palpate_tool* tool = palpate_tool_open(body_.get(), why.data(), why.size());
    detail::require(tool != nullptr, why);
    return {tool, 1, size().first};
  }
  /// Two hands on the body. @param second tool; empty: another of the same. @throws
  /// Error
  Tool add_together(const std::string& second = {}) {
    detail::Text why{};
    palpate_tool* tool = palpate_together_open(
        body_.get(), second.empty() ? nullptr : second.c_str(), why.data(), why.size());
    detail::require(tool != nullptr, why);
    return {tool, 2, size().first};
  }

  /// How the body stands in the world; not while a tool steps. @throws Error
  void place(const Point& position,
             const Quaternion& quat_xyzw = {0.0, 0.0, 0.0, 1.0}) {
    if (palpate_place(body_.get(), position.data(), quat_xyzw.data()) != 0) {
      throw Error("a place must be finite, and an orientation not zero");
    }
  }

  /// One turn of the slow process, of PALPATE_OWN_SLOW_STEPS. @throws Error
  int slow_step() {
    const int sent = palpate_slow_step(body_.get());
    if (sent < 0) {
      detail::Text why{};
      (void)palpate_slow_failure(body_.get(), why.data(), why.size());
      throw Error(why[0] == 0 ? "no slow steps of the host's: there is a thread"
                              : why.data());
    }
    return sent;
  }

  /// The surface at rest; empty of a streamed body.
  [[nodiscard]] Mesh mesh() const {
    const auto [vertices, triangles] = size();
    std::vector<double> flat(3 * vertices);
    std::vector<std::int32_t> corner(3 * triangles);
    Mesh mesh;
    if (vertices > 0) {
      (void)palpate_mesh_get(body_.get(), flat.data(), corner.data());
    }
    for (std::size_t i = 0; i < vertices; ++i) {
      mesh.vertex.push_back({flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]});
    }
    for (std::size_t i = 0; i < triangles; ++i) {
      mesh.corner.push_back({corner[3 * i], corner[3 * i + 1], corner[3 * i + 2]});
    }
    return mesh;
  }

  /// Forces at rest, without friction or history. @throws Error
  [[nodiscard]] std::vector<Point> query(const std::vector<Point>& positions) {
    std::vector<Point> forces(positions.size());
    detail::Text why{};
    detail::require(
        palpate_query(body_.get(), positions.empty() ? nullptr : positions[0].data(),
                      positions.size(), forces.empty() ? nullptr : forces[0].data(),
                      why.data(), why.size()) == 0,
        why);
    return forces;
  }

  /// [N s/m]
  [[nodiscard]] double needed_damping() const noexcept {
    return palpate_needed_damping(body_.get());
  }
  [[nodiscard]] palpate_body* handle() const noexcept { return body_.get(); }

 private:
  struct Close {
    void operator()(palpate_body* body) const noexcept { palpate_close(body); }
  };

  // Vertices and triangles of the mesh; none of a streamed body.
  [[nodiscard]] std::pair<std::size_t, std::size_t> size() const noexcept {
    std::size_t vertices = 0, triangles = 0;
    if (palpate_mesh_count(body_.get(), &vertices, &triangles) != 0) {
      return {0, 0};
    }
    return {vertices, triangles};
  }

  std::unique_ptr<palpate_body, Close> body_;
};

}  // namespace palpate

#endif
