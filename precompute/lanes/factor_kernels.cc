#include "precompute/lanes/factor_kernels.h"

#include "precompute/lanes/instruction_set.h"

namespace palpate {

// Each made by factor_kernels.inc in a source of its own.
namespace lanes_baseline {
extern const FactorKernels factor_table;
}
namespace lanes_avx2 {
extern const FactorKernels factor_table;
}
namespace lanes_avx512 {
extern const FactorKernels factor_table;
}

const FactorKernels& factor_kernels(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx512:
      return lanes_avx512::factor_table;
    case InstructionSet::kAvx2:
      return lanes_avx2::factor_table;
    case InstructionSet::kBaseline:
      break;
  }
  return lanes_baseline::factor_table;
}

const FactorKernels& factor_kernels() {
  return factor_kernels(instruction_set());
}

}  // namespace palpate
