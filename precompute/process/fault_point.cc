#include "precompute/process/fault_point.h"

#include <utility>

namespace palpate {
namespace {

FaultMaker& maker() {
  static FaultMaker the_maker;
  return the_maker;
}

}  // namespace

void set_fault_maker(FaultMaker wanted) {
  maker() = std::move(wanted);
}

void fault_point(FaultPlace place, std::int32_t vertex, std::span<double> numbers) {
  if (maker()) {
    maker()(place, vertex, numbers);
  }
}

}  // namespace palpate
