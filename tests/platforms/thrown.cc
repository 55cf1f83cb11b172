// thrown: what cmake/toolchains/wasm/exceptions.cc throws is caught as the C++ standard
// says. Names what is not; exit code 1 then.
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

int alive = 0;
int wrong = 0;

struct Counted : std::runtime_error {
  explicit Counted(const std::string& text) : runtime_error(text) { ++alive; }
  Counted(const Counted& other) : runtime_error(other) { ++alive; }
  ~Counted() override { --alive; }
};
struct Left {
  virtual ~Left() = default;
  int left = 1;
};
struct Right {
  virtual ~Right() = default;
  int right = 2;
};
struct Both : Left, Right {};

void expect(bool holds, const char* what) {
  if (!holds) {
    std::printf("not so: %s\n", what);
    ++wrong;
  }
}

template <typename Caught, typename Throw>
bool catches(Throw thrown) {
  try {
    try {
      thrown();
    } catch (const Caught&) {
      return true;
    }
  } catch (...) {
    return false;
  }
  return false;
}

void check_types() {
  const auto counted = [] {
    throw Counted("x");
  };
  expect(catches<Counted>(counted), "by its own type");
  expect(catches<std::exception>(counted), "by a base");
  expect(!catches<std::logic_error>(counted), "not by another type");
  expect(catches<int>([] {
           throw 3;
         }),
         "a number");
  expect(!catches<long>([] {
    throw 3;
  }),
         "not a number of another type");
  try {
    throw Both();
  } catch (const Right& second) {
    expect(second.right == 2, "by the second base");
  }
  static Both both;
  try {
    throw &both;
  } catch (const Right* second) {
    expect(second->right == 2, "a pointer by the second base");
  }
  expect(catches<std::out_of_range>([] {
           static_cast<void>(std::vector<Left>().at(1));
         }),
         "what a header of the library throws");
  expect(alive == 0, "nothing is left");
}

void check_again() {
  try {
    try {
      throw Counted("x");
    } catch (const std::exception&) {
      try {
        throw;
      } catch (const Counted&) {
        expect(alive == 1, "thrown again within its handler");
      }
      expect(alive == 1, "is still handled");
      throw;
    }
  } catch (const Counted& counted) {
    expect(std::string(counted.what()) == "x", "thrown again out of its handler");
  }
  expect(alive == 0, "nothing is left of what was thrown again");
}

void check_pointers() {
  std::exception_ptr kept;
  try {
    throw Counted("kept");
  } catch (...) {
    kept = std::current_exception();
  }
  expect(alive == 1, "a pointer keeps an exception");
  for (int i = 0; i < 2; ++i) {
    expect(catches<Counted>([&] {
             std::rethrow_exception(kept);
           }),
           "thrown by a pointer");
  }
  try {
    try {
      std::rethrow_exception(kept);
    } catch (const Counted&) {
      expect(catches<Counted>([&] {
               std::rethrow_exception(kept);
             }),
             "thrown by a pointer within its handler");
      throw 3;
    }
  } catch (int) {
  }
  kept = nullptr;
  expect(alive == 0, "nothing is left of what a pointer kept");
}

}  // namespace

int main() {
  check_types();
  check_again();
  check_pointers();
  for (int i = 0; i < 100000; ++i) {
    expect(catches<Counted>([] {
             throw Counted(std::string(100, 'x'));
           }),
           "many");
  }
  expect(alive == 0 && std::uncaught_exceptions() == 0, "nothing is left");
  return wrong != 0;
}
