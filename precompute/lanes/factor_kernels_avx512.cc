#define PALPATE_LANES lanes_avx512
#include "precompute/lanes/factor_kernels.inc"
