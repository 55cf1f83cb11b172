#include "precompute/lanes/element_kernels.h"

#include "precompute/lanes/instruction_set.h"

namespace palpate {

// Each made by element_kernels.inc in a source of its own.
namespace lanes_baseline {
extern const ElementKernels element_table;
}
namespace lanes_avx2 {
extern const ElementKernels element_table;
}
namespace lanes_avx512 {
extern const ElementKernels element_table;
}

const ElementKernels& element_kernels(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx512:
      return lanes_avx512::element_table;
    case InstructionSet::kAvx2:
      return lanes_avx2::element_table;
    case InstructionSet::kBaseline:
      break;
  }
  return lanes_baseline::element_table;
}

const ElementKernels& element_kernels() {
  return element_kernels(instruction_set());
}

}  // namespace palpate
