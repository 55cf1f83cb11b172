// Which of the instruction sets that kernels are compiled for this processor has.
#pragma once

#include <string>

namespace palpate {

enum class InstructionSet : int {
  kBaseline,  ///< what the compiler assumes of every processor
  kAvx2,
  kAvx512,
};

/// The widest that the processor has. The environment variable PALPATE_INSTRUCTIONS
/// (baseline, avx2, avx512) lowers it, never raises it: results have the same bits with
/// all of them, and tests show that. Decided once in a process; safe from any thread.
[[nodiscard]] InstructionSet instruction_set();

/// As PALPATE_INSTRUCTIONS names it.
[[nodiscard]] std::string name_of(InstructionSet set);

}  // namespace palpate
