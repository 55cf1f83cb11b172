#include "precompute/lanes/instruction_set.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

InstructionSet of_processor() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    return InstructionSet::kAvx512;
  }
  if (__builtin_cpu_supports("avx2")) {
    return InstructionSet::kAvx2;
  }
#endif
  return InstructionSet::kBaseline;
}

InstructionSet wanted() {
  const char* name = std::getenv("PALPATE_INSTRUCTIONS");
  if (name == nullptr) {
    return InstructionSet::kAvx512;
  }
  for (const InstructionSet set :
       {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
    if (name == name_of(set)) {
      return set;
    }
  }
  throw InputError(fmt::format(
      "PALPATE_INSTRUCTIONS is \"{}\"; there are: baseline, avx2, avx512", name));
}

}  // namespace

InstructionSet instruction_set() {
  static const InstructionSet set = std::min(of_processor(), wanted());
  return set;
}

std::string name_of(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx512:
      return "avx512";
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kBaseline:
      break;
  }
  return "baseline";
}

}  // namespace palpate
