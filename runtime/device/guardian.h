// A second process whose only work is to put a device to zero force when the first
// process can no longer do so. The first process is then killed, crashed, or hanging.
#pragma once

#include <atomic>
#include <cstdint>

#include <pthread.h>
#include <sys/types.h>

namespace palpate {

/// Forks in the constructor. The guardian holds a duplicate of the device's descriptor.
/// It sends zero force and ends
///
/// - when the thread that called beat() ends, whatever the reason. That thread holds a
///   robust mutex that the guardian waits for. The kernel passes the mutex on before it
///   takes the process's memory apart, which takes tens of milliseconds where memory is
///   large;
/// - when this process's end of a socket between the two is closed, before the first
///   beat() and as a second string after it.
///
/// When beat() was not called for `silent_s`, the guardian sends zero force, too, and
/// is tripped for good. The guardian looks eight times in that time. So zero force
/// comes at most 9/8 of that time after the last call, as far as the guardian is given
/// a processor. A process that hangs must not take hold of the device again. The
/// guardian is in a session of its own and ignores SIGINT, SIGTERM and SIGHUP, so that
/// what ends this process's group leaves it alive.
///
/// The child calls nothing but async-signal-safe functions and the mutex, so that other
/// threads may exist when it is forked.
class Guardian {
 public:
  /// Puts a device to zero force; `last`: for the last time, the guarded process is
  /// gone or ends its guardian. Where only its thread has ended, it is not the last.
  /// Async-signal-safe; called in the guardian process.
  using ZeroForce = void (*)(int device_descriptor, bool last) noexcept;

  /// @param device_descriptor stays open in the guardian after this process has closed
  /// its own. @param silent_s [s] > 0. @throws DeviceError if there can be no guardian.
  Guardian(int device_descriptor, ZeroForce zero_force, double silent_s);

  /// The guardian sends zero force and ends; returns after that.
  ~Guardian();
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;

  /// The fast loop lives: to be called at every tick, by one thread. From the first
  /// call on silence counts. False if the guardian has tripped or is gone; the force is
  /// then to be zero. No lock, one system call that does not wait.
  [[nodiscard]] bool beat() noexcept;

 private:
  struct Shared {
    pthread_mutex_t held{};  // robust; by the thread that beats
    std::atomic<std::uint64_t> beats{0};
    std::atomic<bool> tripped{false};
  };
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free,
                "shared between processes");

  [[noreturn]] static void guard(Shared& shared, int lifeline, int device_descriptor,
                                 ZeroForce zero_force, std::int64_t silent_ns) noexcept;
  static bool init(pthread_mutex_t& mutex) noexcept;

  Shared* shared_ = nullptr;
  bool beating_ = false;  // the mutex is held
  int lifeline_ = -1;
  pid_t child_ = -1;
};

}  // namespace palpate
