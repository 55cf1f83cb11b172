// The five kinds of error that a tool reports, each with its exit code.
//
// Exit codes: 0 success, 1 a bug in palpate, and per kind as below; 6 what was compared
// differs; 130 interrupted.
// A message is one line: what, which value, what was allowed, which file and element.
#pragma once

#include <stdexcept>
#include <string>

namespace palpate {

class Error : public std::runtime_error {
 public:
  Error(const std::string& what, int exit_code)
      : std::runtime_error(what), exit_code_(exit_code) {}
  [[nodiscard]] int exit_code() const noexcept { return exit_code_; }

 private:
  int exit_code_;
};

/// The user's input is wrong and the user can mend it: scene, mesh, flags.
class InputError : public Error {
 public:
  explicit InputError(const std::string& what) : Error(what, 2) {}
};

/// A file is not what its format promises: foreign, truncated, damaged, too new.
class FormatError : public Error {
 public:
  explicit FormatError(const std::string& what) : Error(what, 3) {}
};

/// A computation could not reach its goal: meshing, factorisation, solve.
class NumericalError : public Error {
 public:
  explicit NumericalError(const std::string& what) : Error(what, 4) {}
};

/// A haptic device failed or is not there.
class DeviceError : public Error {
 public:
  explicit DeviceError(const std::string& what) : Error(what, 5) {}
};

/// Memory, processes or room on a disk are not there at present, or somebody else is
/// writing the file. The same call may succeed later. By 75 job engines know to try
/// again (EX_TEMPFAIL of sysexits.h).
class ResourceError : public Error {
 public:
  explicit ResourceError(const std::string& what) : Error(what, 75) {}
};

/// Two things that were compared are not the same.
class Difference : public Error {
 public:
  explicit Difference(const std::string& what) : Error(what, 6) {}
};

/// The user asked to stop (SIGINT, SIGTERM); nothing was left behind.
class Interrupted : public Error {
 public:
  Interrupted() : Error("interrupted", 130) {}
};

}  // namespace palpate
