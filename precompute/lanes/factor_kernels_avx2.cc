#define PALPATE_LANES lanes_avx2
#include "precompute/lanes/factor_kernels.inc"
